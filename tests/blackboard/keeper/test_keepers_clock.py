import pytest

from blackboard.errors import MessageError
from blackboard.keeper.clock import KeptClock


def test_it_begins_once_runs_at_its_pace_and_goes_on_after_a_restart(tmp_path):
    wall = [1000.0]
    clock = KeptClock(tmp_path, lambda: wall[0])
    assert clock.answer(b"").now_s is None
    assert clock.answer(b'{"begin": 5.0, "pace": 2.0}').now_s == 5.0
    wall[0] = 1010.0
    assert clock.answer(b'{"begin": 0.0}').now_s == 25.0
    wall[0] = 1011.0
    again = KeptClock(tmp_path, lambda: wall[0]).answer(b"")
    assert (again.now_s, again.wall_s, again.pace) == (27.0, 1011.0, 2.0)


@pytest.mark.parametrize(
    "question",
    [b"x", b"[]", b'{"begin": "now"}', b'{"begin": 1e300}', b'{"begin": 0, "pace": 0}', b'{"now": 1}', b"\xff"],
)
def test_what_is_no_question_is_refused(tmp_path, question):
    clock = KeptClock(tmp_path, lambda: 0.0)
    with pytest.raises(MessageError):
        clock.answer(question)
    assert clock.now_s is None


def test_a_damaged_file_is_as_none(tmp_path):
    (tmp_path / "clock.json").write_bytes(b"\xff{")
    assert KeptClock(tmp_path, lambda: 0.0).now_s is None
