"""Kept states as parts of the simulation hand them out and take them back: records by attribute name."""

from collections.abc import Mapping
from typing import Any

from blackboard.errors import CheckpointError


def as_record(state: object) -> Mapping[str, Any]:
    """Return a kept state as a record; raise CheckpointError where it is none."""
    if not isinstance(state, dict):
        raise CheckpointError(f"a kept state is a {type(state).__name__} and should be a record; begin the run anew")
    return state
