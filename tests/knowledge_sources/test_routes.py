"""Routes and travel on a board: asked for, kept while they are good, planned anew when they are not, taken back."""

from math import hypot

import pytest

from blackboard.access import Access
from blackboard.board import Board
from blackboard.entry import Entry
from blackboard.errors import MissionError
from blackboard.grid import Grid, tile_id
from blackboard.kinds import GRID, MAP_FROM_ODOM, MOTIVATION, ODOM_FROM_ROBOT, ROBOT, ROUTE, TARGET, TRAVEL
from blackboard.messages.geometry import Point, Pose
from blackboard.messages.motion import Motivation
from blackboard.messages.routes import Route, Travel
from blackboard.messages.sensing import RobotDescription
from blackboard.messages.symbols import Target
from blackboard.parameters import parse_parameters
from blackboard.vocabulary import Vocabulary
from knowledge_sources.routes import Routes, RoutesParams
from knowledge_sources.travel import TravelParams, TravelToTargets, is_news

CELL_M = 0.05
ROBOT_OF_60_CM = RobotDescription(
    name="k2a", radius_m=0.3, max_speed_mps=1.0, max_turn_radps=1.0, max_acceleration_mps2=1.0
)


class House:
    """Two rooms of 4 by 4 m beside each other, with a door of 0.9 m in the wall between them at x = 4, from y = 0.5."""

    def __init__(self) -> None:
        self.board = Board(Vocabulary())
        self.board.post(ROBOT, ROBOT_OF_60_CM, source="robot")
        self.grid = Grid(CELL_M)
        self.grid.cover(-0.2, -0.2, 8.2, 4.2)
        self.fill(-0.1, -0.1, 8.1, 4.1, 255)
        self.fill(0.0, 0.0, 8.0, 4.0, 0)
        self.fill(3.95, 0.0, 4.05, 4.0, 255)
        self.fill(3.95, 0.5, 4.05, 1.4, 0)
        self.post()
        self.routes = Routes(RoutesParams(), name="routes")
        self.travel = TravelToTargets(TravelParams(), name="travel")
        self.at(1.0, 3.0)

    def fill(self, x0: float, y0: float, x1: float, y1: float, value: int) -> None:
        columns = [round((x - self.grid.x_min_m) / CELL_M) for x in (x0, x1)]
        rows = [round((y - self.grid.y_min_m) / CELL_M) for y in (y0, y1)]
        self.grid.cells[rows[0] : rows[1], columns[0] : columns[1]] = value

    def post(self) -> None:
        """Post what changed."""
        for tile in self.grid.take_changed():
            self.board.post(GRID, tile, id=tile_id(tile), source="grid")

    def at(self, x_m: float, y_m: float, after_s: float = 0.0) -> None:
        """Put the robot somewhere, some time later."""
        self.board.now_s += after_s
        self.board.post(ODOM_FROM_ROBOT, Pose(x_m=x_m, y_m=y_m, heading_rad=0.0), source="odometry")

    def ask(self, number: int, x_m: float, y_m: float, on: bool = True) -> Route | None:
        value = Motivation(on=on, number=number, parameters=(x_m, y_m))
        entry = self.board.post(MOTIVATION, value, id="path_following", source="rules")
        return self.look(entry)

    def look(self, trigger: Entry[Motivation] | None = None) -> Route | None:
        """Let the routes look at the board; return the route that stands."""
        access = Access(self.board, "routes", (MOTIVATION, GRID, *self.routes.reads), self.routes.posts)
        self.routes.activate(trigger or self.board.entries(GRID)[0], access)
        entry = self.board.newest(ROUTE)
        return None if entry is None else entry.value

    def target(self, id_: str, x_m: float, y_m: float, stand: tuple[float, float] | None = None) -> None:
        stand = stand or (x_m, y_m)
        value = Target(
            place=Point(x_m=x_m, y_m=y_m), stand=Point(x_m=stand[0], y_m=stand[1]), reason="frontier", size_m=1.0
        )
        self.board.post(TARGET, value, id=id_, source="targets")

    def measure(self) -> dict[str, Travel]:
        """Let the travel be measured if it is due; return what stands of it."""
        access = Access(self.board, "travel", (TARGET, GRID, *self.travel.reads), self.travel.posts)
        self.travel.activate(self.board.entries(GRID)[0], access)
        return {str(entry.id): entry.value for entry in self.board.entries(TRAVEL)}


