import random

from hypothesis import given
from hypothesis import strategies as st

from blackboard.keeper.positions import LanePositions, Position
from blackboard.link.envelope import Origin


def test_a_gap_holds_the_position_until_it_is_closed() -> None:
    position = Position()
    for number in (1, 2, 5, 4):
        assert position.add(number)
    assert (position.up_to, position.beyond) == (2, [(4, 5)])
    assert (position.held(5), position.highest) == (4, 5)
    assert position.holds(4)
    assert not position.holds(3)
    assert not position.add(5)
    assert position.add(3)
    assert (position.up_to, position.beyond) == (5, [])


@given(st.sets(st.integers(1, 60)), st.randoms())
def test_whatever_the_order_and_repetition_it_ends_the_same(numbers: set[int], order: random.Random) -> None:
    sent = list(numbers) * 2
    order.shuffle(sent)
    position = Position()
    new = sum(position.add(number) for number in sent)
    up_to = next(n for n in range(1, 62) if n not in numbers) - 1
    assert new == len(numbers)
    assert position.up_to == up_to
    assert {n for n in range(1, 70) if position.holds(n)} == numbers
    assert all(position.held(last) == len([n for n in numbers if n <= last]) for last in range(70))
    ends = [end for stretch in position.beyond for end in stretch]
    assert ends == sorted(ends)
    assert all(b - a > 1 for (_, a), (b, _) in zip(position.beyond, position.beyond[1:], strict=False))


def test_the_boots_longest_silent_go_first_and_only_those_heard_of_are_told() -> None:
    positions = LanePositions(limit=2)
    for boot, now_s in (("a", 1.0), ("b", 2.0), ("a", 3.0), ("c", 4.0)):
        positions.at("host", boot, "signal").add(1)
        positions.hear("host", boot, now_s)
    assert positions.told() == {"host": {"a": {"signal": 1}, "c": {"signal": 1}}}
    assert positions.told(since_s=3.5) == {"host": {"c": {"signal": 1}}}
    assert positions.holds(Origin("host", "a", "signal", 1))
    assert not positions.holds(Origin("host", "b", "signal", 1))
