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


class ThreadInstance:
    """A thread at its place in the program: the instance that it belongs to, its parent, and its template."""

    def __init__(
        self, occurrence: Occurrence, node: Node | None, name: str, parent: ThreadInstance | None, branch: int
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


class ThreadTree:
    """The threads of a program."""

    def __init__(self, world: World) -> None:
        self.world = world
        self.branches: dict[ParallelKey, list[ThreadInstance]] = {}
        self._cache: dict[Hashable, list[Template]] = defaultdict(list)
        self._dependents: defaultdict[MediumFacts, set[ThreadInstance]] = defaultdict(set)
        self._pending: deque[ThreadInstance] = deque()
        self._waiting: set[ThreadInstance] = set()
        self._names: dict[str, int] = {world.top.path: 1}
        top = world.top
        self.top = ThreadInstance(top, top.definition.body, top.path, None, 0)
        self._enqueue(self.top)
        while self._pending or self._admit_values_never_written():
            thread = self._pending.popleft()
            self._waiting.discard(thread)
            self._follow(thread)

    def _admit_values_never_written(self) -> bool:
        """Gives an unknown value to channels that are read and never written, so their readers have a label to wait
        with. Returns whether there are new ones.
        """
        for medium in [medium for medium in self._dependents if medium.kind in CHANNELS and medium.values == set()]:
            medium.admit({UNKNOWN})
            self._follow_dependents_again(medium)
        return bool(self._pending)

    def all(self) -> list[ThreadInstance]:
        """The threads that can run, each one before its branches."""
        found = [self.top]
        for thread in found:
            for key in thread.template.parallels:
                found += self.branches[parallel_key(thread.occurrence, key)]
        unique = list(dict.fromkeys(found))
        for number, thread in enumerate(unique):
            thread.number = number
        return unique

    def _enqueue(self, thread: ThreadInstance) -> None:
        if thread not in self._waiting:
            self._waiting.add(thread)
            self._pending.append(thread)

    def _follow(self, thread: ThreadInstance) -> None:
        template = thread.template = self._template(thread)
        for reference in template.dependencies:
            self._dependents[resolve(thread.occurrence, reference)].add(thread)
        for reference in template.accessed_variables:
            medium = resolve(thread.occurrence, reference)
            medium.accessed_by.add(thread)
            if len(medium.accessed_by) > 1 and not medium.shared:
                medium.shared = True
                medium.admit({medium.initial})
                self._follow_dependents_again(medium)
        for reference, values in template.written.items():
            medium = resolve(thread.occurrence, reference)
            if medium.admit(values):
                self._follow_dependents_again(medium)
        for key, parallel in template.parallels.items():
            for branch in self._branches(thread, key):
                once = branch.once and thread is branch.parent and thread.once and not template.repeats(key)
                cancellable = branch.cancellable or parallel.cancellable
                caught = branch.caught or parallel.caught
                if (once, cancellable, caught) != (branch.once, branch.cancellable, branch.caught):
                    branch.once, branch.cancellable, branch.caught = once, cancellable, caught
                    self._enqueue(branch)

    def _follow_dependents_again(self, medium: MediumFacts) -> None:
        for thread in sorted(self._dependents[medium], key=lambda thread: thread.name):
            self._enqueue(thread)

    def _branches(self, thread: ThreadInstance, key: ParallelId) -> list[ThreadInstance]:
        absolute = parallel_key(thread.occurrence, key)
        known = self.branches.get(absolute)
        if known is None:
            known = self.branches[absolute] = []
            occurrence, node = absolute
            for number, child in enumerate(node.children):
                branch = _branch(occurrence, child, thread, number)
                branch.parallel = absolute
                self._name(branch)
                known.append(branch)
                self._enqueue(branch)
        return known

    def _name(self, thread: ThreadInstance) -> None:
        """Makes the name of a thread unique: a branch of another parallel may have it already."""
        uses = self._names[thread.name] = self._names.get(thread.name, 0) + 1
        if uses > 1:
            thread.name = f"{thread.name} ({uses})"

    def _template(self, thread: ThreadInstance) -> Template:
        occurrence = thread.occurrence
        known = self._cache[self._kind(thread)]
        for template in known:
            if all(_answer(occurrence, reference) == answer for reference, answer in template.dependencies.items()):
                return template
        template = explore(occurrence, thread.node, thread.role)
        known.append(template)
        return template

    def _kind(self, thread: ThreadInstance) -> Hashable:
        """What a template depends on besides the media that it asks for."""
        occurrence = thread.occurrence
        definition = occurrence.definition
        first: dict[MediumFacts, int] = {}
        ports = []
        for position, medium in enumerate(occurrence.ports.values()):
            initial = repr(medium.initial) if medium.relevant or medium.kind == "constant" else None
            alias = first.setdefault(medium, position)
            ports.append((medium.kind, medium.relevant, medium.cells, alias, medium.sampling, initial))
        parameters = self.world.facts.parameters(definition)
        values = tuple(repr(occurrence.arguments.get(name)) for name in parameters)
        return definition.name, thread.node, thread.role, values, tuple(ports)


def _answer(occurrence: Occurrence, reference: Reference) -> object:
    medium = resolve(occurrence, reference)
    return medium.domain, medium.shared


def parallel_key(occurrence: Occurrence, key: ParallelId) -> ParallelKey:
    """The parallel that a thread of ``occurrence`` knows as ``key``."""
    path, node = key
    return occurrence.at(path), node


def _branch(occurrence: Occurrence, node: Node, parent: ThreadInstance, number: int) -> ThreadInstance:
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
            return ThreadInstance(child, child.definition.body, child.path, parent, number)
        return ThreadInstance(occurrence, node, f"{occurrence.path}.{name}", parent, number)
    run = set(instances_run(node.action))
    name = label or (run.pop() if len(run) == 1 else "")
    branch = ThreadInstance(occurrence, node, f"{occurrence.path}.{name or number + 1}", parent, number)
    if not name:
        branch.span = node.span
    return branch
