"""`ski up MISSION`: run a mission as processes, here and where its hosts say, to its end; results as of `ski run`."""

import argparse
import json
import os
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from importlib.metadata import version
from pathlib import Path

from blackboard.assembly import Assembly, assemble
from blackboard.command.connection import add_connection_options, link_params
from blackboard.command.ending import when_told_to_end
from blackboard.command.execute import add_run_options, new_folder
from blackboard.command.main import EXIT_ERROR, EXIT_INTERRUPTED
from blackboard.command.mission_options import add_mission_options, load, robot_settings
from blackboard.command.up_face import Face
from blackboard.command.up_results import take_journal, write_up_results, write_up_team_results
from blackboard.errors import LinkError, MissionError
from blackboard.key_expressions import is_chunk
from blackboard.link.session import LinkParams, open_session
from blackboard.members import members, share_world
from blackboard.mission import Mission, find_mission, shipped_missions
from blackboard.placement import placement
from blackboard.processes.child import last_line
from blackboard.processes.commands import SKI
from blackboard.processes.ground import agent_at, check_free, keeper_may_be, keeper_status, ours, wait_until_listening
from blackboard.processes.identity import identity_of
from blackboard.processes.local_agent import LocalAgent
from blackboard.processes.manager import MissionOrders, orders_of
from blackboard.processes.overseer import Overseer, manager_name
from blackboard.processes.protocol import KEEPER, Order, this_machine
from blackboard.processes.state_folder import AGENT, MANAGER, Record, StateFolder
from blackboard.report.output_folder import prepare_output_folder, prepare_team_folder
from blackboard.vocabulary import has_own_kinds

KEEPER_S = 20.0  # for a keeper to start
BOARD = "board"  # folder of the keeper's journal, below the results, while the mission runs


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verb's arguments."""
    add_mission_options(parser)
    add_connection_options(parser)
    parser.add_argument("--pace", type=float, default=1.0, help="mission seconds per second (default: %(default)g)")
    parser.add_argument(
        "--name", default=this_machine(), metavar="MACHINE", help="this machine, in `on = ...` (default: %(default)s)"
    )
    parser.add_argument("--detach", action="store_true", help="return when the robot moves; `ski down` ends it")
    parser.add_argument("--ready", type=int, help=argparse.SUPPRESS)  # where a detached one says that it is up
    add_run_options(parser, strict=False)


def call(options: argparse.Namespace) -> int:
    """Run the verb."""
    if not 0.01 <= options.pace <= 100:
        raise MissionError(f"--pace {options.pace:g}: must be in [0.01, 100]")
    if not is_chunk(options.name):
        raise MissionError(f"--name {options.name}: letters, digits, '_', '-' and '.' only")
    link = link_params(options)
    state = StateFolder(link.address)
    standing = state.record(MANAGER)
    if standing is not None:
        raise LinkError(
            f"{standing.mission} is up already at {link.address}; end it with `ski down`, or take another --connect"
        )
    path = find_mission(options.mission)
    if options.detach:
        return _detach(options, state)
    folder = Path(options.out) if options.out is not None else new_folder(path.stem)
    prepare_output_folder(folder, options.force)
    up = _Up(options, link, state, folder)
    with up.written_down(), when_told_to_end(up.hear):
        up.begin()
        seen = up.oversee()
    return up.conclude(seen)


