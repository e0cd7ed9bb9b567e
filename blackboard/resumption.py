"""Components after a restart: each goes on from its state, or begins anew and says so.

Posts  status/component/<name>    ComponentStatus: running, with the reason why it began anew
"""

from collections.abc import Mapping
from typing import Any

from blackboard.access import Access
from blackboard.board import Board
from blackboard.component import Component
from blackboard.errors import SkiError
from blackboard.kinds import COMPONENT
from blackboard.messages.control import ComponentStatus

NOTHING: Mapping[str, object] = {}


def resume(component: Component[Any], states: Mapping[str, object], access: Access, board: Board) -> bool:
    """Let a component go on from its state among `states`; return whether it could. Without one it goes by the board."""
    state = states.get(component.name)
    try:
        component.resume(state, access)
    except Exception as error:
        text = str(error) if isinstance(error, SkiError) else f"{type(error).__name__}: {error}"
        show_anew(board, component.name, text)
        return False
    standing = board.newest(COMPONENT, component.name)
    if standing is not None and standing.value.state == "failed":
        board.post(COMPONENT, ComponentStatus(state="running"), id=component.name, source=component.name)
    return state is not None


def show_anew(board: Board, name: str, why: str) -> None:
    """Say that a component begins anew, or would after a restart."""
    status = ComponentStatus(state="running", error=f"after a restart it begins anew: {why}"[:4000])
    standing = board.newest(COMPONENT, name)
    if standing is None or standing.value != status:
        board.post(COMPONENT, status, id=name, source=name)


def state_of(component: Component[Any]) -> object:
    """Return a component's state; where it cannot say, an object that cannot be kept either, so that the reason is told."""
    try:
        return component.state()
    except Exception as error:
        return Unsaid(error)


class Unsaid:
    """The state of a component that could not tell it: pickling raises what it raised."""

    def __init__(self, error: Exception) -> None:
        self._error = error

    def __reduce__(self) -> str:
        raise self._error
