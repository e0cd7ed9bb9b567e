"""The global model of lines and how it is kept consistent with what is seen.

A line runs along theta; rho = x sin(theta) - y cos(theta) is its offset and d = x cos(theta) + y sin(theta) the place of its middle
along it (Bou-Ghannam 1992, section 5.2.4.1).
"""

from typing import Annotated

from msgspec import Meta

from blackboard.messages.base import Angle, Count, Length, Message, Metres, Name, Text
from blackboard.messages.geometry import Point, Pose

Covariance = Annotated[float, Meta(ge=-1e12, le=1e12)]
Sigma = Annotated[float, Meta(ge=0.0, le=10.0)]
Names = Annotated[tuple[Name, ...], Meta(max_length=10_000)]


class LineSet(Message, frozen=True, kw_only=True):
    """All lines of one batch of points stand now: the batch's revision and the lines' ids."""

    batch: Count
    lines: Names


class ModelLine(Message, frozen=True, kw_only=True):
    """A wall as seen from one side, map frame.

    `sigma_rho_m` is that of the offset at the line's middle, and `covariance_theta_rho_m_rad` is between it and theta. Of the
    variances, the squares of the `inherited` sigmas came with the pose from which the line was first seen: looking again
    does not lessen them. `faces_left`: it was sensed from the left of its direction.
    """

    theta_rad: Angle
    rho_m: Metres
    d_m: Metres
    half_length_m: Length
    sigma_theta_rad: Sigma
    sigma_rho_m: Length
    covariance_theta_rho_m_rad: Covariance
    inherited_sigma_theta_rad: Sigma
    inherited_sigma_rho_m: Length
    faces_left: bool
    start: Point
    end: Point
    observations: Annotated[int, Meta(ge=1, le=2**53)]

    def extent(self) -> tuple[float, float, float, float]:
        xs, ys = (self.start.x_m, self.end.x_m), (self.start.y_m, self.end.y_m)
        return (min(xs), min(ys), max(xs), max(ys))


class NewAreaVisited(Message, frozen=True, kw_only=True):
    """A line that matched nothing: of an area not modelled yet, or a sensing error. Endorsements say which."""

    line: ModelLine
    seen_from: Point

    def extent(self) -> tuple[float, float, float, float]:
        return self.line.extent()


class LineMatch(Message, frozen=True, kw_only=True):
    """An observed and a model line that may be the same: (theta, offset) of the model less those observed, at the latter's middle.

    `covariance` is that of the difference without the pose's: of theta, of both, of the offset. The `model` sigmas are the model
    line's own: the pose cannot become surer by it than that.
    """

    observed: Name
    model: Name
    theta_rad: Angle  # of the model line, flipped where needed
    middle: Point  # of the observed line
    turn_rad: Angle
    offset_m: Metres
    covariance: tuple[Covariance, Covariance, Covariance]
    model_sigma_theta_rad: Sigma
    model_sigma_rho_m: Length


class LineMatches(Message, frozen=True, kw_only=True):
    """The matches of one batch of observed lines."""

    batch: Count
    matches: Annotated[tuple[LineMatch, ...], Meta(max_length=10_000)]


class ExpectedLines(Message, frozen=True, kw_only=True):
    """Which lines the robot should see from where it is: ids of model lines and of new areas."""

    model: Names
    new_areas: Names


class PoseEstimate(Message, frozen=True, kw_only=True):
    """map_from_robot with its covariance in metres and radians: xx, xy, x heading, yy, y heading, heading heading."""

    map_from_robot: Pose
    covariance: Annotated[tuple[Covariance, ...], Meta(min_length=6, max_length=6)]

    def extent(self) -> tuple[float, float, float, float]:
        return self.map_from_robot.extent()


class ReReference(Message, frozen=True, kw_only=True):
    """What a batch of matches makes of the pose: turn about `centre`, then shift; and whether that was applied.

    The jump's squared `normal_distance` under the pose's uncertainty is held against `bound`. `lines` are the observed lines
    that counted.
    """

    batch: Count
    applied: bool
    centre: Point
    shift: Point
    turn_rad: Angle
    normal_distance: Annotated[float, Meta(ge=0.0, le=1e12)]
    bound: Annotated[float, Meta(ge=0.0, le=1e12)]
    lines: Names


class PoseConflict(Message, frozen=True, kw_only=True):
    """A jump of the pose that its uncertainty does not allow: refused, to be looked into."""

    refused: ReReference
    why: Text
