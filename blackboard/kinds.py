"""Every kind of entry, once: its place on the board and the type of its values.

A kind's path is `panel/level/name` on the two panels that have levels (observations, hypotheses) and `panel/name` on the
others. On the wire its key is `ski/<robot>/<path>` for a slot and `ski/<robot>/<path>/<id>` for a member of a collection.
"""

from dataclasses import dataclass
from typing import Generic, TypeVar

from blackboard.errors import BoardError
from blackboard.key_expressions import is_chunk
from blackboard.messages import (
    conflicts,
    control,
    hosts,
    mapping,
    model,
    motion,
    processes,
    routes,
    sensing,
    symbols,
    world,
)
from blackboard.messages.base import Message
from blackboard.messages.geometry import Pose

PANELS = ("observations", "hypotheses", "motivations", "status", "commands", "control")
LEVELS = ("signal", "feature", "symbol")
LEVELLED_PANELS = ("observations", "hypotheses")

M = TypeVar("M", bound=Message)


@dataclass(frozen=True, eq=False)
class Kind(Generic[M]):
    """A declared place on the board: `path`, the `type` of its values, one slot or a collection.

    `shared` collections may have several posters, each owning its ids. What is not `recorded` (measured times) stays out of
    `board.jsonl`, since it differs from run to run. What is `large` lets all else pass on
    a link. Raises BoardError where the path is not of the form above.
    """

    path: str
    type: type[M]
    doc: str
    collection: bool = False
    shared: bool = False
    recorded: bool = True
    large: bool = False

    def __post_init__(self) -> None:
        chunks = self.path.split("/")
        if chunks[0] not in PANELS:
            raise BoardError(f"kind '{self.path}': the panel '{chunks[0]}' is none of {', '.join(PANELS)}")
        levelled = chunks[0] in LEVELLED_PANELS
        if len(chunks) != (3 if levelled else 2) or (levelled and chunks[1] not in LEVELS):
            form = f"{chunks[0]}/<{'|'.join(LEVELS)}>/<name>" if levelled else f"{chunks[0]}/<name>"
            raise BoardError(f"kind '{self.path}': the path must be of the form {form}")
        if not all(is_chunk(chunk) for chunk in chunks):
            raise BoardError(f"kind '{self.path}': a part may hold letters, digits, '_', '-' and '.' only")

    @property
    def panel(self) -> str:
        return self.path.split("/")[0]

    @property
    def level(self) -> str | None:
        return self.path.split("/")[1] if self.panel in LEVELLED_PANELS else None

    @property
    def name(self) -> str:
        return self.path.rsplit("/", 1)[1]


def slot(path: str, type_: type[M], doc: str, *, recorded: bool = True, large: bool = False) -> Kind[M]:
    """Declare a kind with a single entry, such as the newest scan."""
    return Kind(path, type_, doc, recorded=recorded, large=large)


def collection(
    path: str, type_: type[M], doc: str, *, shared: bool = False, recorded: bool = True, large: bool = False
) -> Kind[M]:
    """Declare a kind with one entry for each id, such as lines."""
    return Kind(path, type_, doc, collection=True, shared=shared, recorded=recorded, large=large)


