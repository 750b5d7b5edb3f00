"""A thread of control while it is explored: its configurations and variables, and the media that its names refer to."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple, TypeAlias, assert_never

from cspdiag.base import Span
from cspdiag.network.ir.actions import End
from cspdiag.network.ir.expressions import Expression
from cspdiag.network.ir.network import SubmodelClass
from cspdiag.proofs.transitions.classes.program import Node
from cspdiag.proofs.transitions.occurrences import MediumFacts, Occurrence
from cspdiag.proofs.transitions.systems.references import (
    Constant,
    Discard,
    InnerChannel,
    OwnPort,
    Path,
    ReadingEnd,
    Reference,
)
from cspdiag.proofs.transitions.systems.system import Abstraction
from cspdiag.proofs.transitions.systems.template import Template
from cspdiag.proofs.transitions.threads.context import Context
from cspdiag.proofs.transitions.threads.frames import Risk, Stack
from cspdiag.proofs.transitions.values import MOST_VALUES, UNKNOWN, Known, evaluated, same


class Configuration(NamedTuple):
    """A state of a thread: what it has to do, the next frame first; the values of its variables; whether it was
    cancelled and only continues to its next communication (``doomed``); what a ready guard has read already (medium,
    value, guard); and the values of shared variables that were loaded for the next step.
    """

    stack: Stack
    variables: tuple[Known, ...] = ()
    doomed: bool = False
    fetched: tuple[Reference, Known, Node] | None = None
    loaded: tuple[tuple[Reference | Risk, Known], ...] = ()

    def at(self, stack: Stack) -> Configuration:
        """The configuration with another stack: like ``_replace``, in half the time."""
        return Configuration(stack, self.variables, self.doomed, self.fetched, self.loaded)


class Role(NamedTuple):
    """What a thread is to others: whether it is the outermost process rather than a branch; whether it may be
    cancelled; whether its faults are caught by the process that started it; whether it runs at most ``once``.
    """

    outermost: bool
    cancellable: bool
    caught: bool
    once: bool


class Session(NamedTuple):
    """Whether a session has begun at an end of a sampled input."""

    end: ReadingEnd


Slot: TypeAlias = Reference | Session
"""What a configuration keeps a value of: a local variable, or whether a session has begun."""


class NeedsLoad(Exception):  # noqa: N818 - a step that is to be taken first
    """A shared variable has to be loaded before the step."""

    def __init__(self, what: Reference | Risk) -> None:
        self.what = what


class Restart(Exception):  # noqa: N818
    """The thread has to be explored again, with what was found out."""


class Thread:
    """A branch of a parallel, or the outermost process, while it is explored.

    Earlier rounds have found the ``widened`` variables, of which only ranges are followed, the ``dropped`` ones, which
    are not followed, and the ``unfused`` guards, which are taken before anything is read.
    """

    def __init__(self, occurrence: Occurrence, node: Node | None, role: Role) -> None:
        self.node = node
        self.role = role
        self.facts = occurrence.world.facts
        self.widened: set[Reference] = set()
        self.dropped: set[Reference] = set()
        self.unfused: set[Node] = set()
        self.template = Template()
        self._media: dict[Reference, MediumFacts] = {}
        first: dict[int, Reference] = {}
        ports: dict[tuple[str, int | None], Reference] = {}
        for (name, index), medium in occurrence.ports.items():
            if medium.kind == "constant":
                ports[name, index] = Constant(medium.initial)
            elif medium.kind == "discard":
                ports[name, index] = Discard()
            else:
                ports[name, index] = first.setdefault(id(medium), OwnPort(name, index))
        self.root = Context((), occurrence, ports)
        self._contexts: dict[Path, Context] = {(): self.root}
        self._slots: dict[Slot, int] = {}
        self._initial: list[Known] = []
        self._values: list[set[Known]] = []
        self._sessions: dict[Path, list[Session]] = {}

    def context(self, outer: Context, name: str) -> Context:
        """The context of an instance inside another context."""
        path = (*outer.path, name)
        known = self._contexts.get(path)
        if known is None:
            instance = outer.definition.instances[name]
            ports = {(c.port, c.index): outer.reference(c.attachment) for c in instance.connections}
            known = self._contexts[path] = Context(path, outer.occurrence.child(name), ports)
        return known

    def law(self, outer: Context, name: str) -> SubmodelClass | None:
        """The class of an instance if it is a submodel."""
        definition = self.facts.program.classes[outer.definition.instances[name].class_name].definition
        return definition if isinstance(definition, SubmodelClass) else None

    def medium(self, reference: Reference) -> MediumFacts:
        """The medium that a reference refers to; each ``Constant`` and ``Discard`` has a medium of its own."""
        known = self._media.get(reference)
        if known is None:
            known = self._media[reference] = self._medium(reference)
        return known

    def _medium(self, reference: Reference) -> MediumFacts:
        match reference:
            case OwnPort() | InnerChannel():
                return resolve(self.root.occurrence, reference)
            case Constant():
                medium = MediumFacts("_", "constant", None)
                medium.initial = reference.value
                return medium
            case Discard():
                return MediumFacts("_", "discard", None)
            case _:
                assert_never(reference)

    def domain(self, reference: Reference) -> tuple[Known, ...] | None:
        """The values that may be read from a medium; None if they are not followed."""
        self._note_dependency(reference)
        return self.medium(reference).domain

    def is_shared(self, reference: Reference) -> bool:
        """Whether a relevant variable is accessed by other threads too."""
        self.template.accessed_variables.add(reference)
        self._note_dependency(reference)
        return self.medium(reference).shared

    def _note_dependency(self, reference: Reference) -> None:
        if reference not in self.template.dependencies:
            medium = self.medium(reference)
            self.template.dependencies[reference] = (medium.domain, medium.shared)

    def wrote(self, reference: Reference, value: Known) -> None:
        """Notes a value that is written to a relevant medium."""
        if self.medium(reference).relevant:
            self.template.written.setdefault(reference, set()).add(value)

    def value_of(self, configuration: Configuration, reference: Reference) -> Known:
        """The present value of a variable. Raises NeedsLoad for one that is shared."""
        if isinstance(reference, Constant):
            return reference.value
        if not self.medium(reference).relevant or isinstance(reference, Discard):
            return UNKNOWN
        if self.is_shared(reference):
            for loaded, value in configuration.loaded:
                if loaded == reference:
                    return value
            raise NeedsLoad(reference)
        return self.slot_value(configuration, reference)

    def evaluate(self, configuration: Configuration, context: Context, expression: Expression) -> Known:
        """The value of an expression. Raises NeedsLoad and EvaluationFault."""
        occurrence = context.occurrence
        return evaluated(
            expression,
            lambda name: self.value_of(configuration, context.channel(name)),
            lambda name: self._parameter(occurrence, name),
        )

    def _parameter(self, occurrence: Occurrence, name: str) -> Known:
        """The value of a parameter if conditions depend on it: instances that differ in other parameters only share a
        template.
        """
        relevant = ("parameter", occurrence.definition.name, name) in self.facts.relevant
        return occurrence.arguments.get(name, UNKNOWN) if relevant else UNKNOWN

    def slot_value(self, configuration: Configuration, key: Slot) -> Known:
        """The value of a local variable, or whether a session has begun."""
        slot = self._slot(key)
        return configuration.variables[slot] if slot < len(configuration.variables) else self._initial[slot]

    def with_slot(self, configuration: Configuration, key: Slot, value: Known) -> Configuration:
        """The configuration with another value in a slot. Trailing initial values are left out, so equal configurations
        compare equal.
        """
        value = self._followed(key, value)
        slot = self._slot(key)
        present = configuration.variables
        if slot < len(present):
            if same(present[slot], value):
                return configuration
            changed = [*present[:slot], value, *present[slot + 1 :]]
        else:
            if same(self._initial[slot], value):
                return configuration
            changed = [*present, *self._initial[len(present) : slot], value]
        while changed and same(changed[-1], self._initial[len(changed) - 1]):
            changed.pop()
        return configuration._replace(variables=tuple(changed))

    def _slot(self, key: Slot) -> int:
        slot = self._slots.get(key)
        if slot is None:
            slot = self._slots[key] = len(self._initial)
            initial = False if isinstance(key, Session) else self.medium(key).initial
            self._initial.append(self._followed(key, initial))
            self._values.append(set())
            if isinstance(key, Session):
                self._sessions.setdefault(key.end.path, []).append(key)
        return slot

    def _followed(self, key: Slot, value: Known) -> Known:
        """A value of a variable as far as it is followed."""
        if isinstance(key, Session):
            return value
        if key in self.dropped:
            return UNKNOWN
        return self.medium(key).coarsened(value) if key in self.widened else value

    def pieces(self, reference: Reference, value: Known) -> tuple[Known, ...]:
        """The value, or the parts of a range that are distinguished in a medium: which of them it is, is left open."""
        medium = self.medium(reference)
        parts = medium.pieces(value)
        if len(parts) > 1 and reference not in self.widened:
            name = medium.name.rsplit(".", 1)[-1]
            self.abstracted(f"`{name}` may be in any of several ranges", medium.span)
        return parts

    def _widen(self, key: Reference) -> None:
        """Lets the next round follow a variable less closely."""
        less = self.dropped if key in self.widened or not self.medium(key).cells else self.widened
        less.add(key)

    def count(self, configuration: Configuration) -> None:
        """Notes the values in a new state. If a variable has more values than are distinguished it is followed less
        closely, and Restart is raised; a variable that counts iterations may have as many values as there are
        iterations, since the position in the loop determines its value anyway.
        """
        for slot, value in enumerate(configuration.variables):
            values = self._values[slot]
            values.add(value)
            if len(values) > MOST_VALUES:
                ((key, _),) = (entry for entry in self._slots.items() if entry[1] == slot)
                assert not isinstance(key, Session)
                if len(values) > self.medium(key).iterations + 1:
                    self._widen(key)
                    raise Restart

    def give_up(self, configurations: Iterable[Configuration]) -> bool:
        """Lets the next round follow the variable with most values less closely; returns whether any has several."""
        found: dict[int, set[Known]] = {}
        for configuration in configurations:
            for slot, value in enumerate(configuration.variables):
                found.setdefault(slot, set()).add(value)
        most: int = 1
        best: Reference | None = None
        for key, slot in self._slots.items():
            values = found.get(slot, set()) | {self._initial[slot]}
            if len(values) > most and not isinstance(key, Session) and key not in self.dropped:
                most, best = len(values), key
        if best is None:
            return False
        self._widen(best)
        return True

    def begun(self, configuration: Configuration, context: Context, end: ReadingEnd) -> bool:
        """Whether a sample may have been missed at an end, because its process has read there before; True if that is
        not known.
        """
        if not self._follows_sessions(context):
            return True
        return bool(self.slot_value(configuration, Session(end)))

    def beginning(self, configuration: Configuration, context: Context, end: ReadingEnd) -> Configuration:
        """The configuration after a read at an end: its session has begun."""
        if not self._follows_sessions(context):
            return configuration
        return self.with_slot(configuration, Session(end), True)

    def closed(self, configuration: Configuration, context: Context) -> Configuration:
        """The configuration after the end of a process: the sessions of its ends are over."""
        for key in self._sessions.get(context.path, ()):
            configuration = self.with_slot(configuration, key, False)
        return configuration

    def _follows_sessions(self, context: Context) -> bool:
        whole = context is not self.root or self.node is context.definition.body
        return whole and not context.definition.has_parallel

    def abstracted(self, what: str, span: Span | None) -> None:
        """Notes something that is left open."""
        self.template.abstractions[Abstraction(what, span)] = None


def resolve(occurrence: Occurrence, reference: Reference) -> MediumFacts:
    """The medium of a reference of a thread whose own instance is ``occurrence``."""
    match reference:
        case OwnPort():
            return occurrence.ports[reference.name, reference.element]
        case InnerChannel():
            return occurrence.at(reference.path).channel(reference.name)
        case Constant() | Discard():
            raise AssertionError("only the thread itself accesses it")
        case _:
            assert_never(reference)


def reading_end(context: Context, end: End) -> ReadingEnd:
    """The identity of an end at which a process reads."""
    return ReadingEnd(context.path, end)
