"""The blackboard: entries by key, posted, revised, retracted, endorsed, read, and watched.

Whoever posts sees its subscribers called before `post` returns; they must only take note (the control module puts an activation
record on its agenda), so posts never nest. In an embedded run there is one board, in lock-step. Across processes each has a
replica: what is posted there goes to `outgoing`, and what others have posted comes in by `accept`.
"""

from collections import OrderedDict
from collections.abc import Callable, Iterable
from typing import Any, TypeVar

from msgspec.structs import replace

from blackboard.entry import Endorsement, Entry, Event, Strength, Support, Verdict
from blackboard.errors import BoardError
from blackboard.history import History, HistoryParams
from blackboard.key_expressions import check_expression, is_chunk, matches
from blackboard.kinds import Kind
from blackboard.link.merge import life_of, merged, retracted_s
from blackboard.messages.base import Message
from blackboard.revisions import Area, next_revision, within, without_oldest
from blackboard.vocabulary import Vocabulary, checked

M = TypeVar("M", bound=Message)
Watcher = Callable[[Entry[Any]], None]
Journal = Callable[[Entry[Any], bytes], None]
Outgoing = Callable[[Kind[Any], Entry[Any], bytes], None]
MAX_GONE = 10_000  # retracted keys that a replica remembers, so that nothing old brings them back
MAX_ENDORSEMENTS = 500  # of one entry; of an endless back and forth the newest are kept


