"""What people write for keys becomes zenoh's key expressions, and back."""

from blackboard.key_expressions import check_expression

EVERYTHING = "**"


def expression_of(pattern: str) -> str:
    """Return the key expression that a pattern means; raise BoardError where it is none.

    What does not begin with `ski/` is meant on every robot's board. What holds no wildcard means itself and all below it.
    """
    if pattern == EVERYTHING:
        return "ski/**"
    whole = pattern if pattern.startswith("ski/") else f"ski/*/{pattern}"
    if "*" not in pattern:
        whole += "/**"
    check_expression(whole)
    return whole
