"""What a host runs, stage by stage, on a replica without a link."""

import pytest

from blackboard.assembly import assemble
from blackboard.board import Board
from blackboard.kinds import BEHAVIOUR, CYCLE, DRIVE, RULES, VELOCITY
from blackboard.link.behaviour_stage import BehaviourStage
from blackboard.link.robot_stage import COMMAND_GOOD_S, RobotStage
from blackboard.link.rules_stage import SHOW_S, RulesStage
from blackboard.messages.motion import BehaviourStatus, Velocity
from blackboard.mission import find_mission, load_mission


@pytest.fixture(scope="module")
def mission():
    return load_mission(find_mission("explore-lab"))


@pytest.fixture
def assembly(mission):
    return assemble(mission)


@pytest.fixture
def board(assembly):
    board = Board(assembly.vocabulary, robot="k2a")
    board.outgoing = lambda kind, entry, raw: None
    return board


def wanted(board, forward_mps=0.2):
    velocity = Velocity(forward_mps=forward_mps, turn_radps=0.0, valid_until_s=board.now_s + 10.0)
    board.post(VELOCITY, velocity, source="coordinator")


def test_rules_wait_for_behaviours_to_show_themselves(board, assembly):
    rules = RulesStage(board, assembly, assembly.planner)
    rules.decide()
    assert board.newest(RULES) is None
    for behaviour, _ in assembly.behaviours:
        board.post(BEHAVIOUR, BehaviourStatus(state="idle"), id=behaviour.name, source=behaviour.name)
    rules.decide()
    assert board.newest(RULES) is not None
    rules.close()


def test_rules_do_not_wait_for_ever(board, assembly):
    rules = RulesStage(board, assembly, assembly.planner)
    rules.decide()
    board.now_s = SHOW_S + 0.1
    rules.decide()
    assert board.newest(RULES) is not None
    rules.close()


def test_behaviours_answer_a_cycle_of_the_robot_once(board, assembly):
    robot, behaviours = RobotStage(board, assembly), BehaviourStage(board, assembly)
    robot.begin(0.0)
    robot.cycle()
    assert behaviours.due()
    behaviours.answer()
    assert not behaviours.due()
    robot.cycle()
    assert behaviours.due()


def test_behaviours_go_on_by_themselves_where_the_robot_is_silent(board, assembly):
    behaviours = BehaviourStage(board, assembly)
    behaviours.answer()
    board.now_s += 2.4 * assembly.mission.params.step_s
    assert not behaviours.due()
    board.now_s += 0.2 * assembly.mission.params.step_s
    assert behaviours.due()


def test_a_command_moves_the_robot_while_it_is_young_whatever_it_says_of_itself(board, assembly):
    robot = RobotStage(board, assembly)
    robot.begin(0.0)
    robot.cycle()
    wanted(board)
    assert robot.commanded_anew
    robot.obey()
    assert board.newest(DRIVE).value.forward_mps > 0.0
    board.now_s += COMMAND_GOOD_S + 0.01
    robot.obey()
    assert board.newest(DRIVE).value.limited_by == "no command"


def test_a_robot_that_was_stopped_for_long_stands_through_the_cycles_it_missed(board, assembly):
    robot = RobotStage(board, assembly)
    robot.begin(0.0)
    robot.cycle()
    wanted(board)
    robot.obey()
    before = robot.robot.true_pose()
    for _ in range(100):  # ten seconds, caught up with
        robot.cycle()
    moved_m = robot.robot.true_pose().distance_m(before)
    assert 0.0 < moved_m < 0.2  # what it drove while the command was good, and braking
    assert board.newest(DRIVE).value.limited_by == "no command"
    assert board.newest(CYCLE).value.number == 101
