"""The network of a program: its rules' conditions, compiled; rules that begin alike share their nodes."""

from collections.abc import Callable, Mapping, Sequence

from rules.engines.matching.disjuncts import Group, Part
from rules.engines.matching.expressions import Check, Compiler, Scope, evaluation, guarded, truth
from rules.engines.matching.facts import WorkingFact
from rules.engines.matching.memories import Facts, Index, Memory
from rules.engines.matching.nodes import (
    FilterNode,
    GroupEnd,
    GroupNode,
    JoinNode,
    OneFactNode,
    RootMemory,
    RuleEnd,
    remove,
)
from rules.engines.matching.patterns import Templates, described, matching
from rules.engines.matching.places import Place, TokenPlace, identities
from rules.engines.matching.relations import Relations
from rules.language.evaluation import Compiled
from rules.language.syntax import Expression, Match, Test
from rules.language.values import Value

Bound = dict[str, TokenPlace]


class Network:
    """Matches facts against rows of conditions."""

    def __init__(
        self,
        templates: Templates,
        compiled: Callable[[Expression], Compiled],
        globals_: Mapping[str, Value],
    ) -> None:
        self.templates = templates
        self.compiler = Compiler(compiled, globals_)
        self.root = RootMemory()
        self.relations = Relations(self.compiler.note)
        self.shared: dict[object, Memory] = {}
        self.memories: list[Memory] = [self.root]

    def add_row(self, row: Sequence[Part], end: Callable[[Bound], RuleEnd]) -> None:
        """Add a row of conditions; `end` makes what takes its matches, from where each variable is bound."""
        memory, bound, _ = self._row(self.root, row, {}, 0)
        memory.successors.insert(0, end(bound))

    def clear(self) -> None:
        """Forget all facts."""
        for memory in self.memories:
            memory.clear()
        for alpha in self.relations.memories.values():
            alpha.clear()

    def start(self) -> None:
        """Begin with no facts: what needs none matches now."""
        self.root.start()

    def put(self, fact: WorkingFact) -> None:
        """Add a fact."""
        self.relations.put(fact)

    def remove(self, fact: WorkingFact) -> None:
        """Take a fact out."""
        remove(fact)

    def _row(self, memory: Memory, row: Sequence[Part], bound: Bound, level: int) -> tuple[Memory, Bound, int]:
        at = 0
        while at < len(row):
            part = row[at]
            at += 1
            if isinstance(part, Match):
                tests = _tests(row[at:])
                at += len(tests)
                memory, bound = self._join(memory, part, tests, bound, level)
                level += 1
            elif isinstance(part, Test):
                memory = self._filter(memory, [part], bound, wanted=True)
            else:
                memory = self._group(memory, part, bound, level, _tests(row[at:]))
        return memory, bound, level

    def _join(
        self, memory: Memory, match: Match, tests: Sequence[Test], bound: Bound, level: int
    ) -> tuple[Memory, Bound]:
        made = matching(match.pattern, bound, self.templates, self.compiler)
        scope: Scope = {**bound, **made.binds}
        checks, specs = self._checks(tests, _with_address(scope, match), made.tests, made.test_specs)
        spec = (id(memory), "join", id(self.relations.memory(made)), tuple(made.keys), specs)
        node = self.shared.get(spec)
        if node is None:
            alpha = self.relations.memory(made)
            left = memory.index(tuple(there for _, there in made.keys))
            node = self._new(
                spec,
                JoinNode(
                    left, alpha.index(tuple(here for here, _ in made.keys)), guarded(checks, False, self.compiler.note)
                ),
            )
            assert isinstance(node, JoinNode)
            memory.successors.insert(0, node)
            alpha.joins.insert(0, node)
        after = {**bound, **{name: TokenPlace(level, place) for name, place in made.binds.items()}}
        if match.binding is not None:
            after[match.binding] = TokenPlace(level, Place(None))
        return node, after

    def _one_fact(
        self, memory: Memory, match: Match, tests: Sequence[Test], bound: Bound, wanted: bool, after: Sequence[Test]
    ) -> Memory:
        """Return the node of `not` or `exists` over one pattern; as in CLIPS, it is not shared with one that no test follows."""
        made = matching(match.pattern, bound, self.templates, self.compiler)
        checks, specs = self._checks(tests, {**bound, **made.binds}, made.tests, made.test_specs)
        followed = self._checks(after, bound, [], [])[1]
        alpha = self.relations.memory(made)
        spec = (id(memory), "one fact", wanted, id(alpha), tuple(made.keys), specs, followed)
        node = self.shared.get(spec)
        if node is None:
            resting = Index(identities(tuple(there for _, there in made.keys)))
            right = alpha.index(tuple(here for here, _ in made.keys))
            node = self._new(spec, OneFactNode(resting, right, guarded(checks, not wanted, self.compiler.note), wanted))
            assert isinstance(node, OneFactNode)
            memory.successors.insert(0, node)
            alpha.joins.insert(0, node)
        return node

    def _checks(
        self, tests: Sequence[Test], scope: Scope, before: list[Check], specs: list[object]
    ) -> tuple[tuple[Check, ...], tuple[object, ...]]:
        """Return the tests of a join together with those of the `test` conditions that follow it."""
        more = [truth(evaluation(test.expression, scope, self.compiler), negated=False) for test in tests]
        return (*before, *more), (*specs, *(("test", described(test.expression, scope)) for test in tests))

    def _filter(self, memory: Memory, tests: Sequence[Test], bound: Bound, wanted: bool) -> Memory:
        checks, specs = self._checks(tests, bound, [], [])
        spec = (id(memory), "filter", wanted, specs)
        if spec in self.shared:
            return self.shared[spec]

        def check(facts: Facts, fact: None) -> bool:
            return all(one(facts, fact) for one in checks) is wanted

        node = FilterNode(guarded([check], False, self.compiler.note))
        memory.successors.insert(0, node)
        return self._new(spec, node)

    def _group(self, memory: Memory, group: Group, bound: Bound, level: int, after: Sequence[Test]) -> Memory:
        if len(group.branches) == 1:
            first, *rest = group.branches[0]
            tests = _tests(rest)
            if isinstance(first, Test) and len(tests) == len(rest):
                return self._filter(memory, [first, *tests], bound, group.wanted)
            if isinstance(first, Match) and len(tests) == len(rest):
                return self._one_fact(memory, first, tests, bound, group.wanted, after)
        node = GroupNode(group.wanted)
        memory.successors.insert(0, node)
        self.memories += [node, node.passed]
        for branch in group.branches:
            end, _, _ = self._row(node, branch, bound, level)
            end.successors.append(GroupEnd(node))
        return node.passed

    def _new(self, spec: object, node: Memory) -> Memory:
        self.shared[spec] = node
        self.memories.append(node)
        return node


def _tests(row: Sequence[Part]) -> list[Test]:
    """Return the tests that a row begins with."""
    found: list[Test] = []
    for part in row:
        if not isinstance(part, Test):
            break
        found.append(part)
    return found


def _with_address(scope: Scope, match: Match) -> Scope:
    return scope if match.binding is None else {**scope, match.binding: Place(None)}
