"""When an executor lets go: a manager's silence counts only while it could be heard."""

from blackboard.processes.leash import Leash, LeashParams, let_go, passed

PARAMS = LeashParams(lease_s=10.0, cut_s=30.0)


def after(leash: Leash, seconds: float, *, keeper: bool) -> Leash:
    for _ in range(round(seconds / 0.1)):
        leash = passed(leash, 0.1)
        if keeper:
            leash = Leash(manager=leash.manager, silent_s=leash.silent_s)
    return leash


def test_a_silent_manager_is_gone_after_its_lease() -> None:
    held = Leash(manager="m")
    assert let_go(after(held, 9.5, keeper=True), PARAMS) == ""
    assert let_go(after(held, 10.8, keeper=True), PARAMS) == "the manager was silent for 11 s"


def test_while_the_keeper_restarts_nothing_counts() -> None:
    away = after(Leash(manager="m"), 20.0, keeper=False)
    assert away.silent_s < 1.2
    assert let_go(away, PARAMS) == ""
    assert let_go(after(Leash(manager="m", silent_s=away.silent_s), 8.0, keeper=True), PARAMS) == ""


def test_a_keeper_that_stays_away_ends_it_too() -> None:
    assert let_go(after(Leash(manager="m"), 31.0, keeper=False), PARAMS) == "the keeper was silent for 31 s"


def test_an_executor_that_was_halted_blames_nobody() -> None:
    assert let_go(passed(Leash(manager="m"), 60.0), PARAMS) == ""


def test_nobody_lets_go_who_is_not_held() -> None:
    assert let_go(after(Leash(), 100.0, keeper=False), PARAMS) == ""
