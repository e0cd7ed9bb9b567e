"""When a process is started again: by policy, at once the first time, ever later, and no more than so often."""

from hypothesis import given
from hypothesis import strategies as st

from blackboard.processes.restarts import LONGEST_S, Restart, pause_s


def test_the_policies() -> None:
    def pause(policy: Restart, failed: bool) -> float | None:
        return pause_s(policy, failed, [100.0], 100.0, 5, 60.0)

    assert [pause("always", True), pause("always", False)] == [0.0, 0.0]
    assert [pause("on-failure", True), pause("on-failure", False)] == [0.0, None]
    assert [pause("never", True), pause("never", False)] == [None, None]


def test_each_further_end_waits_longer_until_there_were_too_many() -> None:
    ends_s = [float(second) for second in range(100, 106)]
    pauses = [pause_s("always", True, ends_s[: n + 1], ends_s[n], 5, 60.0) for n in range(6)]
    assert pauses == [0.0, 0.25, 0.5, 1.0, 2.0, None]


def test_what_lies_further_back_is_forgiven() -> None:
    assert pause_s("always", True, [0.0, 1.0, 2.0, 100.0], 100.0, 3, 60.0) == 0.0
    assert pause_s("always", True, [41.0, 100.0], 100.0, 3, 60.0) == 0.25


def test_no_restart_is_allowed() -> None:
    assert pause_s("always", True, [5.0], 5.0, 0, 60.0) is None


@given(st.lists(st.floats(0, 1000), min_size=1), st.integers(0, 100), st.floats(0.1, 100))
def test_a_pause_is_never_long_and_never_negative(ends_s: list[float], limit: int, within_s: float) -> None:
    pause = pause_s("always", True, ends_s, max(ends_s), limit, within_s)
    assert pause is None or 0.0 <= pause <= LONGEST_S
