"""What the members of a board may do there, by role: pure functions from members to key expressions.

Everything that is not allowed here is denied. Nobody may delete a key (a retraction is a revision like any other), and nobody but
the keeper answers questions about the board: its own session is the router itself, which asks nobody.
"""

from collections.abc import Iterable
from dataclasses import dataclass

from blackboard.key_expressions import matches
from blackboard.keys.members import Member

READABLE = (  # a verbatim chunk (@...) is matched by no wildcard, so each stands here by itself
    "ski/**",
    "ski/@keeper/**",
    "ski/*/@keeper/**",
    "ski/*/@hosts/**",
    "ski/@agents/**",
    "ski/@manager/**",
)
MANAGER = "manager"  # the host that `ski up` is while it says how the processes of its mission fare
ASKABLE = (
    "ski/**",
    "ski/@keeper/**",
    "ski/@agents/*/state",
    *(f"ski/*/@keeper/{what}" for what in ("clock", "snapshot", "lost")),
)

# What a role posts, below ski/<robot>/. A viewer posts nothing.
POSTS: dict[str, tuple[str, ...]] = {
    "viewer": (),
    "planner": (
        "motivations/**",
        *(f"control/{name}/**" for name in ("firing", "fact", "switch", "focus", "rules", "rule_error")),
        *(f"status/{name}/**" for name in ("communication_error", "mission", "component")),
    ),
    # All but what the safety layer decides by (the readings, the body's description) and what it decides.
    "operator": (
        "observations/feature/**",
        "observations/symbol/**",
        "hypotheses/**",
        "motivations/**",
        "control/**",
        *(f"status/{name}/**" for name in ("mission", "process", "behaviour", "component", "communication_error")),
        "commands/velocity",
    ),
    "robot": (
        "observations/signal/**",
        "commands/**",
        "control/switch/**",
        *(f"status/{name}/**" for name in ("robot", "robot_summary", "true_pose", "behaviour", "component")),
    ),
    "knowledge": (
        "observations/feature/**",
        "observations/symbol/**",
        "hypotheses/**",
        "motivations/resolution_task/**",
        "status/component/**",
        *(f"control/{name}/**" for name in ("agenda", "activation", "activation_time")),
    ),
    "agent": (),
}
MEANINGS = {
    "viewer": "reads",
    "planner": "reads; posts motivations, and what the planning module says of its rules",
    "operator": "reads; posts everything but readings, the robot's description and what goes to the wheels; starts and stops hosts",
    "robot": "reads; posts readings, commands and the status of its behaviours, for its own robot",
    "knowledge": "reads; posts features, symbols, hypotheses and the status of its sources",
    "agent": "reads; starts and stops hosts on its machine when an operator asks",
}


@dataclass(frozen=True, slots=True)
class Rights:
    """Key expressions under which a member may put, ask, serve answers, and announce that it lives."""

    puts: tuple[str, ...] = ()
    asks: tuple[str, ...] = ()
    serves: tuple[str, ...] = ()
    announces: tuple[str, ...] = ()


def rights(member: Member) -> Rights:
    """Return what a member may do beside reading; nothing where it was revoked."""
    if member.revoked:
        return Rights()
    robots = member.robots or ("*",)
    posts = tuple(dict.fromkeys(path for role in member.roles for path in POSTS[role]))
    manager = (MANAGER,) if "operator" in member.roles else ()
    hosts = tuple(f"ski/{robot}/@hosts/{host}/**" for robot in robots for host in (*member.hosts, *manager))
    puts = [f"ski/{robot}/{path}" for robot in robots for path in posts] + list(hosts)
    asks = [*ASKABLE, *(f"ski/{robot}/@late/{path}" for robot in robots for path in posts)]
    announces = list(hosts)
    serves: list[str] = []
    if "robot" in member.roles:
        asks += [f"ski/{robot}/@keeper/begin" for robot in robots]
    if "operator" in member.roles:
        machines = ["ski/@agents/**", "ski/@manager/**"]  # `ski up` brings an executor of its own
        puts += machines
        asks += machines
        serves += machines
        announces += machines
    if "agent" in member.roles:
        own = f"ski/@agents/{member.name}/**"
        puts.append(own)
        serves.append(own)
        announces.append(own)
    return Rights(tuple(puts), tuple(asks), tuple(serves), tuple(announces))


def may_put(member: Member, key: str) -> bool:
    """Say whether a member may put under a concrete key: what the keeper would not reject."""
    return _any(rights(member).puts, key)


def _any(expressions: Iterable[str], key: str) -> bool:
    return any(matches(expression, key) for expression in expressions)
