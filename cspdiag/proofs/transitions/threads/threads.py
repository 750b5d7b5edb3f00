"""All threads of a program, explored until nothing new is found out about the values on channels.

Threads that are alike, as the elements of an array of instances are, share a template.
"""

from __future__ import annotations

from collections import defaultdict, deque
from collections.abc import Hashable
from typing import TypeAlias

from cspdiag.base import Span
from cspdiag.network.ir.actions import Group, RunInstance
from cspdiag.network.ir.network import ProcessClass
from cspdiag.network.ir.walk import instances_run
from cspdiag.proofs.transitions.classes.program import Node
from cspdiag.proofs.transitions.occurrences import CHANNELS, MediumFacts, Occurrence, World
from cspdiag.proofs.transitions.systems.references import ParallelId, Reference
from cspdiag.proofs.transitions.systems.template import Template
from cspdiag.proofs.transitions.threads.explore import explore
from cspdiag.proofs.transitions.threads.thread import Role, resolve
from cspdiag.proofs.transitions.values import UNKNOWN

ParallelKey: TypeAlias = tuple[Occurrence, Node]
"""A parallel composition of an instance."""


class Strand:
    """A thread at its place in the program: the instance that it belongs to, its parent, and its template."""

    def __init__(
        self, occurrence: Occurrence, node: Node | None, name: str, parent: Strand | None, branch: int
    ) -> None:
        self.occurrence = occurrence
        self.node = node
        self.name = name
        self.parent = parent
        self.branch = branch
        self.cancellable = False
        self.caught = False
        self.once = True
        self.parallel: ParallelKey | None = None
        self.template = Template()
        self.number = -1
        self.span: Span | None = None
        """The text of a branch that has no name but its number."""

    @property
    def role(self) -> Role:
        """What the thread is to others."""
        return Role(outermost=self.parent is None, cancellable=self.cancellable, caught=self.caught, once=self.once)


