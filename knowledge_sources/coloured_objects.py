"""Looks for round things of one colour and size: what a camera sees of that colour becomes hypotheses of where they stand.

Triggered by  observations/signal/blobs             BlobScan
Reads         observations/feature/odom_from_robot, hypotheses/feature/map_from_odom, status/robot
Posts         hypotheses/symbol/found_object/<object>-<n>    FoundObject

A stretch of the colour that a known thing explains is another sighting of it; where something hides a part of it, that moves
nothing. Any other begins a new one. It is suspected from the second sighting on, and confirmed once the sightings, from
several places, leave no doubt of its place, and its size is the one looked for. What is suspected and not seen again is taken
back. Things of that size cannot stand nearer to each other than two radii: of two, the better known one stays.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import hypot, radians
from typing import Any

from blackboard.access import Access
from blackboard.component import KnowledgeSource
from blackboard.entry import Entry, Strength
from blackboard.key_expressions import is_chunk
from blackboard.kinds import BLOBS, FOUND_OBJECT, ROBOT
from blackboard.messages.geometry import Point, Pose, wrap_angle
from blackboard.messages.sensing import Blob, BlobScan, CameraSensor
from blackboard.messages.symbols import FoundObject
from blackboard.parameters import require
from blackboard.uncertainty.chi_square import chi_square_quantile
from knowledge_sources.poses import READS, map_from_robot_at
from knowledge_sources.sensors import camera_of
from knowledge_sources.sized_sightings import Estimate, Expected, Sighting, SightingErrors, estimate, placed
from knowledge_sources.standing_hypotheses import Found, Reason, StandingHypotheses
from knowledge_sources.stretches import Stretches

GATE = chi_square_quantile(0.99, 2)  # a sighting further off is another thing's
SIGMAS = 3.0  # what is seen of a part does not reach further beyond the whole
VAGUE_FRACTION = 0.3  # of its width: a thing known no better explains no part
LEAST_SIGHTINGS = 2  # one alone may be made up
MOST_FITTED = 40
NEWS_M = 0.05  # a place that moves less is no news
CLOSE_RADII = 1.8  # things nearer to each other are one: two radii, and some slack for what is not known of them


@dataclass(frozen=True, slots=True, kw_only=True)
class ColouredObjectsParams:
    """What is looked for, and how sure one must be."""

    object: str = "drum"
    colour: str = "green"
    radius_m: float = 0.29  # of a drum of 200 litres
    edge_sigma_rad: float = radians(0.35)  # of where a stretch ends: a camera of a quarter of a degree, with noise
    heading_sigma_rad: float = radians(1.5)  # of the robot, which sonars know no better
    pose_sigma_m: float = 0.05
    step_m: float = 0.2  # the camera must have moved so far for a sighting to tell more
    least_places: int = 4  # so many sightings from places so far apart, to be confirmed
    size_error_fraction: float = 0.2  # the size must be right within this ...
    size_sigma_fraction: float = 0.12  # ... and known so well: seen from one place only, nobody knows it
    place_sigma_m: float = 0.15
    forget_s: float = 30.0  # what is only suspected, after its last sighting

    def __post_init__(self) -> None:
        for name in ("object", "colour"):
            value = getattr(self, name)
            require(is_chunk(value), name, value, "words of letters, digits, '_', '-' and '.'")
        require(0.02 <= self.radius_m <= 5.0, "radius_m", self.radius_m, "[0.02, 5] metres")
        require(0.0 < self.edge_sigma_rad <= 0.2, "edge_sigma_rad", self.edge_sigma_rad, "(0, 0.2]")
        require(0.0 <= self.heading_sigma_rad <= 0.5, "heading_sigma_rad", self.heading_sigma_rad, "[0, 0.5]")
        require(0.0 <= self.pose_sigma_m <= 1.0, "pose_sigma_m", self.pose_sigma_m, "[0, 1] metres")
        require(0.01 <= self.step_m <= 5.0, "step_m", self.step_m, "[0.01, 5] metres")
        require(1 <= self.least_places <= MOST_FITTED, "least_places", self.least_places, f"[1, {MOST_FITTED}]")
        for name in ("size_error_fraction", "size_sigma_fraction"):
            require(0.0 < getattr(self, name) <= 1.0, name, getattr(self, name), "(0, 1]")
        require(0.0 < self.place_sigma_m <= 5.0, "place_sigma_m", self.place_sigma_m, "(0, 5] metres")
        require(1.0 <= self.forget_s <= 1e5, "forget_s", self.forget_s, "[1, 1e5] seconds")

    @property
    def errors(self) -> SightingErrors:
        return SightingErrors(
            edge_rad=self.edge_sigma_rad, heading_rad=self.heading_sigma_rad, pose_m=self.pose_sigma_m
        )


@dataclass
class _Thing:
    """What explains some sightings."""

    number: int
    estimate: Estimate
    fitted: list[Sighting]
    seen_s: float
    places: int = 1
    sightings: int = 1
    confirmed: bool = False
    supports: Stretches = field(default_factory=Stretches)


def sighting_of(
    blob: Blob, map_from_camera: Pose, camera: CameraSensor, params: ColouredObjectsParams
) -> Sighting | None:
    """Return what a stretch of colour says of a thing of the size looked for; None where it says nothing.

    At the edge of the field nobody knows its width; and what looks as if it stood further off than the camera can tell colours is
    hidden in part, or smaller.
    """
    if blob.colour != params.colour or blob.width_rad < 2.0 * params.edge_sigma_rad:
        return None
    if abs(blob.bearing_rad) + blob.width_rad / 2.0 > camera.field_rad / 2.0 - 2.0 * params.edge_sigma_rad:
        return None
    bearing_rad = wrap_angle(map_from_camera.heading_rad + blob.bearing_rad)
    sighting = Sighting(map_from_camera.x_m, map_from_camera.y_m, bearing_rad, blob.width_rad)
    x_m, y_m = placed(sighting, params.radius_m)
    too_far = hypot(x_m - sighting.x_m, y_m - sighting.y_m) > 1.2 * (camera.max_range_m + params.radius_m)
    return None if too_far else sighting


def hides_a_part(expected: Expected) -> bool:
    """Say whether a sighting may be a part of what was expected there, the rest being hidden; only where that is well known."""
    if expected.width_sigma_rad > VAGUE_FRACTION * expected.width_rad:
        return False
    seen_rad = expected.width_rad + float(expected.residuals_rad[1])
    beyond_rad = abs(float(expected.residuals_rad[0])) + (seen_rad - expected.width_rad) / 2.0
    return beyond_rad <= SIGMAS * expected.edge_sigma_rad


class ColouredObjects(KnowledgeSource[ColouredObjectsParams]):
    """Keeps a hypothesis for each thing of the colour and size."""

    Params = ColouredObjectsParams
    triggers = (BLOBS,)
    reads = (ROBOT, *READS)
    posts = (FOUND_OBJECT,)
    rating = 4.0

    def __init__(self, params: ColouredObjectsParams, *, name: str, seed: int = 0) -> None:
        super().__init__(params, name=name, seed=seed)
        self._things: list[_Thing] = []
        self._named = 0
        self._standing = StandingHypotheses(FOUND_OBJECT, _differs)

    def resume(self, state: object, board: Access) -> None:
        super().resume(state, board)
        self._named = max(self._named, board.last_number(FOUND_OBJECT, f"{self.params.object}-"))
        self._standing.resume(board)

    def activate(self, trigger: Entry[BlobScan], board: Access) -> None:
        robot, found = board.newest(ROBOT), map_from_robot_at(board, trigger.stamp_s)
        if robot is None or found is None:
            return
        camera = camera_of(robot.value, trigger.value.camera)
        supports: tuple[Entry[Any], ...] = (trigger, *found[1])
        seen = [sighting_of(blob, found[0] @ camera.mount, camera, self.params) for blob in trigger.value.blobs]
        self._take([s for s in seen if s is not None], trigger.stamp_s, supports)
        params = self.params
        self._things = [t for t in self._things if t.confirmed or trigger.stamp_s - t.seen_s <= params.forget_s]
        kept = {f"{params.object}-{t.number}": self._found(t) for t in self._things if t.sightings >= LEAST_SIGHTINGS}
        self._standing.keep(board, kept, lambda _: "it was not seen again, or is another one")

    def _take(self, sightings: Sequence[Sighting], stamp_s: float, supports: tuple[Entry[Any], ...]) -> None:
        """Take the sightings of one scan for those of known things that they fit best, for parts of some, or for new things."""
        errors, things = self.params.errors, list(self._things)
        expected = [[thing.estimate.expected(s, errors) for thing in things] for s in sightings]
        fits = sorted((e.distance, i, j) for i, row in enumerate(expected) for j, e in enumerate(row))
        taken: dict[int, int] = {}
        for distance, i, j in fits:
            if distance <= GATE and i not in taken and j not in taken.values():
                taken[i] = j
        for i, sighting in enumerate(sightings):
            parts = sorted((e.away_m, j) for j, e in enumerate(expected[i]) if hides_a_part(e))
            if i in taken or parts:
                thing = things[taken[i] if i in taken else parts[0][1]]
                thing.sightings += 1
                thing.seen_s = stamp_s
                thing.supports.add(supports)
            else:
                self._named += 1
                thing = _Thing(self._named, estimate([sighting], self.params.radius_m, errors), [sighting], stamp_s)
                thing.supports.add(supports)
                self._things.append(thing)
                self._keep_apart(thing)
            if i in taken:
                self._fit(thing, sighting)

    def _fit(self, thing: _Thing, sighting: Sighting) -> None:
        params, last = self.params, thing.fitted[-1]
        if hypot(sighting.x_m - last.x_m, sighting.y_m - last.y_m) < params.step_m:
            return
        thing.fitted = [*thing.fitted, sighting][-MOST_FITTED:]
        thing.places += 1
        thing.estimate = now = estimate(thing.fitted, params.radius_m, params.errors)
        right = abs(now.radius_m - params.radius_m) <= params.size_error_fraction * params.radius_m
        known = (
            now.sigma_radius_m <= params.size_sigma_fraction * params.radius_m and now.sigma_m <= params.place_sigma_m
        )
        thing.confirmed = right and (thing.confirmed or (known and thing.places >= params.least_places))
        self._keep_apart(thing)

    def _keep_apart(self, thing: _Thing) -> None:
        """Where two things would stand in each other, leave the one that is known better."""
        reach_m = CLOSE_RADII * self.params.radius_m
        here = thing.estimate
        near = [t for t in self._things if hypot(t.estimate.x_m - here.x_m, t.estimate.y_m - here.y_m) < reach_m]
        best = max(near, key=lambda t: (t.confirmed, t.places, -t.number))
        self._things = [t for t in self._things if t is best or t not in near]

    def _found(self, thing: _Thing) -> Found[FoundObject]:
        now, params = thing.estimate, self.params
        value = FoundObject(
            object=params.object,
            colour=params.colour,
            standing="confirmed" if thing.confirmed else "suspected",
            place=Point(x_m=now.x_m, y_m=now.y_m),
            sigma_m=now.sigma_m,
            radius_m=now.radius_m,
            sightings=thing.sightings,
            places=thing.places,
        )
        strength: Strength = "strong" if thing.confirmed else "fair" if thing.places > 1 else "weak"
        count = "one place" if thing.places == 1 else f"{_coarsely(thing.places)} places or more"
        reasons = [Reason(f"{params.colour}, seen from {count}", "colour", "for", strength)]
        if thing.places > 1:
            size = f"it seems {2 * now.radius_m:.1f} m wide"
            right = abs(now.radius_m - params.radius_m) <= params.size_error_fraction * params.radius_m
            reasons.append(Reason(size, "size", "for" if right else "against"))
        return Found(value, thing.supports.supports(), reasons)


def _differs(a: FoundObject, b: FoundObject) -> bool:
    moved_m = hypot(a.place.x_m - b.place.x_m, a.place.y_m - b.place.y_m)
    return a.standing != b.standing or _coarsely(a.places) != _coarsely(b.places) or moved_m > NEWS_M


def _coarsely(places: int) -> int:
    """Return a count as it is told: 1, 2, 4, 8, ..."""
    return 1 << (places.bit_length() - 1)
