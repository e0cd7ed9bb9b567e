"""Which lines a source works on: those observed in single batches, or those of the model."""

from typing import Any, Literal

from blackboard.kinds import LINE, MODEL_LINE, Kind

Lines = Literal["observed", "model"]


def line_kind(lines: Lines) -> Kind[Any]:
    """Return the kind that a mission's `lines = "observed"` or `"model"` names."""
    return MODEL_LINE if lines == "model" else LINE