class Strands:
    """The threads of a program."""

    def __init__(self, world: World) -> None:
        self.world = world
        self.branches: dict[ParallelKey, list[Strand]] = {}
        self._cache: dict[Hashable, list[Template]] = defaultdict(list)
        self._asking: defaultdict[MediumFacts, set[Strand]] = defaultdict(set)
        self._pending: deque[Strand] = deque()
        self._waiting: set[Strand] = set()
        self._names: dict[str, int] = {world.top.path: 1}
        top = world.top
        self.top = Strand(top, top.definition.body, top.path, None, 0)
        self._again(self.top)
        while self._pending or self._read_in_vain():
            strand = self._pending.popleft()
            self._waiting.discard(strand)
            self._follow(strand)

    def _read_in_vain(self) -> bool:
        """Gives an unknown value to channels that are read and never written, so their readers have a label to wait
        with. Returns whether there are new ones.
        """
        for medium in [medium for medium in self._asking if medium.kind in CHANNELS and medium.values == set()]:
            medium.admit({UNKNOWN})
            self._news(medium)
        return bool(self._pending)

    def all(self) -> list[Strand]:
        """The threads that can run, each one before its branches."""
        found = [self.top]
        for strand in found:
            for key in strand.template.parallels:
                found += self.branches[parallel_key(strand.occurrence, key)]
        unique = list(dict.fromkeys(found))
        for number, strand in enumerate(unique):
            strand.number = number
        return unique

    def _again(self, strand: Strand) -> None:
        if strand not in self._waiting:
            self._waiting.add(strand)
            self._pending.append(strand)

    def _follow(self, strand: Strand) -> None:
        template = strand.template = self._template(strand)
        for reference in template.asked:
            self._asking[resolve(strand.occurrence, reference)].add(strand)
        for reference in template.touched:
            medium = resolve(strand.occurrence, reference)
            medium.accessed_by.add(strand)
            if len(medium.accessed_by) > 1 and not medium.shared:
                medium.shared = True
                medium.admit({medium.initial})
                self._news(medium)
        for reference, values in template.written.items():
            medium = resolve(strand.occurrence, reference)
            if medium.admit(values):
                self._news(medium)
        for key, parallel in template.parallels.items():
            for branch in self._branches(strand, key):
                once = branch.once and strand is branch.parent and strand.once and not template.repeats(key)
                cancellable = branch.cancellable or parallel.cancellable
                caught = branch.caught or parallel.caught
                if (once, cancellable, caught) != (branch.once, branch.cancellable, branch.caught):
                    branch.once, branch.cancellable, branch.caught = once, cancellable, caught
                    self._again(branch)

    def _news(self, medium: MediumFacts) -> None:
        for strand in sorted(self._asking[medium], key=lambda strand: strand.name):
            self._again(strand)

    def _branches(self, strand: Strand, key: ParallelId) -> list[Strand]:
        absolute = parallel_key(strand.occurrence, key)
        known = self.branches.get(absolute)
        if known is None:
            known = self.branches[absolute] = []
            occurrence, node = absolute
            for number, child in enumerate(node.children):
                branch = _branch(occurrence, child, strand, number)
                branch.parallel = absolute
                self._name(branch)
                known.append(branch)
                self._again(branch)
        return known

    def _name(self, strand: Strand) -> None:
        """Makes the name of a thread unique: a branch of another parallel may have it already."""
        uses = self._names[strand.name] = self._names.get(strand.name, 0) + 1
        if uses > 1:
            strand.name = f"{strand.name} ({uses})"

    def _template(self, strand: Strand) -> Template:
        occurrence = strand.occurrence
        known = self._cache[self._kind(strand)]
        for template in known:
            if all(_answer(occurrence, reference) == answer for reference, answer in template.asked.items()):
                return template
        template = explore(occurrence, strand.node, strand.role)
        known.append(template)
        return template

    def _kind(self, strand: Strand) -> Hashable:
        """What a template depends on besides the media that it asks for."""
        occurrence = strand.occurrence
        definition = occurrence.definition
        first: dict[MediumFacts, int] = {}
        ports = []
        for position, medium in enumerate(occurrence.ports.values()):
            initial = repr(medium.initial) if medium.relevant or medium.kind == "constant" else None
            alias = first.setdefault(medium, position)
            ports.append((medium.kind, medium.relevant, medium.cells, alias, medium.sampling, initial))
        parameters = self.world.facts.parameters(definition)
        values = tuple(repr(occurrence.arguments.get(name)) for name in parameters)
        return definition.name, strand.node, strand.role, values, tuple(ports)


def _answer(occurrence: Occurrence, reference: Reference) -> object:
    medium = resolve(occurrence, reference)
    return medium.domain, medium.shared


def parallel_key(occurrence: Occurrence, key: ParallelId) -> ParallelKey:
    """The parallel that a thread of ``occurrence`` knows as ``key``."""
    path, node = key
    return occurrence.at(path), node


def _branch(occurrence: Occurrence, node: Node, parent: Strand, number: int) -> Strand:
    """The thread of a branch; if the branch only runs a process, it is the thread of that process."""
    label = None
    while isinstance(node.action, Group):
        label = label or node.action.label
        (node,) = node.children
    if isinstance(node.action, RunInstance):
        name = node.action.instance
        definition = occurrence.definition.instances[name]
        if isinstance(occurrence.world.program.classes[definition.class_name].definition, ProcessClass):
            child = occurrence.child(name)
            return Strand(child, child.definition.body, child.path, parent, number)
        return Strand(occurrence, node, f"{occurrence.path}.{name}", parent, number)
    run = set(instances_run(node.action))
    name = label or (run.pop() if len(run) == 1 else "")
    branch = Strand(occurrence, node, f"{occurrence.path}.{name or number + 1}", parent, number)
    if not name:
        branch.span = node.span
    return branch
