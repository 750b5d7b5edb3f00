"""Instances at their paths, and the channels and ports that they share, made when they are first used."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property
from typing import Literal, TypeAlias, assert_never

from cspdiag.base import Span
from cspdiag.base.record import replaced
from cspdiag.model.sampling import Sampling
from cspdiag.model.types import Type
from cspdiag.network.ir.actions import ChannelEnd, PortEnd
from cspdiag.network.ir.expressions import Expression
from cspdiag.network.ir.network import Attachment, ConstantEnd, DiscardEnd, ProcessClass
from cspdiag.proofs.transitions.classes.distinguished import Distinction
from cspdiag.proofs.transitions.classes.facts import Facts
from cspdiag.proofs.transitions.classes.items import Item
from cspdiag.proofs.transitions.classes.program import Class, Program
from cspdiag.proofs.transitions.ranges import Cell, Range, cell_of, cells, limits_of, pieces, with_examples
from cspdiag.proofs.transitions.values import (
    ANY,
    COPIES,
    MOST_VALUES,
    UNKNOWN,
    EvaluationFault,
    Known,
    evaluated,
    values_of_type,
)

MediumKind: TypeAlias = Literal[
    "var", "sync", "broadcast", "any", "buffer", "overwrite", "sampled", "event", "output", "constant", "discard"
]
"""Kinds of channels; of inputs (``sampled``, ``event``) and outputs of the outermost process; and of ports that are
connected to a constant or to nothing.
"""

CHANNELS: frozenset[MediumKind] = frozenset({"sync", "broadcast", "any", "buffer", "overwrite"})
"""Kinds of channels between processes, except variables."""
BLOCKING: frozenset[MediumKind] = CHANNELS | {"sampled", "event"}
"""Kinds at which a reader may have to wait."""


class MediumFacts:
    """A channel, or whatever else a port is attached to, with what is found out about it while processes are explored.

    ``values`` are those that may be written, None if there are too many; they are collected for ``relevant`` media
    only. If there are too many numbers, the medium becomes ``coarse``: only their ``cells``, if it has any, are
    distinguished. A variable is ``shared`` if more than one component accesses it.
    """

    def __init__(
        self,
        name: str,
        kind: MediumKind,
        type_: Type | None,
        *,
        relevant: bool = False,
        boundaries: Iterable[int] = (),
        span: Span | None = None,
        given: tuple[Known, ...] = (),
    ) -> None:
        self.name = name
        self.span = span
        self.kind: MediumKind = kind
        self.type = type_
        self.relevant = relevant
        self.cells: tuple[Cell, ...] = cells(type_, boundaries) if relevant else ()
        self.given: tuple[Known, ...] = given or (UNKNOWN,)
        """What the environment may give, as far as it is distinguished."""
        self.coarse = False
        self.sampling: Sampling | None = None
        self.is_contended = kind == "any"
        """Whether several processes may compete for the same communication."""
        self.capacity = 1
        self.iterations = 0
        """The number of iterations of a loop that a variable counts."""
        self.ends = 1
        self.initial: Known = UNKNOWN
        self.values: set[Known] | None = set()
        self.shared = False
        self._growths = 0
        self.accessed_by: set[object] = set()

    def admit(self, values: set[Known]) -> bool:
        """Adds values that are written here; returns whether any of them is new."""
        if self.coarse:
            values = set(map(self.coarsened, values))
        if self.values is None or values <= self.values:
            return False
        self.values |= values
        self._growths += 1
        if not self.coarse and (len(self.values) > MOST_VALUES or self._growths > _MOST_GROWTHS):
            self.coarse = bool(self.cells)
            self.values = set(map(self.coarsened, self.values)) if self.cells else None
        return True

    def coarsened(self, value: Known) -> Known:
        """The cell of a number; UNKNOWN for what is in none."""
        found = cell_of(value, self.cells) if isinstance(value, int | Range) else None
        return UNKNOWN if found is None else found

    def distinguished(self, value: Known) -> Known:
        """A value as far as it is distinguished from others here."""
        return self.coarsened(value) if self.coarse else value

    def pieces(self, value: Known) -> tuple[Known, ...]:
        """A value, or the parts of a range that are distinguished here."""
        if not isinstance(value, Range):
            return (value,)
        parts = pieces(value, self.cells)
        if value.copied and len(parts) < 2:
            return (value,)
        return parts or (UNKNOWN,)

    @property
    def domain(self) -> tuple[Known, ...] | None:
        """The values in a stable order, None if they are not distinguished."""
        if self.values is None or not self.relevant:
            return None
        return tuple(sorted(self.values, key=lambda value: (value is UNKNOWN, str(type(value)), value)))


_MOST_GROWTHS = 8
"""A medium to which values are added more often than this is in a cycle that keeps counting."""

DISCARD = MediumFacts("_", "discard", None)


class Occurrence:
    """An instance of a process at its path, or the outermost process."""

    def __init__(
        self,
        world: World,
        path: str,
        definition: Class,
        arguments: dict[str, Known] | None,
        ports: dict[tuple[str, int | None], MediumFacts],
        parent: Occurrence | None = None,
        name: str = "",
    ) -> None:
        self.world = world
        self.path = path
        self.definition = definition
        self.ports = ports
        self.parent = parent
        self.name = name
        self._arguments = arguments
        self._children: dict[str, Occurrence] = {}
        self._channels: dict[str, MediumFacts] = {}

    @cached_property
    def arguments(self) -> dict[str, Known]:
        """The values of the parameters."""
        if self._arguments is not None:
            return self._arguments
        assert self.parent is not None
        given = self.parent.definition.instances[self.name].arguments
        return {name: self.parent.constant(value) for name, value in given}

    def constant(self, expression: Expression) -> Known:
        """The value of an expression of parameters."""
        try:
            return evaluated(expression, lambda _: UNKNOWN, lambda name: self.arguments.get(name, UNKNOWN))
        except EvaluationFault:
            return UNKNOWN

    def child(self, name: str) -> Occurrence:
        """The instance with this name inside this one."""
        known = self._children.get(name)
        if known is None:
            instance = self.definition.instances[name]
            ports = {(c.port, c.index): self.attached(c.attachment) for c in instance.connections}
            definition = self.world.program.classes[instance.class_name]
            known = Occurrence(self.world, f"{self.path}.{name}", definition, None, ports, self, name)
            self._children[name] = known
        return known

    def attached(self, end: Attachment) -> MediumFacts:
        """The medium that an end, in terms of this class, is attached to."""
        match end:
            case PortEnd():
                return self.ports[end.port, end.index]
            case ChannelEnd():
                return self.channel(end.channel)
            case ConstantEnd():
                medium = MediumFacts("", "constant", end.value.type)
                medium.initial = self.constant(end.value)
                return medium
            case DiscardEnd():
                return DISCARD
            case _:
                assert_never(end)

    def channel(self, name: str) -> MediumFacts:
        """A channel of this instance."""
        known = self._channels.get(name)
        if known is None:
            definition = self.definition.definition
            assert isinstance(definition, ProcessClass)
            channel = definition.channels[self.definition.channels[name]]
            item: Item = ("channel", self.definition.name, name)
            known = self._channels[name] = MediumFacts(
                f"{self.path}.{name}",
                channel.kind,
                channel.type,
                relevant=item in self.world.facts.relevant,
                boundaries=self.world.facts.boundaries.get(item, ()),
                span=channel.span,
            )
            known.capacity = channel.capacity or 1
            known.iterations = channel.iterations or 0
            known.ends = channel.ends
            if channel.initial is not None:
                known.initial = self.constant(channel.initial)
        return known

    def at(self, path: tuple[str, ...]) -> Occurrence:
        """The instance at a path below this one."""
        found = self
        for name in path:
            found = found.child(name)
        return found


class World:
    """The outermost process and all instances inside it."""

    def __init__(self, program: Program, facts: Facts) -> None:
        self.program = program
        self.facts = facts
        network = program.network
        media: dict[tuple[str, int | None], MediumFacts] = {}
        self.inputs: dict[str, Distinction] = {}
        """How the values of inputs that matter are distinguished."""
        for port in network.external_ports:
            base = port.name.split("[", 1)[0]
            index = port.index
            kind: MediumKind = "output" if port.direction == "out" else "event" if port.sampling is None else "sampled"
            item: Item = ("port", network.top, base)
            distinction = facts.distinction(port.name)
            name, relevant = f"{network.top}.{port.name}", item in facts.relevant
            given: tuple[Known, ...] = ()
            if port.direction == "in" and relevant:
                self.inputs[port.name] = distinction
                given = _given(port.type, distinction, free=facts.is_free(port.name))
            medium = MediumFacts(
                name, kind, port.type, relevant=relevant, boundaries=distinction.cuts, span=port.span, given=given
            )
            medium.sampling = port.sampling
            medium.is_contended = port.kind == "any"
            media[base, index] = medium
        arguments: dict[str, Known] = dict(network.arguments)
        self.top = Occurrence(self, network.top, program.top, arguments, media)


def _given(kind: Type, distinction: Distinction, *, free: bool) -> tuple[Known, ...]:
    """The values that the environment may give at an input whose values matter, or a specification at a ``free`` one:
    as far as they are distinguished.
    """
    few = values_of_type(kind)
    if few is not None:
        return few
    if distinction.values:
        return distinction.values
    among = cells(kind, distinction.cuts)
    if not distinction.copied:
        return among
    if free:
        return among or (ANY,)
    if limits_of(kind) is None:
        return COPIES
    every = with_examples(among, kind)
    ranges = (replaced(entry, copied=True) for entry in every if isinstance(entry, Range))
    return (*(entry for entry in every if not isinstance(entry, Range)), *ranges)