# fmt: off
SONAR_SCAN = slot("observations/signal/sonar_scan", sensing.SonarScan, "echoes of a sonar ring")
LASER_SCAN = slot("observations/signal/laser_scan", sensing.LaserScan, "one sweep of a laser")
BLOBS = slot("observations/signal/blobs", sensing.BlobScan, "the coloured stretches that a camera sees")
ODOMETRY = slot("observations/signal/odometry", sensing.Odometry, "what the wheels say")
BUMPER = slot("observations/signal/bumper", sensing.Bumper, "what the bumper touches")
BATTERY = slot("observations/signal/battery", sensing.Battery, "charge left")
CYCLE = slot("observations/signal/cycle", hosts.CycleBeat, "all readings of a control cycle are there", recorded=False)
ODOM_FROM_ROBOT = slot("observations/feature/odom_from_robot", Pose, "the robot in the odometry frame: smooth, drifts")
SUPPORTED_POINTS = slot("observations/feature/supported_points", world.PointSet, "readings that the grid bears out", large=True)
LINE = collection("observations/feature/line", world.Line, "a line seen in one batch of points, id <batch>-<number>")
LINE_SET = slot("observations/feature/line_set", model.LineSet, "the ids of a batch's lines, after all of them")
MAP_FROM_ODOM = slot("hypotheses/feature/map_from_odom", Pose, "the odometry frame in the map: moved by re-references only")
CORRECTED_PATH = slot("hypotheses/feature/corrected_path", mapping.CorrectedPath, "the way, as it looks from the end", large=True)
GRID = collection("hypotheses/feature/grid", world.GridTile, "the empty-occupied-unknown grid, id <column>_<row>", large=True)
MODEL_LINE = collection("hypotheses/feature/model_line", model.ModelLine, "a wall as known from all that was seen of it")
LINE_MATCHES = slot("hypotheses/feature/line_matches", model.LineMatches, "which observed lines are which model lines")
EXPECTED_LINES = slot("hypotheses/feature/expected_lines", model.ExpectedLines, "the lines that should be in view")
POSE_ESTIMATE = slot("hypotheses/feature/pose_estimate", model.PoseEstimate, "map_from_robot with its covariance")
RE_REFERENCE = slot("hypotheses/feature/re_reference", model.ReReference, "what a batch of matches makes of the pose")
NEW_AREA_VISITED = collection("hypotheses/symbol/new_area_visited", model.NewAreaVisited, "a line that matched nothing")
POSE_CONFLICT = collection("hypotheses/symbol/pose_conflict", model.PoseConflict, "a jump of the pose that was refused, id <batch>")
CORNER = collection("hypotheses/symbol/corner", symbols.Corner, "where two lines meet or nearly meet")
LINE_RELATION = collection("hypotheses/symbol/line_relation", symbols.LineRelation, "lines that are parallel or collinear")
TARGET = collection("hypotheses/symbol/target", symbols.Target, "a place worth a visit", shared=True)
FOUND_OBJECT = collection("hypotheses/symbol/found_object", symbols.FoundObject, "what was looked for", shared=True)
TRAP = collection("hypotheses/symbol/trap", symbols.Trap, "where reflexes alone would stay", shared=True)
CHANGE = collection("hypotheses/symbol/change", conflicts.Change, "where the map and what is seen differ")
TWO_PART_OBJECT = collection("hypotheses/symbol/two_part_object", conflicts.TwoPartObject, "a body and its part", shared=True)
VERDICT = collection("hypotheses/symbol/verdict", conflicts.Verdict, "what the reasons for a hypothesis amount to", shared=True)
ROUTE = slot("hypotheses/feature/route", routes.Route, "the way to where path-following goes")
TRAVEL = collection("hypotheses/feature/travel", routes.Travel, "how far it is to each target")
MOTIVATION = collection("motivations/motivation", motion.Motivation, "what a behaviour is asked to do", shared=True)
RESOLUTION_TASK = collection("motivations/resolution_task", conflicts.ResolutionTask, "what to do about a doubt")
ROBOT = slot("status/robot", sensing.RobotDescription, "body and sensors of the robot")
COMMUNICATION_ERROR = collection("status/communication_error", control.CommunicationError, "who did not acknowledge")
MISSION = slot("status/mission", motion.MissionStatus, "how the mission stands; the run ends once it is not underway")
COMPONENT = collection("status/component", control.ComponentStatus, "whether a component works", shared=True)
BEHAVIOUR = collection("status/behaviour", motion.BehaviourStatus, "where a behaviour stands", shared=True)
HOST = collection("status/host", hosts.HostStatus, "how a process of the mission fares", shared=True, recorded=False)
PROCESS = collection("status/process", processes.ProcessStatus, "how a host's process fares", shared=True, recorded=False)
TRUE_POSE = slot("status/true_pose", Pose, "where a simulated robot really is: for scores only", recorded=False)
ROBOT_SUMMARY = slot("status/robot_summary", hosts.RobotSummary, "a robot's own figures", recorded=False)
RESPONSE = collection("commands/response", motion.Response, "a behaviour's answer to the newest readings", shared=True)
VELOCITY = slot("commands/velocity", motion.Velocity, "what the coordinator wants")
DRIVE = slot("commands/drive", motion.Drive, "what goes to the wheels")
SWITCH = collection("control/switch", motion.Switch, "gain and threshold of a behaviour or level", shared=True)
FOCUS = collection("control/focus", control.Focus, "ratings of knowledge sources, as rules set them", shared=True)
RULES = slot("control/rules", control.RuleFiles, "the rule files in force")
FIRING = collection("control/firing", control.Firing, "the newest firing of each rule")
RULE_ERROR = collection("control/rule_error", control.RuleError, "what went wrong with a rule")
FACT = collection("control/fact", control.Fact, "facts that rules asserted, id <index>")
AGENDA = slot("control/agenda", control.Agenda, "activation records that wait")
ACTIVATION = collection("control/activation", control.Activation, "the newest activation of each knowledge source")
ACTIVATION_TIME = collection("control/activation_time", control.ActivationTime, "measured times", recorded=False)
# fmt: on
