"""`battery.clp` in the lab: home when the battery is low, docked until it is charged, then on; or the truth about why not."""

from pathlib import Path
from typing import Any

from blackboard.entry import Entry
from blackboard.kinds import BATTERY, BEHAVIOUR, FIRING, MISSION, SWITCH
from blackboard.mission import find_mission, load_mission
from blackboard.runner import Run, RunOptions

LAB = Path(__file__).resolve().parents[2] / "sim/worlds/lab.toml"
RULES = ("battery-low-go-home", "home-approach-station", "before-station-dock", "charged-choose")


def started(folder: Path, dock: str, charge: float, **settings: Any) -> tuple[Run, list[tuple[float, str]]]:
    """Return explore-lab-battery in a lab with another dock, and where its firings will be noted."""
    text = LAB.read_text(encoding="utf-8")
    assert "heading_deg = -90.0\n" in text
    (folder / "lab.toml").write_text(text.replace("heading_deg = -90.0\n", f"heading_deg = -90.0\n{dock}\n"), "utf-8")
    robot = {"world": str(folder / "lab.toml"), "start_charge_fraction": charge}
    run = Run(
        load_mission(find_mission("explore-lab-battery"), {"robot": robot, **settings}), RunOptions(seed=1, strict=True)
    )
    fired: list[tuple[float, str]] = []

    def note(entry: Entry[Any]) -> None:
        if entry.value.rule in RULES:
            fired.append((entry.stamp_s, entry.value.rule))

    run.board.subscribe(f"ski/{run.board.robot}/{FIRING.path}/*", note)
    return run, fired


def test_it_goes_home_docks_charges_and_goes_on(tmp_path: Path) -> None:
    run, fired = started(tmp_path, "charging_s = 30", 0.2003)
    while run.board.now_s < 200.0 and (not fired or fired[-1][1] != "charged-choose"):
        run.cycle()
    assert [rule for _, rule in fired] == list(RULES)
    battery = run.board.newest(BATTERY)
    assert battery is not None
    assert battery.value.charge_fraction >= 0.8
    assert run.robot.summary()["collisions"] == 0
    for _ in range(20):
        run.cycle()
    selected = [entry.id for entry in run.board.entries(BEHAVIOUR) if entry.value.selected]
    assert "docking" not in selected
    assert "charge_battery" not in selected
    assert len(selected) > 1  # it is under way again
    assert all(switch.value.threshold == 0.0 for switch in run.board.entries(SWITCH))


def test_where_nothing_charges_it_gives_up_after_three_trips_and_says_so(tmp_path: Path) -> None:
    hasty = {"aside_m": 0.01, "side_m": 0.01, "wait_s": 0.5}  # loses no time over its tries
    run, fired = started(tmp_path, "aside_m = 0.005\naskew_deg = 0.1", 0.1, docking=hasty)
    run.run(300.0)
    mission = run.board.newest(MISSION)
    assert mission is not None
    assert (mission.value.state, mission.value.detail) == (
        "given up",
        "the battery is low, and its station cannot be reached or does not charge",
    )
    assert [rule for _, rule in fired].count("before-station-dock") == 3
    assert run.robot.summary()["collisions"] == 0
