"""What the robot is asked to do, by whom, and how it fares."""

from typing import Annotated, Literal

from msgspec import Meta

from blackboard.messages.base import Count, Length, Message, Seconds, Speed, Text, TurnRate


class Response(Message, frozen=True, kw_only=True):
    """A behaviour's answer to the newest readings: a vector in the robot frame and a turn on the spot.

    The vector (forward, left) is dimensionless; length 1 asks for full speed in that direction. `turn_radps` is added to
    the turn that the vector asks for.
    """

    forward: Annotated[float, Meta(ge=-1000.0, le=1000.0)] = 0.0
    left: Annotated[float, Meta(ge=-1000.0, le=1000.0)] = 0.0
    turn_radps: TurnRate = 0.0


class Velocity(Message, frozen=True, kw_only=True):
    """Speeds that the coordinator wants, good until `valid_until_s`."""

    forward_mps: Speed
    turn_radps: TurnRate
    valid_until_s: Seconds


class Drive(Message, frozen=True, kw_only=True):
    """Speeds that go to the wheels, after the safety layer, and why they are not those that were wanted."""

    forward_mps: Speed
    turn_radps: TurnRate
    limited_by: Literal["nothing", "clearance", "bumper", "stale readings", "no command"]
    clearance_m: Length | None = None


class Motivation(Message, frozen=True, kw_only=True):
    """What a behaviour is asked to do, by its id: the motivation state of the robot (Bou-Ghannam 1992, section 4.2).

    `number` counts what was asked of this behaviour; its status acknowledges it by the same number. `parameters` are those
    that the behaviour names, in order (a place: x and y, m, map frame).
    """

    on: bool
    number: Count
    parameters: Annotated[tuple[float | str, ...], Meta(max_length=20)] = ()


class BehaviourStatus(Message, frozen=True, kw_only=True):
    """Where a behaviour stands: posted when it changes.

    `selected` says whether it may answer, `acknowledged` is the number of the newest motivation that it has taken up. `outcome`
    is that of what it was asked for, `remaining_m` how far it still has to go, told in steps.
    """

    state: Literal["idle", "active", "inhibited", "done", "failed"]
    selected: bool = True
    acknowledged: Count = 0
    outcome: Literal["none", "underway", "reached", "blocked"] = "none"
    remaining_m: Length | None = None
    detail: Text = ""


class Switch(Message, frozen=True, kw_only=True):
    """A switch of the arbitration network, by the id of its behaviour or level: output = gain (response - threshold).

    Bou-Ghannam 1992, section 4.3, Figure 4.6. `level` is the competence level that a behaviour belongs to, whose own switch its
    output passes too.
    """

    gain: Annotated[float, Meta(ge=0.0, le=100.0)] = 1.0
    threshold: Annotated[float, Meta(ge=0.0, le=1000.0)] = 0.0
    level: Annotated[str, Meta(max_length=200)] = ""


class MissionStatus(Message, frozen=True, kw_only=True):
    """How the mission as a whole stands; once it is not underway the run ends."""

    state: Literal["underway", "done", "given up"]
    detail: Text = ""
