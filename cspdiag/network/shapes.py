"""Shapes of process definitions: sizes are known, replicators unrolled, and names resolved.

Instances of a definition whose structure cannot differ (with equal values of the parameters that sizes, indexes and
periods depend on) share one shape, so the cost of checks depends on the length of the text, not on the number of
instances.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import TypeAlias

from cspdiag.base import Span
from cspdiag.base.record import EMPTY, Slotted, lazily, node, record
from cspdiag.model.program import PortSymbol, Value
from cspdiag.model.sampling import Sampling
from cspdiag.model.types import Type
from cspdiag.network.flow.build import flow_of
from cspdiag.network.flow.code import Code
from cspdiag.network.ir.actions import CoreAction
from cspdiag.network.ir.expressions import Expression
from cspdiag.network.ir.network import ChannelKind, Direction
from cspdiag.syntax import ast
from cspdiag.syntax.ast import KindName

Key: TypeAlias = str
"""The name of a port element (``request[3]``) or a channel of a shape; both are in one namespace."""

UNKNOWN_PERIOD = 0
UNKNOWN_SAMPLING = Sampling(UNKNOWN_PERIOD)
"""The sampling of a port or net whose period is not known: it was refused, or depends on a parameter without
a value.
"""

PortElement: TypeAlias = "tuple[str, int | None]"

Overrides: TypeAlias = Mapping[str, Value]
"""Values set from outside for parameters, by path below a shape: ``alignL.speed``."""


def element_name(name: str, *indexes: int | None) -> str:
    """The name of an element, such as ``cell[3][0]``; an index that is None is left out."""
    if len(indexes) == 1:
        return name if indexes[0] is None else f"{name}[{indexes[0]}]"
    return name + "".join(f"[{index}]" for index in indexes if index is not None)


@node
class PortShape:
    """A port with its size and sample instants known; ``size`` is None for a single port."""

    symbol: PortSymbol
    name: str
    direction: Direction
    type: Type
    size: int | None
    sampling: Sampling | None
    """None if the port has no period, UNKNOWN_SAMPLING if it is unknown."""

    @property
    def span(self) -> Span:
        """Where the port is declared."""
        return self.symbol.port.span

    @lazily
    def elements(self) -> Sequence[PortElement]:
        """The port, or each of its elements."""
        indexes = (None,) if self.size is None else range(self.size)
        return [(self.name, index) for index in indexes]


@record
class OwnPort(Slotted):
    """An attachment to a port of the enclosing process."""

    key: Key


@record
class OwnChannel(Slotted):
    """An attachment to a channel or variable of the enclosing process."""

    key: Key


@record
class Default:
    """An input left to its default value."""

    port: str


@record
class Discarded:
    """A port that is connected to ``_``."""


@record
class Unresolved:
    """An attachment with an error that was reported, or one that depends on a parameter without a value."""


AttachmentShape: TypeAlias = OwnPort | OwnChannel | Default | Discarded | Unresolved


@record
class Attached(Slotted):
    """What a port of an instance is attached to, and where in the text."""

    target: AttachmentShape
    span: Span


@node
class InstanceShape(Slotted):
    """An instance inside a process: its shape, its arguments and what its ports are attached to."""

    name: str
    array: str | None
    index: int | None
    declaration: ast.Instance
    shape: Shape
    replicators: Mapping[ast.Node, Value]
    """Values of the replicators around the declaration."""
    overrides: Overrides
    attachments: dict[PortElement, Attached]

    @property
    def span(self) -> Span:
        """Where the instance is declared."""
        return self.declaration.name.span


@record
class RequestedKind:
    """A kind that a relationship or a declaration requests, with the capacity of a FIFO."""

    name: KindName
    span: Span
    capacity: int | None


class ChannelShape:
    """A channel that a process owns: a declared channel, a variable, or the channel of a relationship.

    ``kind`` is inferred later; ``requested`` is the kind in the text. A variable whose declaration is a replicator
    counts the iterations of a loop.
    """

    __slots__ = (
        "capacity",
        "declaration",
        "excused",
        "initial",
        "iterations",
        "kind",
        "name",
        "replicators",
        "requested",
        "span",
        "type",
    )

    def __init__(
        self,
        name: str,
        declaration: ast.Variable | ast.Channel | ast.Connection | ast.Replicator,
        type_: Type,
        span: Span,
    ) -> None:
        self.name = name
        self.declaration = declaration
        self.type = type_
        self.span = span
        self.excused = False
        """Whether an error about the channel was reported, so no further ones are."""
        self.requested: RequestedKind | None = None
        self.kind: ChannelKind = "var"
        self.capacity: int | None = None
        self.initial: Expression | None = None
        self.replicators: Mapping[ast.Node, Value] = EMPTY
        """Values of the replicators around the declaration of a variable."""
        self.iterations: int | None = None
        """The number of iterations of a loop that a variable counts."""

    @property
    def is_variable(self) -> bool:
        """Whether it is a variable in the text: ``var``, a label at the end of an arrow, or the index of a loop."""
        declaration = self.declaration
        return isinstance(declaration, ast.Variable | ast.Replicator) or (
            isinstance(declaration, ast.Connection) and not declaration.sinks
        )


class Shape:
    """A definition in one shape; ``body`` is its composition, in which all reading ends are 0."""

    def __init__(
        self,
        definition: ast.ProcessDefinition | ast.SubmodelDefinition,
        values: dict[ast.Node, Value],
        overrides: Overrides,
    ) -> None:
        self.definition = definition
        self.is_submodel = isinstance(definition, ast.SubmodelDefinition)
        """Whether this is a single-shot control law."""
        self.is_external = definition.external is not None
        """Whether the body is in another language."""
        self.values = values
        self.overrides = overrides
        self.ports: dict[str, PortShape] = {}
        self.instances: dict[str, InstanceShape] = {}
        self.channels: dict[Key, ChannelShape] = {}
        self.requested: dict[Key, list[RequestedKind]] = {}
        """Kinds that relationships of this process request for its own ports."""
        self.port_spans: dict[Key, Span] = {}
        """The first relationship or communication that uses each port of this process."""
        self.body: CoreAction | None = None
        self.has_unknown_uses = False
        """Whether a relationship was refused, or a part of what it connects: what seems unused may have been meant."""
        self.incomplete = False
        """Whether parts were left out, because a parameter has no value or an error was reported."""

    @property
    def name(self) -> str:
        """The name of the definition."""
        return self.definition.name.text

    @cached_property
    def flow(self) -> Code[CoreAction]:
        """The instructions of the composition, which must exist and not change any more."""
        assert self.body is not None
        return flow_of(self.body)

    def port_or_channel_type(self, key: Key) -> Type:
        """The type of the values of a port or channel of this process."""
        channel = self.channels.get(key)
        return channel.type if channel is not None else self.ports[key.partition("[")[0]].type

    def port_elements(self) -> Sequence[tuple[PortShape, PortElement, Key]]:
        """Every port or element of an array of ports, with its key; the ports do not change any more."""
        return self._port_elements

    @cached_property
    def _port_elements(self) -> Sequence[tuple[PortShape, PortElement, Key]]:
        return [(port, element, element_name(*element)) for port in self.ports.values() for element in port.elements]

    @cached_property
    def element_keys(self) -> Mapping[PortElement, Key]:
        """The keys of ports and elements of arrays of ports."""
        return {element: key for _, element, key in self.port_elements()}

    @cached_property
    def defaults(self) -> Sequence[PortElement]:
        """The inputs that have a default."""
        return [element for port, element, _ in self.port_elements() if port.symbol.declaration.default is not None]


_OWN = (OwnPort, OwnChannel)


def attached_key(attached: Attached) -> Key | None:
    """The port or channel of the enclosing process that a port is attached to; None for a default or ``_``."""
    target = attached.target
    return target.key if isinstance(target, _OWN) else None
