"""Ports and the communication diagram."""

from __future__ import annotations

from typing import Literal, TypeAlias

from cspdiag.base.record import node
from cspdiag.syntax.ast.expressions import (
    Argument,
    Discard,
    Expression,
    Identifier,
    Node,
    Reference,
    Replicator,
    TypeName,
)


@node
class PortName(Node):
    """One name of a port declaration, with the sizes of an array of ports."""

    name: Identifier
    dimensions: tuple[Expression, ...] = ()


@node
class Sampling(Node):
    """``T [offset d]`` after the ``@`` of a port."""

    period: Expression
    offset: Expression | None = None


@node
class Ports(Node):
    """``in|out name, name : type [= default] [@ sampling [immediate]] [safe value]``."""

    doc: str | None
    direction: Literal["in", "out"]
    names: tuple[PortName, ...]
    type: TypeName
    default: Expression | None = None
    sampling: Sampling | None = None
    immediate: bool = False
    safe: Expression | None = None


@node
class Instance(Node):
    """``name : Definition(arguments)``, ``cell[8] : Cell`` or ``cell[i < 8] : Cell(id = i)``."""

    doc: str | None
    name: Identifier
    size: Expression | Replicator | None
    definition: Identifier
    arguments: tuple[Argument, ...]


@node
class Variable(Node):
    """``var name : type [= initial]``."""

    doc: str | None
    name: Identifier
    type: TypeName
    initial: Expression | None


KindName: TypeAlias = Literal["sync", "broadcast", "any", "buffer", "overwrite"]


@node
class Kind(Node):
    """A requested kind of channel, with the capacity of a FIFO."""

    name: KindName
    capacity: Expression | None = None


@node
class Channel(Node):
    """``channel name : type [kind]``."""

    doc: str | None
    name: Identifier
    type: TypeName
    kind: Kind | None


@node
class Connection(Node):
    """``source, ... -> [label] [: type] [kind] -> sink, ...``.

    An arrow that ends in a label (``velocity.stop -> stop : bool``) has no sinks.
    """

    doc: str | None
    sources: tuple[Reference, ...]
    label: Identifier | None
    type: TypeName | None
    kind: Kind | None
    sinks: tuple[Reference | Discard, ...]


@node
class RepeatedDeclarations(Node):
    """``for i < N { ... }`` in a communication block or an environment."""

    replicator: Replicator
    declarations: tuple[Declaration, ...]


Declaration: TypeAlias = Instance | Variable | Channel | Connection | RepeatedDeclarations


@node
class Communication(Node):
    """The block ``communication { ... }``."""

    declarations: tuple[Declaration, ...]
