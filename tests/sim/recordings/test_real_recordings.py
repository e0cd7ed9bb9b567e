"""Real recordings, where they are at hand: how many readings there are, and that their stamps are in order."""

from collections import Counter
from itertools import pairwise
from math import hypot, inf
from pathlib import Path
from typing import Any

import pytest

from blackboard.errors import RecordingError
from blackboard.kinds import ODOMETRY, SONAR_SCAN
from sim.recordings.recorded import RecordedRobot, RecordedRobotParams

DATA = Path(__file__).resolve().parents[3] / "../shared/data"

pytestmark = pytest.mark.skipif(not DATA.is_dir(), reason="the shared recordings are not here")


def robot(name: str, **params: Any) -> RecordedRobot:
    return RecordedRobot(RecordedRobotParams(path=DATA / name, **params), name="robot")


@pytest.mark.parametrize(
    ("name", "readings"),
    [
        ("laser/intel.log.gz", {"odometry": 14610, "laser_scan": 910}),
        ("laser/seattle.log.gz", {"odometry": 19312, "laser_scan": 241}),
        ("ros/neato-macfirst_floor_take_2", {"odometry": 920, "laser_scan": 357}),
        ("people/general_tracking_moving_1.bag.zip", {"odometry": 11561, "laser_scan": 873}),
        ("people/demo_stationary_simple_environment.bag", {"odometry": 1265, "laser_scan": 1265}),
    ],
)
def test_readings(name: str, readings: dict[str, int]) -> None:
    counts: Counter[str] = Counter()
    newest_s: dict[str, float] = {}
    for reading in robot(name).advance(inf):
        counts[reading.kind.name] += 1
        assert reading.stamp_s >= newest_s.get(reading.kind.name, -inf)
        newest_s[reading.kind.name] = reading.stamp_s
    assert counts == readings


def test_intel_keeps_its_order() -> None:
    intel = robot("laser/intel.log.gz")
    poses = [r.value.pose for r in intel.advance(inf) if r.kind is ODOMETRY]
    driven_m = sum(hypot(b.x_m - a.x_m, b.y_m - a.y_m) for a, b in pairwise(poses))
    assert driven_m == pytest.approx(508, abs=1)  # 3,720 m when sorted by stamp
    assert intel.summary()["stamps_repaired"] == 909
    assert intel.end_s - intel.start_s == pytest.approx(2691.3, abs=0.1)


def test_autolab_has_sixteen_sonars_at_five_hertz() -> None:
    autolab = robot("sonar/autolab", sonar_latency_s=0.1)
    assert len(autolab.description.sonars) == 16
    assert {s.max_range_m for s in autolab.description.sonars} == {5.0}
    assert len(autolab.description.lasers) == 1
    scans = [r for r in autolab.advance(autolab.start_s + 20.0) if r.kind is SONAR_SCAN]
    assert len(scans) == 100
    assert all(r.value.sensors == tuple(range(16)) for r in scans)
    assert scans[0].stamp_s == pytest.approx(1700000000.1)


def test_a_bag_without_ranges_tells_its_topics() -> None:
    with pytest.raises(RecordingError, match="/crazyflie2/state_ranger_qxyzw"):
        robot("sparse/crazyflie-rice.bag")