def test_a_way_that_could_not_be_sought_since_no_pose_was_near_in_time_is_sought_with_the_next_tile():
    house = House()
    house.board.now_s += 5.0  # the newest pose is five seconds old
    assert house.ask(1, 7.0, 3.0) is None
    by_tile = next(trigger for trigger in house.routes.triggers if trigger.kind is GRID)
    assert by_tile.when is not None
    assert by_tile.when(house.board.entries(GRID)[0])
    house.at(1.0, 3.0)
    route = house.look()
    assert route is not None
    assert route.state == "found"


def test_a_route_leads_through_the_door_and_says_where_it_is_narrow() -> None:
    house = House()
    assert house.look() is None  # nobody asked
    route = house.ask(1, 7.0, 3.0)
    assert route is not None
    assert route.state == "found"
    assert (route.way[0].x_m, route.way[0].y_m) == (1.0, 3.0)
    assert (route.way[-1].x_m, route.way[-1].y_m) == (7.0, 3.0)
    in_door = [point for point in route.way if abs(point.x_m - 4.0) < 0.15]
    assert in_door
    assert all(0.8 < point.y_m < 1.1 and point.room_m < 0.25 for point in in_door)
    assert route.way[0].room_m == pytest.approx(0.4, abs=0.06)  # no more is measured
    assert route.length_m == pytest.approx(2 * hypot(3.0, 2.05), abs=0.4)
    entry = house.board.newest(ROUTE)
    assert entry is not None
    supports = {s.key.split("/", 2)[2].rsplit("/", 1)[0] for s in entry.supports}
    assert {"motivations/motivation", "hypotheses/feature/grid", "status"} <= supports


def test_a_route_stays_while_it_is_free_and_goes_when_nobody_asks() -> None:
    house = House()
    house.ask(1, 7.0, 3.0)
    for step in range(20):
        house.at(1.0 + 0.1 * step, 3.0 - 0.08 * step, after_s=1.0)
        house.fill(5.0, 3.5, 5.5, 3.9 - 0.05 * step, 255)  # something else changes on the map
        house.post()
        house.look()
    entry = house.board.newest(ROUTE)
    assert entry is not None
    assert entry.revision == 1
    assert house.ask(2, 7.0, 3.0, on=False) is None


def test_another_motivation_asks_for_another_way() -> None:
    house = House()
    house.ask(1, 7.0, 3.0)
    route = house.ask(2, 3.0, 3.0)
    assert route is not None
    assert (route.goal.x_m, route.length_m) == (3.0, pytest.approx(2.0))


def test_a_closed_door_is_noticed_and_so_is_an_open_one() -> None:
    house = House()
    house.ask(1, 7.0, 3.0)
    house.fill(3.95, 0.5, 4.05, 1.4, 255)
    house.post()
    house.at(1.0, 3.0, after_s=1.0)
    route = house.look()
    assert route is not None
    assert (route.state, route.way) == ("none", ())
    house.fill(3.95, 2.5, 4.05, 3.4, 0)  # another door
    house.post()
    house.at(1.0, 3.0, after_s=1.0)
    route = house.look()
    assert route is not None
    assert route.state == "none"  # looked for again only every few seconds
    house.at(1.0, 3.0, after_s=5.0)
    route = house.look()
    assert route is not None
    assert (route.state, route.length_m) == ("found", pytest.approx(6.0, abs=0.2))


def test_a_way_is_changed_for_a_much_shorter_one_only() -> None:
    house = House()
    house.ask(1, 7.0, 3.0)
    house.fill(3.95, 1.4, 4.05, 1.6, 0)  # the door is wider than it seemed
    house.post()
    house.at(1.0, 3.0, after_s=6.0)
    house.look()
    entry = house.board.newest(ROUTE)
    assert entry is not None
    assert entry.revision == 1
    house.fill(3.95, 2.0, 4.05, 4.0, 0)
    house.post()
    house.at(1.0, 3.0, after_s=6.0)
    route = house.look()
    assert route is not None
    assert route.length_m == pytest.approx(6.0)


