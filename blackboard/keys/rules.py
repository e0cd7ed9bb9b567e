"""zenoh's access control for the keeper's router, from the list of members: everything is denied that is not allowed here."""

from collections.abc import Iterable
from typing import Any

from blackboard.keys.members import Member
from blackboard.keys.roles import READABLE, rights

WATCHING = ("declare_subscriber", "liveliness_query", "declare_liveliness_subscriber")
ARRIVING = ("put", "liveliness_token", "declare_subscriber", "declare_queryable")


def access_control(members: Iterable[Member]) -> dict[str, Any]:
    """Return the `access_control` table; subjects are certificates' common names.

    Certificates that were revoked or renewed have a rule too, which denies: so the log can say whose they were.
    """
    rules: list[dict[str, Any]] = [
        _rule("watch", "ingress", WATCHING, READABLE),
        _rule("arrive", "egress", ARRIVING, READABLE),
        {**_rule("withdrawn", "ingress", ("put",), READABLE), "permission": "deny"},
    ]
    subjects: list[dict[str, Any]] = []
    policies: list[dict[str, Any]] = []
    for member in members:
        own = [] if member.revoked else _own(member)
        rules += own
        names = ["withdrawn"] if member.revoked else ["watch", "arrive", *(rule["id"] for rule in own)]
        subjects.append({"id": member.common_name, "cert_common_names": [member.common_name]})
        policies.append({"rules": names, "subjects": [member.common_name]})
        before = [f"{member.name}.{generation}" for generation in range(1, member.generation)]
        if before:
            subjects.append({"id": f"{member.name} before", "cert_common_names": before})
            policies.append({"rules": ["withdrawn"], "subjects": [f"{member.name} before"]})
    return {
        "enabled": True,
        "default_permission": "deny",
        "rules": rules,
        "subjects": subjects,
        "policies": policies,
    }


def _own(member: Member) -> list[dict[str, Any]]:
    may = rights(member)
    name = member.common_name
    rules = [
        _rule(f"{name} puts", "ingress", ("put",), may.puts),
        _rule(f"{name} asks", "ingress", ("query",), may.asks),
        _rule(f"{name} is answered", "egress", ("reply",), may.asks),
        _rule(f"{name} serves", "ingress", ("declare_queryable", "reply"), may.serves),
        _rule(f"{name} is asked", "egress", ("query",), may.serves),
        _rule(f"{name} announces", "ingress", ("liveliness_token",), may.announces),
    ]
    return [rule for rule in rules if rule["key_exprs"]]


def _rule(name: str, flow: str, messages: Iterable[str], key_expressions: Iterable[str]) -> dict[str, Any]:
    return {
        "id": name,
        "permission": "allow",
        "flows": [flow],
        "messages": list(messages),
        "key_exprs": list(key_expressions),
    }
