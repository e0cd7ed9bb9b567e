from hypothesis import given
from hypothesis import strategies as st

from blackboard.link.envelope import Envelope, LostQuestion, Origin
from blackboard.link.inbox import HOLD_S, Inbox


def envelope(number, lane="knowledge", host="mapper", boot="b1"):
    return Envelope(Origin(host, boot, lane, number), b"%d" % number)


def numbers(envelopes):
    return [e.origin.number for e in envelopes]


def test_what_comes_in_order_is_delivered_at_once():
    inbox = Inbox("me")
    assert [numbers(inbox.take(envelope(n))) for n in (1, 2, 3)] == [[1], [2], [3]]
    assert inbox.gaps() == []


def test_a_gap_holds_back_what_follows_until_the_keeper_answers():
    inbox = Inbox("me")
    inbox.take(envelope(1))
    assert inbox.take(envelope(4)) == []
    assert inbox.gaps() == []  # the keeper has not said that it holds them
    inbox.told({"mapper": {"b1": {"knowledge": 4}}})
    (question,) = inbox.gaps()
    assert question == LostQuestion(host="mapper", boot="b1", lane="knowledge", first=2, last=3)
    assert inbox.gaps() == []  # asked once
    assert numbers(inbox.answered(question, [envelope(2), envelope(3)])) == [2, 3, 4]
    assert inbox.skipped == 0


def test_the_end_of_a_lane_that_was_dropped_is_known_from_the_keeper():
    inbox = Inbox("me")
    inbox.take(envelope(1))
    inbox.told({"mapper": {"b1": {"knowledge": 3}}})
    (question,) = inbox.gaps()
    assert (question.first, question.last) == (2, 3)


def test_what_the_keeper_does_not_hold_any_more_is_skipped_and_counted():
    inbox = Inbox("me")
    inbox.take(envelope(5))
    inbox.told({"mapper": {"b1": {"knowledge": 5}}})
    (question,) = inbox.gaps()
    assert numbers(inbox.answered(question, [envelope(3), envelope(4)])) == [3, 4, 5]
    assert inbox.skipped == 2


def test_commands_never_wait_and_never_run_back():
    inbox = Inbox("me")
    assert numbers(inbox.take(envelope(1, "command"))) == [1]
    assert numbers(inbox.take(envelope(7, "command"))) == [7]
    assert inbox.take(envelope(6, "command")) == []
    inbox.told({"mapper": {"b1": {"command": 9}}})
    assert inbox.gaps() == []


def test_own_envelopes_and_unwanted_lanes_are_passed_over():
    inbox = Inbox("me", lanes=("knowledge",))
    assert inbox.take(envelope(1, host="me")) == []
    assert inbox.take(envelope(1, "large")) == []


def test_a_new_boot_counts_anew():
    inbox = Inbox("me")
    inbox.take(envelope(1))
    assert numbers(inbox.take(envelope(1, boot="b2"))) == [1]


def test_a_snapshot_says_where_to_go_on():
    inbox = Inbox("me")
    inbox.take(envelope(7))
    assert numbers(inbox.start({"mapper": {"b1": {"knowledge": 6}}})) == [7]
    assert numbers(inbox.take(envelope(8))) == [8]


def test_what_not_even_the_keeper_will_ever_have_is_waited_for_so_long_and_skipped():
    inbox = Inbox("me")
    inbox.take(envelope(1))
    inbox.take(envelope(4))
    inbox.told({"mapper": {"b1": {"knowledge": 1}}})
    assert inbox.overdue(100.0) == []
    assert inbox.overdue(100.0 + HOLD_S) == []
    assert numbers(inbox.overdue(100.1 + HOLD_S)) == [4]
    assert inbox.skipped == 2


@given(st.integers(1, 30), st.data())
def test_whatever_is_dropped_doubled_or_late_all_is_delivered_once_in_order(last, data):
    inbox = Inbox("me")
    order = data.draw(st.lists(st.integers(1, last), max_size=60))
    delivered, told = [], 0
    for number in order:
        delivered += numbers(inbox.take(envelope(number)))
        told = max(told, number)
        if data.draw(st.booleans()):
            inbox.told({"mapper": {"b1": {"knowledge": told}}})
            for question in inbox.gaps():
                if data.draw(st.booleans()):
                    inbox.unanswered(question)
                else:
                    held = [envelope(n) for n in range(question.first, question.last + 1)]
                    delivered += numbers(inbox.answered(question, held))
    inbox.told({"mapper": {"b1": {"knowledge": last}}})
    while questions := inbox.gaps():
        for question in questions:
            held = [envelope(n) for n in range(question.first, question.last + 1)]
            delivered += numbers(inbox.answered(question, held))
    assert delivered == list(range(1, last + 1))
    assert inbox.skipped == 0
