"""A component's hand on the board: it may read and post what it declared, and everything it posts bears its name."""

from collections.abc import Iterable, Sequence
from typing import Any, Literal, TypeVar

from blackboard.board import Board
from blackboard.entry import Entry, Strength, Support
from blackboard.errors import BoardError
from blackboard.kinds import Kind
from blackboard.messages.base import Message

M = TypeVar("M", bound=Message)
Area = tuple[float, float, float, float]


class Access:
    """Reads and posts on the board in one component's name.

    Every method raises BoardError when the component did not declare the kind, and MessageError when a value is unfit.
    """

    def __init__(self, board: Board, name: str, reads: Iterable[Kind[Any]], posts: Iterable[Kind[Any]]) -> None:
        self.name = name
        self._board = board
        self._posts = frozenset(posts)
        self._reads = frozenset(reads) | self._posts
        self._seen: dict[str, Entry[Any]] = {}

    @property
    def now_s(self) -> float:
        """The mission's clock."""
        return self._board.now_s

    def newest(self, kind: Kind[M], id: str | None = None) -> Entry[M] | None:
        """Return the standing entry of a slot, or of one id of a collection; None where nothing stands."""
        self._may_read(kind)
        entry = self._board.newest(kind, id)
        if entry is not None:
            self._seen[entry.key] = entry
        return entry

    def entries(
        self, kind: Kind[M], *, area: Area | None = None, since_s: float | None = None, until_s: float | None = None
    ) -> list[Entry[M]]:
        """Return what stands of a kind, in key order: within an area (x_min, y_min, x_max, y_max; m, map frame) and by stamp."""
        self._may_read(kind)
        return self._board.entries(kind, area=area, since_s=since_s, until_s=until_s)

    def own(self, kind: Kind[M]) -> list[Entry[M]]:
        """Return what stands of a kind by this component's posting: after a restart, also what it does not remember."""
        return [entry for entry in self.entries(kind) if entry.source == self.name]

    def last_number(self, kind: Kind[Any], prefix: str = "") -> int:
        """Return the highest number among the ids `<prefix><number>` that stand or stood, 0 where there is none."""
        self._may_read(kind)
        numbers = [id_[len(prefix) :] for id_ in self._board.ids(kind) if id_.startswith(prefix)]
        return max((int(n) for n in numbers if n.isascii() and n.isdigit()), default=0)

    def revisions(self, support: Support) -> list[Entry[Any]]:
        """Return those revisions of a stretch that the board still holds, oldest first."""
        return self._board.revisions(support)

    def around(self, kind: Kind[M], stamp_s: float) -> tuple[Entry[M] | None, Entry[M] | None]:
        """Return the newest revision of a slot at or before `stamp_s`, and the first one after it."""
        self._may_read(kind)
        return self._board.around(kind, stamp_s)

    def post(
        self,
        kind: Kind[M],
        value: M,
        *,
        id: str | None = None,
        supports: Sequence[Entry[Any] | Support] = (),
        stamp_s: float | None = None,
    ) -> Entry[M]:
        """Post or revise an entry; `stamp_s` is now unless given (a reading's time for what was derived from it)."""
        self._may_post(kind)
        named = tuple(s if isinstance(s, Support) else s.as_support() for s in supports)
        return self._board.post(kind, value, source=self.name, id=id, supports=named, stamp_s=stamp_s)

    def retract(self, kind: Kind[Any], id: str | None = None) -> None:
        """Take an entry off the board; its last value stays readable in the record."""
        self._may_post(kind)
        self._board.retract(kind, id, source=self.name)

    def endorse(
        self,
        entry: Entry[Any],
        verdict: Literal["for", "against"],
        why: str,
        *,
        about: str = "",
        strength: Strength = "fair",
    ) -> Entry[Any]:
        """Say something for or against any entry: a revision of it with this endorsement added.

        One component may have several reasons, told apart by what they are `about`; its last word about each stands.
        """
        return self._board.endorse(entry.key, who=self.name, verdict=verdict, why=why, about=about, strength=strength)

    def withdraw(self, entry: Entry[Any], about: str, why: str) -> Entry[Any]:
        """Take back what this component said of an entry about one thing, with the reason why."""
        return self._board.endorse(entry.key, who=self.name, verdict="withdrawn", why=why, about=about)

    def take_seen(self) -> tuple[Entry[Any], ...]:
        """Return what `newest` gave since the last call: the supports of a reactive answer."""
        seen = tuple(self._seen.values())
        self._seen.clear()
        return seen

    def _may_read(self, kind: Kind[Any]) -> None:
        if kind not in self._reads:
            raise BoardError(f"{self.name} read '{kind.path}' without declaring it; add the kind to its 'reads'")

    def _may_post(self, kind: Kind[Any]) -> None:
        if kind not in self._posts:
            raise BoardError(f"{self.name} posted '{kind.path}' without declaring it; add the kind to its 'posts'")