class _Up:
    """One `ski up`, from the first process to the results."""

    def __init__(self, options: argparse.Namespace, link: LinkParams, state: StateFolder, folder: Path) -> None:
        self._options = options
        self._link = link
        self._state = state
        self._folder = folder
        self._name = manager_name()
        self._local: LocalAgent | None = None
        self._board: Path | None = None  # where our own keeper journals
        self._asked_to_end = False
        self._underway = False
        self._began_s = time.monotonic() - time.process_time()  # about when this process began

    @contextmanager
    def written_down(self) -> Iterator[None]:
        """Have `ski down` find this process, and leave none of its own behind."""
        me = identity_of(os.getpid())
        assert me is not None
        self._state.write(Record(name=MANAGER, who=me, mission=self._options.mission))
        try:
            yield
        finally:
            if self._local is not None:
                self._local.end()
                self._state.forget_hosts()
            self._state.drop(MANAGER)
            if not self._underway:  # nothing came of it
                if self._board is not None:
                    shutil.rmtree(self._board, ignore_errors=True)
                with suppress(OSError):
                    self._folder.rmdir()

    def hear(self) -> None:
        """Hear Ctrl-C or `ski down`: the first ends the mission in order, a second one at once."""
        if self._asked_to_end or not self._underway:
            raise KeyboardInterrupt
        self._asked_to_end = True

    def begin(self) -> None:
        """Start what is not there, keeper and executor, before the mission is read: they need a while themselves."""
        keys = self._link.keys is not None  # each part then has its own: the keeper's, an agent's, this operator's
        if not keeper_may_be(self._link):
            if not ours(self._link.address):
                raise LinkError(f"no keeper answers at {self._link.address}; start one there with `ski board serve`")
            waiting = self._state.record(AGENT)
            if waiting is not None:
                raise LinkError(
                    f"an agent (process {waiting.who.pid}) waits here for a keeper at {self._link.address}; start that with "
                    "`ski board serve`, or end the agent with `ski down`: `ski up` brings its own"
                )
            self._board = self._folder / BOARD
        else:
            with open_session(self._link) as session:
                keeper_status(session, self._link.address)
                if keys or agent_at(session, self._options.name):
                    return
        share = self._board is not None  # else a link was open here, and what had one must not fork
        self._local = LocalAgent(self._link, self._options.name, self._state.logs, lambda: None, share=share)
        if self._board is not None:
            mission = mission_name(self._options.mission)
            self._local.order(Order(manager=self._name, keeper_folder=str(self._board.absolute()), prepare=mission))

    def oversee(self) -> Overseer:
        """Run the mission to its end."""
        mission = load(self._options)
        missions = members(mission)
        assembly, *others = [assemble(its, self._options.seed) for its in missions]
        share_world(missions, [assembly.robot, *(other.robot for other in others)])
        robot = assembly.robot.description.name
        if others:
            robots = [robot, *(other.robot.description.name for other in others)]
            prepare_team_folder(self._folder, robots, force=True)
        if self._board is None:
            with open_session(self._link) as session:
                for each in (assembly, *others):
                    name = each.robot.description.name
                    check_free(keeper_status(session, self._link.address), name, self._link.address)
        orders = self._orders(mission, robot, has_own_kinds(assembly.vocabulary))
        if self._local is not None:
            self._local.fork_nursery()
            self._local.order(orders.of(self._options.name, self._name))
        if self._board is not None:
            log = self._state.logs / f"{KEEPER}.log"
            wait_until_listening(self._link.address, KEEPER_S, self._tend, lambda: last_line(log))
        overseer = Overseer(self._link, assembly, orders, self._name, version("sensory-knowledge-integrator"), others)
        overseer.local = self._local
        limit_s = self._limit_s(assembly)
        self._underway = True
        with overseer.running(), Face(overseer, self._began_s, self._options.ready) as face:
            while not (self._asked_to_end or overseer.over or overseer.elapsed_s >= limit_s):
                overseer.step()
                face.show()
            face.end()
        return overseer

    def conclude(self, seen: Overseer) -> int:
        """Write and show the results, when nothing runs any more."""
        robots = [each.robot.description.name for each in (seen.assembly, *seen.others)]
        if self._board is not None:
            folders = {robot: self._folder / robot if seen.others else self._folder for robot in robots}
            journals = {robot: take_journal(self._board, robot, folders[robot]) for robot in robots}
            shutil.rmtree(self._board, ignore_errors=True)
        else:
            journals = {robot: journal for robot, journal in seen.journals.items() if journal.is_file()}
        if len(journals) < len(robots):
            sys.stderr.write(
                f"ski: the keeper at {self._link.address} has the journal on its own machine: no results here\n"
            )
            return EXIT_INTERRUPTED if self._asked_to_end else 0
        interrupted = self._asked_to_end
        if seen.others:
            assemblies = (seen.assembly, *seen.others)
            return write_up_team_results(assemblies, journals, self._folder, self._options, interrupted=interrupted)
        journal = journals[robots[0]]
        return write_up_results(seen.assembly, journal, self._folder, self._options, interrupted=interrupted)

    def _orders(self, mission: Mission, robot: str, own_kinds: bool) -> MissionOrders:
        options = self._options
        name = mission_name(options.mission)
        settings = [
            *options.set,
            *(f"robot.{key}={json.dumps(value)}" for key, value in robot_settings(options).items()),
        ]
        return orders_of(
            placement(mission),
            mission=name,
            robot=robot,
            machine=options.name,
            seed=options.seed,
            pace=options.pace,
            settings=settings,
            keeper_folder=str(self._board.absolute()) if self._board is not None else None,
            keeper_mission=name if own_kinds else "",
        )

    def _limit_s(self, assembly: Assembly) -> float:
        if self._options.duration is not None:
            return float(self._options.duration)
        robot = assembly.robot
        return assembly.mission.params.duration_s if robot.end_s is None else robot.end_s - robot.start_s

    def _tend(self) -> None:
        if self._local is not None:
            self._local.tend(time.monotonic())


def mission_name(given: str) -> str:
    """Return a mission as processes elsewhere find it: a shipped one by its name, a file by its whole path."""
    return given if given in shipped_missions() else str(find_mission(given).absolute())


def _detach(options: argparse.Namespace, state: StateFolder) -> int:
    """Start another `ski up` that stays, and wait until it says that the robot moves."""
    ours, theirs = os.pipe()
    log = state.logs / "up.log"
    log.parent.mkdir(parents=True, exist_ok=True)
    given = [word for word in sys.argv[1:] if word != "--detach"]
    with log.open("wb") as out, os.fdopen(ours, "rb") as ready:
        command = [*SKI, *given, "--ready", str(theirs)]
        process = subprocess.Popen(  # noqa: S603
            command, stdin=subprocess.DEVNULL, stdout=out, stderr=out, start_new_session=True, pass_fds=[theirs]
        )
        os.close(theirs)
        said = ready.read().decode()
    if said:
        sys.stderr.write(f"ski: {said}; `ski ps` shows it, `ski down` ends it; log: {log}\n")
        return 0
    code = process.wait()
    sys.stderr.write(f"{last_line(log) or 'ski: it ended without a word'}\n")
    return code or EXIT_ERROR
