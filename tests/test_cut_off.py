"""What a robot did while it was cut off, from its own posts."""

from cut_off import CutOff, cut_off

from blackboard.messages.geometry import Pose
from blackboard.messages.motion import Drive
from blackboard.messages.sensing import Odometry


def drive(forward_mps):
    return Drive(forward_mps=forward_mps, turn_radps=0.0, limited_by="nothing")


def reading(x_m, forward_mps):
    return Odometry(pose=Pose(x_m=x_m, y_m=0.0, heading_rad=0.0), forward_mps=forward_mps)


READINGS = [
    *((9.0, reading(0.0, 0.3)), (10.0, reading(0.3, 0.3)), (10.5, reading(0.4, 0.2))),
    *((11.0, reading(0.45, 0.0)), (12.0, reading(0.45, 0.0)), (13.0, reading(0.6, 0.3))),
]


def test_it_was_told_to_stand_stood_and_went_on():
    drives = [(9.9, drive(0.3)), (10.25, drive(0.0)), (12.5, drive(0.3))]
    found = cut_off(drives, READINGS, 10.0, 12.0)
    assert found.told_to_stand_s == 0.25
    assert found.wheels_stood_s == 1.0
    assert abs(found.driven_m - 0.15) < 1e-9
    assert found.went_on_s == 0.5


def test_it_was_never_told():
    found = cut_off([(9.9, drive(0.3)), (10.2, drive(0.0)), (11.0, drive(0.1))], READINGS[:3], 10.0, 12.0)
    assert found.told_to_stand_s is None
    assert found.wheels_stood_s is None
    assert found.went_on_s is None


def test_it_stood_before():
    assert cut_off([(9.0, drive(0.0))], [], 10.0, 12.0) == CutOff(0.0, None, 0.0, None)
