"""The syntax tree: one frozen dataclass per construct of the language.

Nodes compare and hash by identity, so that later phases keep types and bindings in tables keyed by node. The tree stays as
parsed. ``same_tree`` compares two trees without regard to their places.
"""

from __future__ import annotations

from typing import Literal, TypeAlias

from cspdiag.diagnostics import SourceFile, Span
from cspdiag.diagnostics.record import field_names, is_record, node


@node
class Node:
    """Anything that was written somewhere."""

    span: Span


@node
class Identifier(Node):
    """A name where it is declared or used."""

    text: str


@node
class Number(Node):
    """``12``, ``0.5``, ``1e-3``, ``0.5<rad/s>``: an ``int`` unless written with a point, an exponent or a unit.

    ``unit`` is the text between the angle brackets.
    """

    value: int | float
    unit: str | None
    parenthesized: bool = False


@node
class Duration(Node):
    """``1 ms``: a ``time`` in integer nanoseconds. ``1 kHz``: a frequency in hertz.

    A frequency is a ``double<Hz>`` in expressions and means its period where a ``time`` is wanted (``@ 1 kHz``).
    """

    magnitude: float
    unit: Literal["ns", "us", "ms", "s", "min", "Hz", "kHz", "MHz"]
    nanoseconds: int
    """The duration, or the period of the frequency, rounded to whole nanoseconds."""
    parenthesized: bool = False

    @property
    def is_frequency(self) -> bool:
        """Whether this was written as a frequency."""
        return self.unit.endswith("Hz")


@node
class Boolean(Node):
    """``true`` or ``false``."""

    value: bool
    parenthesized: bool = False


@node
class Text(Node):
    """A string in double quotes; only arguments of drivers and external submodels take one."""

    value: str
    parenthesized: bool = False


@node
class Name(Node):
    """A name used as a value."""

    name: str
    parenthesized: bool = False


@node
class Member(Node):
    """``value.name``: a field of a struct, a literal of an enum, or a port of an instance."""

    value: Expression
    name: Identifier
    parenthesized: bool = False


@node
class Index(Node):
    """``value[index]``."""

    value: Expression
    index: Expression
    parenthesized: bool = False


@node
class Unary(Node):
    """``-x`` or ``not x``."""

    operator: Literal["-", "not"]
    operand: Expression
    parenthesized: bool = False


BinaryOperator: TypeAlias = Literal["+", "-", "*", "/", "%", "^", "==", "!=", "<", "<=", ">", ">=", "and", "or"]


@node
class Binary(Node):
    """An operator between two expressions."""

    operator: BinaryOperator
    left: Expression
    right: Expression
    parenthesized: bool = False


@node
class Conditional(Node):
    """``if condition then value else otherwise``."""

    condition: Expression
    then: Expression
    otherwise: Expression
    parenthesized: bool = False


@node
class Argument(Node):
    """A positional argument (``name`` is None) or a named one."""

    name: Identifier | None
    value: Expression


@node
class Call(Node):
    """``limit(x, -1, 1)``, ``Pose(x = 0, y = 1)``, ``int16(n)``."""

    function: Identifier
    arguments: tuple[Argument, ...]
    parenthesized: bool = False


@node
class ArrayValue(Node):
    """``[1, 2, 3]``."""

    elements: tuple[Expression, ...]
    parenthesized: bool = False


Expression: TypeAlias = (
    Number | Duration | Boolean | Text | Name | Member | Index | Unary | Binary | Conditional | Call | ArrayValue
)


@node
class Discard(Node):
    """``_``, the sink that takes everything."""


@node
class Replicator(Node):
    """``i < N``: ``i`` counts from 0."""

    name: Identifier
    count: Expression


@node
class Reference(Node):
    """A port, instance, variable or channel: ``feedback``, ``cell[i]``, ``servo.control``, ``cell[i].out[j]``."""

    name: Identifier
    indexes: tuple[Expression, ...] = ()
    member: Identifier | None = None
    member_indexes: tuple[Expression, ...] = ()


@node
class TypeName(Node):
    """``double<rad>[3]``: a name, the text of the unit, the sizes of the dimensions."""

    name: Identifier
    unit: str | None = None
    unit_span: Span | None = None
    dimensions: tuple[Expression, ...] = ()


@node
class Parameter(Node):
    """A compile-time constant that instances are given."""

    doc: str | None
    name: Identifier
    type: TypeName
    default: Expression | None


@node
class External(Node):
    """A body in another language: ``python "plant.py:Joint"``."""

    language: Identifier
    target: str
    target_span: Span


@node
class PortName(Node):
    """One name of a port declaration, with the sizes of an array of ports."""

    name: Identifier
    dimensions: tuple[Expression, ...] = ()


@node
class Ports(Node):
    """``in|out name, name : type [= default] [@ period [immediate]] [safe value]``."""

    doc: str | None
    direction: Literal["in", "out"]
    names: tuple[PortName, ...]
    type: TypeName
    default: Expression | None = None
    period: Expression | None = None
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
    """A kind of channel that was asked for, with the capacity of a FIFO."""

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


@node
class Step(Node):
    """A part of a composition; ``parenthesized`` as it was written."""

    parenthesized: bool = False


@node
class Run(Step):
    """The name of an instance: run it."""

    instance: Reference


