"""The network representation: small, closed, explicit.

A program is a set of classes and a tree of instances. A class is a definition in one shape: two instances of a
definition share a class if they differ only in the values of constants; if array sizes or the structure below differ
they have different classes. Kinds of channels, sample periods, priorities and reading ends are decided, replicators are
unrolled (except those in a ``CountedLoop``), and defaults are filled in. Names are those of the text; an element of an
array is called ``cell[3]``.

All backends, analyses and pictures are made from this representation alone.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Generic, Literal, TypeAlias

from cspdiag.base import Span
from cspdiag.base.record import Slotted, node, record
from cspdiag.model.sampling import Sampling
from cspdiag.model.types import EnumType, StructType, Type
from cspdiag.network.ir.actions import A_co, ChannelEnd, CoreAction, End
from cspdiag.network.ir.declared import Declared, DeclaredElement
from cspdiag.network.ir.equations import ExternalBody, ExternalCall, LinearBlock, SubmodelEquation
from cspdiag.network.ir.expressions import Expression, Value

ChannelKind: TypeAlias = Literal["var", "sync", "broadcast", "any", "buffer", "overwrite"]
Direction: TypeAlias = Literal["in", "out"]
MediumKind: TypeAlias = Literal[
    "var", "sync", "broadcast", "any", "buffer", "overwrite",
    "sampled", "event", "latched", "direct", "constant", "discard",
]  # fmt: skip


@record(kw_only=True)
class ClassParameter(Declared):
    """A constant that each instance provides.

    ``derived`` parameters are added by the compiler: the sample period (name ``sample``, type double, in seconds),
    coefficients of discretized operators, and constants passed on to instances inside. A ``tunable`` one refers to a
    parameter of the program: its argument is a ``TunableValue``, and is passed by reference.
    """

    type: Type
    derived: bool = False
    tunable: bool = False


@record(kw_only=True)
class NamedConstant(Declared):
    """A ``const`` of the text."""

    type: Type
    value: Value


@record(kw_only=True)
class ProgramParameter(Declared):
    """A ``parameter`` of the text, or a ``const`` that follows from some.

    ``value`` is the one before any change. ``follows`` computes that of a ``const`` from the parameters before it. A
    ``fixed`` one is a ``const``, or a parameter of an instance, that may be set before a run and not during it.
    """

    type: Type
    value: Value
    follows: Expression | None = None
    fixed: bool = False


@record
class Medium:
    """What a port is connected to, once classes are specialized by it.

    ``kind`` is that of the channel; for ports of the outermost process ``sampled`` or ``event`` (inputs), ``latched``
    (a sampled output) or ``direct`` (an event output, or an immediate one); otherwise ``constant`` or ``discard``.
    ``guarded_reads`` and ``guarded_writes`` say whether any alternative or interrupt has a guard on that side of the
    channel, anywhere.
    """

    kind: MediumKind
    guarded_reads: bool = False
    guarded_writes: bool = False


@record(kw_only=True)
class Port(Declared):
    """A port of a class; ``size`` is the length of an array of ports; ``period`` is for documentation, with the span of
    the whole declaration of the sample instants.

    ``media`` has the medium of the port, or of each element of the array, once the class is specialized.
    """

    direction: Direction
    type: Type
    size: int | None = None
    period: Expression | None = None
    media: tuple[Medium, ...] = ()


@record(kw_only=True)
class LocalChannel(DeclaredElement):
    """A channel that a process class owns; a variable of the text is one of kind ``var``.

    ``initial`` belongs to ``var``, and so does ``iterations``, the number of iterations of a loop that the compiler
    counts in it; ``capacity`` to ``buffer`` and ``overwrite``, ``ends`` (the number of reading ends) to ``broadcast``.
    ``guarded_reads`` and ``guarded_writes`` are as in ``Medium``, and known once classes are specialized.
    """

    type: Type
    kind: ChannelKind
    initial: Expression | None = None
    capacity: int | None = None
    iterations: int | None = None
    ends: int = 1
    guarded_reads: bool = False
    guarded_writes: bool = False


@record
class ConstantEnd:
    """An unconnected input with a default: reading it returns this value at once."""

    value: Expression


@record
class DiscardEnd:
    """The end of a port that is connected to ``_``, which takes every value at once."""


Attachment: TypeAlias = End | ConstantEnd | DiscardEnd


@record(kw_only=True)
class Connection(Slotted):
    """What a port of an instance is attached to, in terms of the enclosing class."""

    port: str
    index: int | None
    attachment: Attachment


@record(kw_only=True)
class InstanceOf(DeclaredElement):
    """An instance inside a process class.

    ``array`` and ``index`` are set for elements of an array of instances: ``cell[3]`` has array ``cell`` and index 3.
    ``arguments`` are expressions over the parameters of the enclosing class, in the order of the class's parameters.
    """

    class_name: str
    array: str | None = None
    index: int | None = None
    arguments: tuple[tuple[str, Expression], ...] = ()
    connections: tuple[Connection, ...] = ()


def channels_of(instances: Iterable[InstanceOf]) -> frozenset[str]:
    """The channels of the enclosing class, including variables, that ports of instances are attached to."""
    ends = (connection.attachment for instance in instances for connection in instance.connections)
    return frozenset(end.channel for end in ends if isinstance(end, ChannelEnd))


@record(kw_only=True)
class SubmodelState(Declared):
    """A state of a control law; ``continuous`` ones have a derivative, the others a next value.

    ``change`` is where that is given, if it is not given with the state.
    """

    type: Type
    initial: Expression
    continuous: bool
    change: Span | None = None


@record
class CreatedInstance(Slotted):
    """An instance, in the order of creation."""

    instance: str


@record
class CreatedChoice:
    """An alternative, in the order of creation."""

    choice: str


@record(kw_only=True)
class ProcessClass(Declared, Generic[A_co]):
    """A process: ports, what it owns, and its composition. With ``external`` it owns nothing and ``body`` is None.

    The passes of ``network.optimize`` fill in ``constants`` (of parameters only, evaluated once in order) and
    ``states``, those of control laws that were inlined, and ``creation``: reading ends, instances and the names of
    alternatives in the order in which they are created without those passes, which decides which is served first if
    several wait for one event.
    """

    definition: str
    parameters: tuple[ClassParameter, ...] = ()
    ports: tuple[Port, ...] = ()
    channels: tuple[LocalChannel, ...] = ()
    instances: tuple[InstanceOf, ...] = ()
    body: A_co | None = None
    external: ExternalBody | None = None
    wcet: int | None = None
    constants: tuple[SubmodelEquation, ...] = ()
    states: tuple[SubmodelState, ...] = ()
    creation: tuple[End | CreatedInstance | CreatedChoice, ...] = ()


@record(kw_only=True)
class SubmodelClass(Declared):
    """A control law, flattened and sorted.

    One run: the ``equations`` are evaluated in order from the inputs and the present states; the outputs are then
    known; next, every discrete state takes its ``next`` value at once, and the continuous ones are integrated over the
    sample with the inputs held: ``derivatives`` are evaluated after ``derivative_equations`` (the part of the equations
    that they need). ``constants`` depend on parameters only and are evaluated once, in order. ``linear`` are the states
    of an environment that move by a matrix instead, whose derivatives need not be evaluated.
    """

    definition: str
    parameters: tuple[ClassParameter, ...] = ()
    ports: tuple[Port, ...] = ()
    constants: tuple[SubmodelEquation, ...] = ()
    states: tuple[SubmodelState, ...] = ()
    equations: tuple[SubmodelEquation | ExternalCall, ...] = ()
    next_values: tuple[tuple[str, Expression], ...] = ()
    derivative_equations: tuple[SubmodelEquation, ...] = ()
    derivatives: tuple[tuple[str, Expression], ...] = ()
    linear: tuple[LinearBlock, ...] = ()
    method: Literal["rk4", "euler"] = "rk4"
    step: int | None = None
    """The longest sub-step of the integration in nanoseconds; None for the whole sample."""
    external: ExternalBody | None = None
    wcet: int | None = None
    decisive: tuple[str, ...] = ()
    """The constants of an environment whose values decide what else is here: sizes, steps, coefficients."""


@record(kw_only=True)
class ExternalPort(Declared):
    """A port of the outermost process, with values; ``sampling`` is None for an event port."""

    direction: Direction
    type: Type
    index: int | None = None
    sampling: Sampling | None = None
    immediate: bool = False
    safe: Value | None = None
    default: Value | None = None
    kind: ChannelKind = "sync"
    """``broadcast`` or ``any`` for an event input that several processes read."""

    @property
    def key(self) -> str:
        """The name of the port with its index, as drivers use it."""
        return self.name if self.index is None or self.name.endswith("]") else f"{self.name}[{self.index}]"

    @property
    def medium(self) -> Literal["event", "sampled", "direct", "latched"]:
        """The kind of medium behind the port."""
        if self.direction == "in":
            return "event" if self.sampling is None else "sampled"
        return "direct" if self.sampling is None or self.immediate else "latched"


@record(kw_only=True)
class DriverInstance(Declared):
    """A driver in an environment; ``connections`` are (driver port, external port of the program).

    ``outputs`` and ``inputs`` are the ports that its definition declares.
    """

    definition: str
    external: ExternalBody
    arguments: tuple[tuple[str, Value], ...]
    argument_types: tuple[Type, ...]
    connections: tuple[tuple[str, str], ...]
    outputs: tuple[str, ...]
    inputs: tuple[str, ...]


@record(kw_only=True)
class Environment(Declared):
    """An environment: the plant and the operator as one flattened system, and the drivers.

    ``system`` has the program's outputs as inputs and its inputs as outputs, under the names of the program's ports; it
    has no parameters. ``step`` is the grid in nanoseconds on which it is evaluated besides the ticks.
    """

    system: SubmodelClass | None
    drivers: tuple[DriverInstance, ...]
    step: int
    on_miss: Literal["timeout", "count"] = "timeout"
    places: tuple[tuple[str, tuple[str, ...]], ...] = ()
    """Hosts that run a part of the program each: the name, and the instances of the outermost process that run there,
    arrays of instances by their name alone.
    """


@record(kw_only=True)
class Instantiation(Slotted):
    """An instance by its path from the outermost process (``Jiwy.horizontal.alignL``), with the values of its
    parameters.
    """

    path: str
    class_name: str
    arguments: tuple[tuple[str, Value], ...]


@record(kw_only=True)
class Net(Slotted):
    """A channel with all its users: the paths of the leaf processes (``Jiwy.horizontal.alignL.velocity``) and their
    ports.

    ``path`` is the channel's hierarchical name, or the external port's.
    """

    path: str
    kind: ChannelKind
    type: Type
    external: Direction | None
    sampling: Sampling | None
    writers: tuple[tuple[str, str], ...]
    readers: tuple[tuple[str, str], ...]
    span: Span


@node
class FewerElements:
    """Says of a network that its arrays have fewer elements than those of the program, and what else is known of it:
    the network of all elements follows from the two once both are optimized.
    """

    network: CoreNetwork
    """The same with even fewer."""
    sizes: tuple[int, int, int]
    """The size of the arrays in that one, in this one, and in the program."""
    whole: Callable[[], CoreNetwork | None]
    """Makes the network of all elements from the program, which has one."""


@node
class Continued:
    """Says of a network from which two others it follows, and so does what is found in it (``fewer.continued``)."""

    few: Network
    some: Network
    """The same with more elements."""
    sizes: tuple[int, int, int]
    """The size of the arrays in the first, in the second, and in the network itself."""


@record(kw_only=True)
class Network(Generic[A_co]):
    """A whole program. In ``classes`` each class comes after the classes of its instances."""

    name: str
    source: str
    top: str
    """Class name of the outermost process, which is also the first part of every path."""
    arguments: tuple[tuple[str, Value], ...]
    constants: tuple[NamedConstant, ...]
    parameters: tuple[ProgramParameter, ...] = ()
    """In an order in which each follows from those before it."""
    tunable: tuple[tuple[str, str], ...] = ()
    """The tunable parameters of the outermost process, each with the parameter of the program that it refers to."""
    enums: tuple[EnumType, ...]
    structs: tuple[StructType, ...]
    exceptions: tuple[str, ...]
    classes: tuple[ProcessClass[A_co] | SubmodelClass, ...]
    external_ports: tuple[ExternalPort, ...]
    environments: tuple[Environment, ...]
    instances: tuple[Instantiation, ...]
    nets: tuple[Net, ...]
    doc: str | None = None
    fewer: FewerElements | None = None
    continued: Continued | None = None
    """How the network was made, if it was made from two with fewer elements."""

    def class_named(self, name: str) -> ProcessClass[A_co] | SubmodelClass:
        """The class with this name. Raises KeyError if it is unknown."""
        for entry in self.classes:
            if entry.name == name:
                return entry
        raise KeyError(name)


CoreClass: TypeAlias = "ProcessClass[CoreAction]"
CoreNetwork: TypeAlias = "Network[CoreAction]"
"""A network that the passes of ``cspdiag.optimize`` have not changed."""