def test_a_robot_that_was_pushed_off_its_way_or_corrected_gets_another() -> None:
    house = House()
    house.ask(1, 3.0, 3.0)
    house.at(1.5, 3.3, after_s=1.0)
    house.look()
    entry = house.board.newest(ROUTE)
    assert entry is not None
    assert entry.revision == 1
    house.board.post(MAP_FROM_ODOM, Pose(x_m=0.0, y_m=-1.5, heading_rad=0.0), source="re_reference")
    house.at(1.5, 3.3, after_s=1.0)
    route = house.look()
    assert route is not None
    assert (route.way[0].x_m, route.way[0].y_m) == (1.5, pytest.approx(1.8))


def test_travel_is_as_long_as_the_way_and_unreachable_where_there_is_none() -> None:
    house = House()
    house.target("frontier-1", 3.0, 3.0)
    house.target("frontier-2", 7.0, 3.0)
    house.target("frontier-3", 10.0, 3.0)
    travel = house.measure()
    assert travel["frontier-1"].length_m == pytest.approx(2.0, abs=0.15)
    assert travel["frontier-2"].length_m == pytest.approx(7.5, abs=0.6)
    assert travel["frontier-2"].stand == Point(x_m=7.0, y_m=3.0)
    assert travel["frontier-3"].state == "unreachable"
    house.board.retract(TARGET, "frontier-3", source="targets")
    assert list(house.measure()) == ["frontier-1", "frontier-2"]


def test_a_target_is_looked_at_from_elsewhere_where_its_stand_cannot_be_reached() -> None:
    house = House()
    house.target("line_end-1", 3.9, 3.0, stand=(4.5, 3.0))  # behind the wall
    house.fill(3.95, 0.5, 4.05, 1.4, 255)
    house.post()
    travel = house.measure()["line_end-1"]
    assert travel.state == "reachable"
    assert 3.5 < travel.stand.x_m < 3.75
    assert travel.length_m == pytest.approx(travel.stand.x_m - 1.0, abs=0.2)


def test_travel_is_measured_anew_when_the_robot_has_gone_on_and_told_when_it_changed() -> None:
    house = House()
    house.target("frontier-1", 7.0, 3.0)
    first = house.measure()["frontier-1"]
    house.at(1.4, 3.0, after_s=6.0)
    assert house.measure()["frontier-1"] == first  # moved by too little
    house.at(2.5, 2.0, after_s=1.0)
    second = house.measure()["frontier-1"]
    assert second.length_m < first.length_m - 1.0
    house.at(1.0, 3.0, after_s=2.0)
    assert house.measure()["frontier-1"] == second  # too soon
    house.target("frontier-2", 1.0, 1.0)  # but not for a new target
    assert house.measure()["frontier-1"].length_m == pytest.approx(first.length_m)
    entry = house.board.newest(TRAVEL, "frontier-1")
    assert entry is not None
    assert entry.revision == 3


def test_what_is_news_of_a_travel() -> None:
    params, here = TravelParams(), Point(x_m=0.0, y_m=0.0)
    told = Travel(state="reachable", stand=here, length_m=4.0)
    assert not is_news(told, Travel(state="reachable", stand=here, length_m=4.4), params)
    assert is_news(told, Travel(state="reachable", stand=here, length_m=3.1), params)
    assert is_news(told, Travel(state="unreachable", stand=here, length_m=4.0), params)
    assert is_news(told, Travel(state="reachable", stand=Point(x_m=0.3, y_m=0.0), length_m=4.0), params)
    assert not is_news(
        Travel(state="reachable", stand=here, length_m=20.0),
        Travel(state="reachable", stand=here, length_m=21.0),
        params,
    )


def test_parameters() -> None:
    for params, key, value in (
        (RoutesParams, "strayed_m", 0.0),
        (RoutesParams, "block_m", 5.0),
        (TravelParams, "look_radii", -1.0),
        (TravelParams, "escape_m", -1.0),
    ):
        with pytest.raises(MissionError, match=key):
            parse_parameters(params, {key: value}, "m.toml")
