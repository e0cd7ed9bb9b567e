from threading import Thread

from blackboard.keeper.intake import Intake


def test_all_that_came_is_drained_in_order_and_what_is_too_much_is_counted():
    intake = Intake(3, 1000)
    for number in range(5):
        intake.put(number, 10)
    assert intake.drain(0.0) == [0, 1, 2]
    assert intake.overflowed == 2
    intake.put(5, 900)
    intake.put(6, 200)
    assert intake.drain(0.0) == [5]
    assert intake.drain(0.0) == []


def test_nothing_is_lost_between_threads():
    intake = Intake(100_000, 100_000)
    posters = [Thread(target=lambda n=n: [intake.put((n, i)) for i in range(2000)]) for n in range(4)]
    for poster in posters:
        poster.start()
    drained = []
    while len(drained) < 8000:
        batch = intake.drain(20.0)
        assert batch
        drained += batch
    for poster in posters:
        poster.join()
    assert all([i for m, i in drained if m == n] == list(range(2000)) for n in range(4))