class Board:
    """One robot's board. `journal`, where set, is told of every recorded post with its value's JSON, in order; `outgoing`, where
    set, of every post of this process, recorded or not.
    """

    def __init__(
        self,
        vocabulary: Vocabulary,
        *,
        robot: str = "robot",
        history: HistoryParams | None = None,
        journal: Journal | None = None,
    ) -> None:
        if not is_chunk(robot):
            raise BoardError(f"robot name '{robot}': letters, digits, '_', '-' and '.' only")
        self.vocabulary = vocabulary
        self.robot = robot
        self.now_s = 0.0
        self.posts = 0
        self.history = History(history or HistoryParams())
        self.journal = journal
        self.outgoing: Outgoing | None = None
        self._gone: OrderedDict[str, Entry[Any]] = OrderedDict()  # retractions seen, where there are other replicas
        self._standing: dict[str, Entry[Any]] = {}
        self._members: dict[str, dict[str, str]] = {}  # path of a collection: id to key, in order of posting
        self._owners: dict[str, str] = {}
        self._keys: dict[tuple[str, str | None], str] = {}
        self._watchers: list[tuple[str, Watcher]] = []
        self._watching: dict[str, tuple[Watcher, ...]] = {}

    # Reading

    def key(self, kind: Kind[Any], id: str | None = None) -> str:
        """Return the key of a slot or of a member; raise BoardError where the id is missing, superfluous or malformed."""
        key = self._keys.get((kind.path, id))
        if key is not None:
            return key
        if kind not in self.vocabulary:
            raise BoardError(f"kind '{kind.path}' is not part of this mission's vocabulary; declare it in a component")
        if kind.collection != (id is not None):
            need = "needs an id" if kind.collection else "is a slot and takes no id"
            raise BoardError(f"kind '{kind.path}' {need}")
        if id is not None and not is_chunk(id):
            raise BoardError(f"id '{id}' of '{kind.path}': letters, digits, '_', '-' and '.' only")
        key = f"ski/{self.robot}/{kind.path}" + (f"/{id}" if id is not None else "")
        if id is None or len(self._keys) < 10_000:
            self._keys[(kind.path, id)] = key
        return key

    def newest(self, kind: Kind[M], id: str | None = None) -> Entry[M] | None:
        """Return what stands in a slot, or of one member; None where nothing does."""
        return self._standing.get(self.key(kind, id))

    def at(self, key: str) -> Entry[Any] | None:
        """Return what stands at a key."""
        return self._standing.get(key)

    def entries(
        self, kind: Kind[M], *, area: Area | None = None, since_s: float | None = None, until_s: float | None = None
    ) -> list[Entry[M]]:
        """Return what stands of a kind, in order of first posting, within an area (x_min, y_min, x_max, y_max) and a time."""
        if not kind.collection:
            entry = self.newest(kind)
            found = [entry] if entry is not None else []
        else:
            found = [self._standing[key] for key in self._members.get(kind.path, {}).values()]
        return [e for e in found if within(e, area, since_s, until_s)]

    def ids(self, kind: Kind[Any]) -> list[str]:
        """Return the ids of a collection that stand, and those that stood before as far as they are remembered."""
        prefix = f"ski/{self.robot}/{kind.path}/"
        gone = [key[len(prefix) :] for key in (*self._gone, *self.history.retired) if key.startswith(prefix)]
        return list(dict.fromkeys((*self._members.get(kind.path, {}), *gone)))

    def select(
        self,
        expression: str = "**",
        *,
        panel: str | None = None,
        level: str | None = None,
        area: Area | None = None,
        since_s: float | None = None,
        until_s: float | None = None,
    ) -> list[Entry[Any]]:
        """Return what stands on the whole board, in key order, by key expression, panel, level, area and time."""
        check_expression(expression)
        found = []
        for key in sorted(self._standing):
            kind = self.vocabulary.parse_key(key)[1]
            if (
                (panel is None or kind.panel == panel)
                and (level is None or kind.level == level)
                and matches(expression, key)
            ):
                entry = self._standing[key]
                if within(entry, area, since_s, until_s):
                    found.append(entry)
        return found

    def revisions(self, support: Support) -> list[Entry[Any]]:
        """Return the revisions of a stretch that are still remembered, oldest first."""
        return self.history.revisions(support)

    def around(self, kind: Kind[M], stamp_s: float) -> tuple[Entry[M] | None, Entry[M] | None]:
        """Return the newest revision of a slot at or before `stamp_s`, and the first one after it."""
        return self.history.around(self.key(kind), stamp_s)

    # Writing

    def post(
        self,
        kind: Kind[M],
        value: M,
        *,
        source: str,
        id: str | None = None,
        supports: tuple[Support, ...] = (),
        stamp_s: float | None = None,
    ) -> Entry[M]:
        """Post or revise; return the new entry.

        Raises MessageError for a value unfit for its key, BoardError for an undeclared kind, another's slot, or a stamp older than
        what stands: the latest revision by stamp wins, so an older one would be lost.
        """
        key = self.key(kind, id)
        value, raw = checked(kind, key, value)
        standing = self._standing.get(key)
        stamp = self.now_s if stamp_s is None else stamp_s
        event: Event = "posted"
        endorsements: tuple[Endorsement, ...] = ()
        if standing is None:
            self._claim(kind, key, source)
            gone = self._gone.get(key)
            revision = max(self.history.last_revision(key), gone.revision if gone is not None else 0) + 1
            if gone is not None:
                stamp = max(stamp, gone.stamp_s)
            if kind.collection and id is not None:
                self._members.setdefault(kind.path, {})[id] = key
        else:
            if standing.source != source and self._owners[key] != source:
                raise BoardError(f"{key} belongs to {self._owners[key]}; {source} may endorse it, not post it")
            revision, event, endorsements = standing.revision + 1, "revised", standing.endorsements
        if standing is not None and stamp < standing.stamp_s and self.outgoing is not None:
            stamp = standing.stamp_s  # another host's clock, a little ahead
        if standing is not None and stamp < standing.stamp_s:
            raise BoardError(
                f"{key}: stamp {stamp:.6f} s is older than the standing revision's {standing.stamp_s:.6f} s"
            )
        entry = Entry(
            key=key,
            id=id,
            revision=revision,
            event=event,
            stamp_s=stamp,
            source=source,
            value=value,
            supports=supports,
            endorsements=endorsements,
        )
        self._standing[key] = entry
        self._publish(kind, entry, raw)
        return entry

    def retract(self, kind: Kind[Any], id: str | None = None, *, source: str) -> None:
        """Take an entry off the board; raise BoardError where nothing stands or it belongs to another source."""
        key = self.key(kind, id)
        standing = self._standing.get(key)
        if standing is None:
            raise BoardError(f"{key}: nothing stands there to be retracted")
        if self._owners[key] != source:
            raise BoardError(f"{key} belongs to {self._owners[key]}; {source} may endorse it, not retract it")
        self._remove(kind, key, id)
        entry = next_revision(standing, event="retracted", stamp_s=max(self.now_s, standing.stamp_s), source=source)
        self._publish(kind, entry, checked(kind, key, entry.value)[1])
        self._watching.pop(key, None)
        if self.outgoing is not None:
            self._note_gone(entry)

    def endorse(
        self, key: str, *, who: str, verdict: Verdict, why: str, about: str = "", strength: Strength = "fair"
    ) -> Entry[Any]:
        """Say something for or against what stands at `key`: a revision with one endorsement more."""
        standing = self._standing.get(key)
        if standing is None:
            raise BoardError(f"{key}: nothing stands there to be endorsed")
        stamp = max(self.now_s, standing.stamp_s)
        if len(standing.endorsements) >= MAX_ENDORSEMENTS:
            standing = replace(standing, endorsements=without_oldest(standing.endorsements))
        said = Endorsement(who=who, verdict=verdict, why=why, stamp_s=stamp, about=about, strength=strength)
        entry = next_revision(standing, event="revised", stamp_s=stamp, source=standing.source, added=(said,))
        self._standing[key] = entry
        kind = self.vocabulary.parse_key(key)[1]
        self._publish(kind, entry, checked(kind, key, entry.value)[1])
        return entry

    # Other replicas

    def accept(self, entry: Entry[Any]) -> Entry[Any] | None:
        """Take in what another process posted; return what stands now, None where that was known already.

        Subscribers are called as for a post of this process. The value must have been checked against its kind.
        """
        entry_or_none = self._install(entry)
        if entry_or_none is not None:
            self._tell(self.vocabulary.parse_key(entry.key)[1], entry_or_none)
        return entry_or_none

    def load(self, entries: Iterable[Entry[Any]]) -> None:
        """Take in what stood before this process joined, retractions too. Nobody is told."""
        for entry in entries:
            installed = self._install(entry)
            if installed is not None:
                self.history.add(installed, member=installed.id is not None)

    def _install(self, come: Entry[Any]) -> Entry[Any] | None:
        key = come.key
        kind, member = self.vocabulary.parse_key(key)[1:]
        standing, gone = self._standing.get(key), self._gone.get(key)
        known = standing if standing is not None else gone
        entry = merged(known, come, life_of(retracted_s(gone), come))
        if come.event == "retracted":
            self._note_gone(merged(gone, come))
        if entry is known:
            return None
        if entry.event == "retracted":
            self._note_gone(entry)
            if standing is None:
                return None
            self._remove(kind, key, member)
            return entry
        if standing is None and kind.collection and member is not None:
            self._members.setdefault(kind.path, {})[member] = key
        self._standing[key] = entry
        self._owners[key] = entry.source
        if not kind.shared:
            self._owners[kind.path] = entry.source
        return entry

    def _note_gone(self, entry: Entry[Any]) -> None:
        self._gone[entry.key] = entry
        self._gone.move_to_end(entry.key)
        while len(self._gone) > MAX_GONE:
            self._gone.popitem(last=False)

    def _remove(self, kind: Kind[Any], key: str, id: str | None) -> None:
        del self._standing[key]
        self._owners.pop(key, None)
        if id is not None:
            del self._members[kind.path][id]
        self._keys.pop((kind.path, id), None)

    # Watching

    def subscribe(self, expression: str, watcher: Watcher) -> None:
        """Call `watcher` with every entry whose key matches the key expression, in order of subscription."""
        check_expression(expression)
        self._watchers.append((expression, watcher))
        self._watching.clear()

    def _publish(self, kind: Kind[Any], entry: Entry[Any], raw: bytes) -> None:
        self.posts += 1
        if self.journal is not None and kind.recorded:
            self.journal(entry, raw)
        if self.outgoing is not None:
            self.outgoing(kind, entry, raw)
        self._tell(kind, entry)

    def _tell(self, kind: Kind[Any], entry: Entry[Any]) -> None:
        self.history.add(entry, member=kind.collection)
        watchers = self._watching.get(entry.key)
        if watchers is None:
            watchers = tuple(watcher for expression, watcher in self._watchers if matches(expression, entry.key))
            self._watching[entry.key] = watchers
        for watcher in watchers:
            watcher(entry)

    def _claim(self, kind: Kind[Any], key: str, source: str) -> None:
        if not kind.shared:
            owner = self._owners.setdefault(kind.path, source)
            if owner != source:
                raise BoardError(f"'{kind.path}' belongs to {owner}; {source} may not post it")
        self._owners[key] = source
