from blackboard.keeper.expectation import Expectation, LaneCount
from blackboard.keeper.positions import LanePositions


def test_a_number_is_missing_once_it_was_expected_two_looks_ago():
    positions, expectation = LanePositions(10), Expectation()
    for number in (1, 2, 5):
        positions.at("h", "b", "signal").add(number)
    expectation.say("h", "b", {"signal": 6, "knowledge": 1})

    def missing():
        return [(c.lane, c.posted, c.held, c.missing) for c in expectation.counts(positions)]

    assert missing() == [("knowledge", 1, 0, 0), ("signal", 6, 3, 0)]
    expectation.look(positions)
    assert [m[3] for m in missing()] == [0, 0]
    expectation.look(positions)
    assert [m[3] for m in missing()] == [1, 3]
    positions.at("h", "b", "knowledge").add(1)
    positions.at("h", "b", "signal").add(6)
    positions.at("h", "b", "signal").add(7)
    assert missing() == [("knowledge", 1, 1, 0), ("signal", 7, 5, 2)]


def test_after_a_restart_gaps_are_due_at_once():
    positions, expectation = LanePositions(10), Expectation()
    positions.at("h", "b", "signal").add(2)
    expectation.due_at_once(positions)
    assert expectation.counts(positions) == [LaneCount("h", "b", "signal", posted=2, held=1, missing=1)]
