from blackboard.keeper.hosts import HostWatch
from blackboard.messages.hosts import HostBeat


def beat(boot="b1", components=("grid",), **more):
    return HostBeat(boot=boot, pid=7, machine="m", version="1", components=components, lanes={"signal": 3}, **more)


def states(watch, now_s):
    return {name: status.state for name, status in watch.changes(now_s)}


def watched():
    watch = HostWatch(1.0, 10.0)
    watch.linked("map", "b1", True, 0.0)
    watch.beat("map", beat(), 0.1)
    assert states(watch, 0.1) == {"map": "alive"}
    return watch


def test_a_token_that_ends_without_a_farewell_is_death():
    watch = watched()
    watch.linked("map", "b1", False, 0.2)
    assert states(watch, 0.2) == {"map": "dead"}
    assert states(watch, 0.3) == {}


def test_a_token_that_ends_after_a_farewell_is_a_stop():
    watch = watched()
    watch.beat("map", beat(leaving=True), 0.2)
    watch.linked("map", "b1", False, 0.3)
    assert states(watch, 0.3) == {"map": "stopped"}


def test_a_host_without_beats_hangs_until_it_beats_again():
    watch = watched()
    assert states(watch, 1.0) == {}
    assert states(watch, 1.2) == {"map": "hung"}
    watch.beat("map", beat(), 5.0)
    assert states(watch, 5.0) == {"map": "alive"}


def test_one_that_is_still_loading_does_not_hang_yet():
    watch = HostWatch(1.0, 10.0)
    watch.linked("map", "b1", True, 0.0)
    assert states(watch, 0.5) == {"map": "alive"}
    assert [states(watch, 0.5 * half) for half in range(2, 21)] == [{}] * 19
    assert states(watch, 10.5) == {"map": "hung"}


def test_a_new_boot_takes_the_place_of_a_dead_one():
    watch = watched()
    watch.linked("map", "b1", False, 0.2)
    watch.linked("map", "b2", True, 0.3)
    watch.beat("map", beat("b2"), 0.4)
    assert [(s.boot, s.state) for _, s in watch.changes(0.4)] == [("b2", "alive")]


def test_two_processes_of_one_name_and_a_component_in_two_hosts_are_told():
    watch = watched()
    watch.linked("map", "b2", True, 0.2)
    watch.beat("map", beat("b2"), 0.2)
    assert [s.detail for _, s in watch.changes(0.2)] == ["another process has the same name, boot b1"]
    watch.linked("map", "b1", False, 0.3)
    watch.linked("other", "c1", True, 0.3)
    watch.beat("other", beat("c1", ("grid", "lines")), 0.3)
    assert {s.detail for _, s in watch.changes(0.3)} == {"grid runs in map, other"}
    watch.linked("map", "b2", False, 0.4)
    assert {n: (s.state, s.detail) for n, s in watch.changes(0.4)} == {"map": ("dead", ""), "other": ("alive", "")}


def test_when_one_of_two_ends_the_other_goes_on():
    watch = watched()
    watch.linked("map", "b2", True, 0.2)
    watch.linked("map", "b2", False, 0.3)
    assert states(watch, 0.3) == {}


def test_a_little_change_of_the_measured_clock_is_no_news():
    watch = watched()
    watch.beat("map", beat(offset_s=0.01), 0.2)
    assert states(watch, 0.2) == {}
    watch.beat("map", beat(offset_s=2.0), 0.3)
    assert [s.offset_s for _, s in watch.changes(0.3)] == [2.0]


def test_after_a_restart_of_the_keeper_hosts_have_a_second_to_show_themselves():
    before = watched().statuses()["map"]
    watch = HostWatch(1.0, 10.0)
    watch.restore("map", before, 100.0)
    assert states(watch, 100.5) == {}
    assert states(watch, 101.5) == {"map": "dead"}
    watch.restore("map", before, 200.0)
    watch.linked("map", "b1", True, 200.1)
    assert states(watch, 202.0) == {}
    watch.beat("map", beat(), 202.0)
    assert states(watch, 202.0) == {}


def test_a_machine_whose_clock_is_off_is_told_by_how_much():
    watch = watched()
    watch.beat("map", beat(offset_s=-1.25), 0.2)
    ((_, status),) = watch.changes(0.2)
    assert status.detail == "its clock is 1.2 s behind the keeper's; set it by NTP"


def test_a_keeper_that_was_stopped_blames_nobody_for_it():
    watch = watched()
    assert states(watch, 11.0) == {}
    assert states(watch, 11.9) == {}
    assert states(watch, 12.1) == {"map": "hung"}
