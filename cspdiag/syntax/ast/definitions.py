"""Definitions, equations of submodels, and a whole file."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import zip_longest
from typing import Literal, TypeAlias

from cspdiag.base import SourceFile, Span
from cspdiag.base.record import Slotted, field_names, is_record, node
from cspdiag.syntax.ast.communication import Communication, Declaration, Instance, Ports
from cspdiag.syntax.ast.composition import Composition
from cspdiag.syntax.ast.expressions import (
    Argument,
    Expression,
    External,
    Identifier,
    Node,
    Parameter,
    Reference,
    TypeName,
)


@node
class Import(Node):
    """``import "laws.csp"`` or ``import std.control`` (then ``library`` is ``std.control``)."""

    path: str | None
    library: str | None


@node
class Constant(Node):
    """``const Tsh = 1 ms``, or ``parameter kp = 2.6``, which is ``tunable``: it may change while the program runs."""

    doc: str | None
    name: Identifier
    type: TypeName | None
    value: Expression
    tunable: bool = False


@node
class TypeAliasDefinition(Node):
    """``type Angle = double<rad>``."""

    doc: str | None
    name: Identifier
    type: TypeName


@node
class EnumDefinition(Node):
    """``enum Mode { idle, run }``."""

    doc: str | None
    name: Identifier
    literals: tuple[Identifier, ...]


@node
class Field(Node):
    """A field of a struct."""

    doc: str | None
    name: Identifier
    type: TypeName


@node
class StructDefinition(Node):
    """``struct Pose { x: double<m>  y: double<m> }``."""

    doc: str | None
    name: Identifier
    fields: tuple[Field, ...]


@node
class ExceptionDefinition(Node):
    """``exception Overheated``."""

    doc: str | None
    name: Identifier


@node
class ProcessDefinition(Node):
    """A process with its two diagrams, or with an external body."""

    doc: str | None
    name: Identifier
    parameters: tuple[Parameter, ...]
    external: External | None
    wcet: Expression | None
    ports: tuple[Ports, ...]
    communication: Communication | None
    composition: Composition | None
    composition_span: Span | None


@node
class Let(Node):
    """``let name = e`` in a submodel."""

    doc: str | None
    name: Identifier
    value: Expression


@node
class State(Node):
    """``state name : type = initial``."""

    doc: str | None
    name: Identifier
    type: TypeName
    initial: Expression


@node
class Next(Node):
    """``next name = e``: the value of a discrete state at the next sample."""

    name: Identifier
    value: Expression


@node
class Derivative(Node):
    """``der name = e``: the derivative of a continuous state."""

    name: Identifier
    value: Expression


@node
class Equation(Node):
    """``output = e`` or ``instance.input = e``."""

    target: Reference
    value: Expression


SubmodelItem: TypeAlias = Let | State | Next | Derivative | Equation | Instance


@node
class SubmodelDefinition(Node):
    """A control law or a part of a plant: equations, or an external body."""

    doc: str | None
    name: Identifier
    parameters: tuple[Parameter, ...]
    external: External | None
    wcet: Expression | None
    step: Expression | None
    method: Identifier | None
    ports: tuple[Ports, ...]
    items: tuple[SubmodelItem, ...]


@node
class DriverDefinition(Node):
    """A device."""

    doc: str | None
    name: Identifier
    parameters: tuple[Parameter, ...]
    external: External | None
    ports: tuple[Ports, ...]


@node
class Place(Node):
    """``place pan : horizontal``: the instances of the outermost process that run on one host."""

    name: Identifier
    instances: tuple[Identifier, ...]


@node
class EnvironmentDefinition(Node):
    """``environment Bench for Jiwy(arguments) step 1 ms on miss count { ... }``; each of its ``places`` is a clause
    ``place pan : horizontal``.
    """

    doc: str | None
    name: Identifier
    process: Identifier
    arguments: tuple[Argument, ...]
    step: Expression | None
    on_miss: Identifier | None
    places: tuple[Place, ...]
    declarations: tuple[Declaration, ...]


@node
class Assertion(Node):
    """``assert P deadlock free`` and the other assertions; ``specification``, ``model`` and ``hidden`` (ports of the
    process) belong to ``refines``.
    """

    doc: str | None
    process: Identifier
    property: Literal["deadlock free", "livelock free", "terminates", "schedulable", "refines"]
    specification: Identifier | None = None
    model: Literal["traces", "failures"] = "traces"
    hidden: tuple[Identifier, ...] = ()


Definition: TypeAlias = (
    Constant
    | TypeAliasDefinition
    | EnumDefinition
    | StructDefinition
    | ExceptionDefinition
    | ProcessDefinition
    | SubmodelDefinition
    | DriverDefinition
    | EnvironmentDefinition
)
Item: TypeAlias = Import | Definition | Assertion


@node
class Comment(Slotted):
    """A comment that is not a doc comment, with its markers."""

    span: Span
    text: str


@node
class SourceTree(Node):
    """A parsed file."""

    source: SourceFile
    items: tuple[Item, ...]
    comments: tuple[Comment, ...]


_OUTSIDE = frozenset({"source", "comments"})
_END = object()


def same_tree(left: object, right: object) -> bool:
    """Whether two trees are equal, apart from the places of their nodes and comments."""
    pairs = zip_longest(_content(left, _OUTSIDE), _content(right, _OUTSIDE), fillvalue=_END)
    return all(type(one) is type(other) and one == other for one, other in pairs)


def meaning_of(tree: SourceTree) -> tuple[object, ...]:
    """What a file says, as names of nodes and plain values: equal for files that differ in nothing but layout, comments
    and documentation.
    """
    return tuple(_content(tree, _OUTSIDE | {"doc"}))


def _content(tree: object, left_out: frozenset[str]) -> Iterator[object]:
    """The kinds of the nodes, the lengths of the tuples and the other values of a tree, parents first, without places
    and the fields ``left_out``.
    """
    pending = [tree]
    while pending:
        item = pending.pop()
        if isinstance(item, Span):
            continue
        if isinstance(item, tuple):
            yield len(item)
            pending.extend(reversed(item))
        elif is_record(item):
            yield type(item).__name__
            pending.extend([getattr(item, name) for name in reversed(field_names(item)) if name not in left_out])
        else:
            yield item