@node
class Read(Step):
    """``port ? x``."""

    channel: Reference
    target: Reference


@node
class Write(Step):
    """``port ! e``."""

    channel: Reference
    value: Expression


@node
class Assign(Step):
    """``x := e``."""

    target: Reference
    value: Expression


@node
class Skip(Step):
    """Ends at once."""


@node
class Stop(Step):
    """Never ends."""


@node
class Wait(Step):
    """``wait 5 ms``."""

    duration: Expression


@node
class Reset(Step):
    """``reset name``: the states of a submodel instance go back to their initial values."""

    instance: Reference


@node
class Raise(Step):
    """``raise Name``."""

    exception: Identifier


@node
class Sequence(Step):
    """``P ; Q ; ...``, at least two."""

    processes: tuple[Composition, ...]


@node
class Parallel(Step):
    """``P || Q || ...`` or, prioritized, ``P ||> Q ||> ...``."""

    prioritized: bool
    processes: tuple[Composition, ...]


@node
class Alternative(Step):
    """``P [] Q [] ...`` or, prioritized, ``P []> Q []> ...``; every branch is a guarded process or a replicated alternative."""

    prioritized: bool
    branches: tuple[Composition, ...]


@node
class ReadyGuard(Node):
    """``port -> P``: ready when the port is; the guarded process begins by reading it."""

    channel: Reference


@node
class InputGuard(Node):
    """``port ? x -> P``: reads."""

    channel: Reference
    target: Reference


@node
class OutputGuard(Node):
    """``port ! e -> P``: writes."""

    channel: Reference
    value: Expression


@node
class AfterGuard(Node):
    """``after 5 ms -> P``: a time-out."""

    duration: Expression


@node
class SkipGuard(Node):
    """``skip -> P``: always ready."""


Event: TypeAlias = ReadyGuard | InputGuard | OutputGuard | AfterGuard | SkipGuard


@node
class Guard(Node):
    """``[when condition &] event``."""

    condition: Expression | None
    event: Event


@node
class Guarded(Step):
    """``guard -> P``."""

    guard: Guard
    process: Composition


@node
class Mu(Step):
    """``mu P until e`` or ``mu P``."""

    process: Composition
    until: Expression | None


@node
class While(Step):
    """``while e do P``."""

    condition: Expression
    process: Composition


@node
class If(Step):
    """``if e then P else Q``."""

    condition: Expression
    then: Composition
    otherwise: Composition | None


@node
class Catch(Step):
    """``P catch Timeout -> Q``."""

    process: Composition
    exception: Identifier
    handler: Composition


@node
class Interrupt(Step):
    """``P interrupt g -> Q``."""

    process: Composition
    guard: Guard
    handler: Composition


ReplicatedOperator: TypeAlias = Literal["seq", "par", "pripar", "alt", "prialt"]


@node
class Replicated(Step):
    """``par i < N : P``."""

    operator: ReplicatedOperator
    replicator: Replicator
    process: Composition


@node
class Labelled(Step):
    """``label: P``."""

    label: Identifier
    process: Composition


Composition: TypeAlias = (
    Run
    | Read
    | Write
    | Assign
    | Skip
    | Stop
    | Wait
    | Reset
    | Raise
    | Sequence
    | Parallel
    | Alternative
    | Guarded
    | Mu
    | While
    | If
    | Catch
    | Interrupt
    | Replicated
    | Labelled
)


@node
class Import(Node):
    """``import "laws.csp"`` or ``import std.control`` (then ``library`` is ``std.control``)."""

    path: str | None
    library: str | None


@node
class Constant(Node):
    """``const Tsh = 1 ms``."""

    doc: str | None
    name: Identifier
    type: TypeName | None
    value: Expression


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
    """A control law or a piece of plant: equations, or an external body."""

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
class EnvironmentDefinition(Node):
    """``environment Bench for Jiwy(arguments) step 1 ms on miss count { ... }``."""

    doc: str | None
    name: Identifier
    process: Identifier
    arguments: tuple[Argument, ...]
    step: Expression | None
    on_miss: Identifier | None
    declarations: tuple[Declaration, ...]


@node
class Assertion(Node):
    """``assert P deadlock free`` and its kin; ``specification`` and ``model`` belong to ``refines``."""

    doc: str | None
    process: Identifier
    property: Literal["deadlock free", "livelock free", "terminates", "schedulable", "refines"]
    specification: Identifier | None = None
    model: Literal["traces", "failures"] = "traces"


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
class Comment:
    """A comment that is not a doc comment, with its markers."""

    span: Span
    text: str


@node
class SourceTree(Node):
    """A parsed file."""

    source: SourceFile
    items: tuple[Item, ...]
    comments: tuple[Comment, ...]


def same_tree(left: object, right: object) -> bool:
    """Whether two trees are equal but for the places of their nodes and their comments."""
    pending: list[tuple[object, object]] = [(left, right)]
    while pending:
        a, b = pending.pop()
        if type(a) is not type(b):
            return False
        if isinstance(a, tuple) and isinstance(b, tuple):
            if len(a) != len(b):
                return False
            pending += zip(a, b, strict=True)
        elif is_record(a):
            for name in field_names(a):
                if name not in {"span", "unit_span", "target_span", "composition_span", "source", "comments"}:
                    pending.append((getattr(a, name), getattr(b, name)))
        elif a != b:
            return False
    return True
