"""What the robot is asked to do, by whom, and how it fares."""

from typing import Annotated, Literal

from msgspec import Meta

from blackboard.messages.base import Length, Message, Seconds, Speed, Text, TurnRate


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


class BehaviourStatus(Message, frozen=True, kw_only=True):
    """Where a behaviour stands: posted when it changes."""

    state: Literal["idle", "active", "inhibited", "done", "failed"]
    detail: Text = ""
