"""The names of the parts of one optimized process: attributes of ``self``, and the local variables bound to them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field

from cspdiag.codegen.python.fast.storage import local_variables
from cspdiag.codegen.python.plain.members import Members, Row
from cspdiag.codegen.python.text.code import SELF, Attribute, Code, Element, Name, own
from cspdiag.model.types import Type
from cspdiag.network.flow.dedicated import dedicated_places, place_of
from cspdiag.network.ir.actions import ChannelEnd, End, PortEnd, ProcessScope, ReadInputs, RunLaw, WriteOutputs
from cspdiag.network.ir.network import Medium, Network, ProcessClass
from cspdiag.network.ir.walk import all_actions

_HELPERS = (
    "me",
    "writer",
    "reader",
    "value",
    "channel",
    "ready",
    "ready_guards",
    "mask",
    "first",
    "waiting",
    "error",
    "group",
    "guard",
    "k",
    "scheduler",
    "queue",
    "observe",
)

MEDIA_WITHOUT_COMMUNICATION = frozenset({"var", "constant", "discard"})
"""Media whose accesses are not communications."""


@dataclass
class Spelling:
    """The names in one process class. ``bound`` collects the attributes that its code uses, each bound to a local
    variable of the same name.
    """

    process: ProcessClass
    network: Network
    runs_again: bool
    """Whether the process may run more than once."""
    probed: bool = False
    """Whether variables with a unit are recorded."""
    bound: dict[str, None] = field(default_factory=dict)
    run: set[str] = field(default_factory=set)
    """Which of ``scheduler``, ``queue`` and ``observe`` of the run the code uses."""

    kept: set[str] = field(default_factory=set)
    """Local variables that keep their values from one run of a law to the next, besides its states."""

    def __post_init__(self) -> None:
        self.members = Members(self.process, self.network)
        names = self.names = self.members.names
        self._locals = local_variables(self.process, self.runs_again, self.probed)
        self._media = {port.name: port.media for port in self.process.ports}
        self._channels = {channel.name: channel for channel in self.process.channels}
        self._dedicated = dedicated_places(self.network)
        self.helpers = {name: names.fresh(name) for name in _HELPERS}
        self.parts: dict[str, str] = {}
        """Attributes of inlined processes and of laws, by instance."""
        self.scopes: list[ProcessScope] = []
        self.laws: dict[str, ReadInputs | RunLaw | WriteOutputs] = {}
        for part in all_actions(self.process.body):
            if isinstance(part, ProcessScope) and part.instance not in self.parts:
                self.scopes.append(part)
                self.parts[part.instance] = names.fresh(f"{part.instance}_process")
            elif isinstance(part, ReadInputs | RunLaw | WriteOutputs) and part.law:
                if part.law not in self.laws or isinstance(self.laws[part.law], RunLaw):
                    self.laws[part.law] = part
                if part.law not in self.parts:
                    self.parts[part.law] = names.fresh(f"{part.law}_law")
        self.signals: dict[str, str] = {}
        self.constants = {item.name for item in self.process.constants}
        self.states = {item.name for item in self.process.states}
        self._variables = {name: self._local_name(name) for name in sorted(self._locals)}

    def _local_name(self, variable: str) -> str:
        member = self.members.channel(variable)
        return member.name if isinstance(member, Attribute) else self.names.fresh(variable)

    def taken(self) -> list[str]:
        """The names that are in use in the process."""
        return [
            *self.members.arguments.values(),
            *self._variables.values(),
            *self.signals.values(),
            *self.helpers.values(),
        ]

    def __getitem__(self, helper: str) -> Name:
        """A local variable of the generated code itself."""
        return Name(self.helpers[helper])

    def of_run(self, helper: str) -> Name:
        """The local variable for the ``scheduler`` of the run, for its ``queue``, into which all that is ready is put
        in a program without prioritized parallels, or for ``observe``, which notes communications.
        """
        self.run.add(helper)
        return self[helper]

    # Variables, signals, parameters

    def is_local(self, variable: str) -> bool:
        """Whether a variable is a local variable of the code."""
        return variable in self._locals

    @property
    def has_locals(self) -> bool:
        """Whether any variable is one."""
        return bool(self._locals)

    def variable(self, name: str) -> Code:
        """The value of a variable."""
        if name in self._locals:
            return Name(self._variables[name])
        return self.local(self.members.channel(name)).field("value")

    def signal(self, name: str) -> Code:
        """A signal, a state or a constant of a law, or an object written by hand."""
        spelled = self.signal_name(name)
        if name in self.constants:
            return self.bind(spelled)
        return own(spelled) if name in self.states and self.runs_again else Name(spelled)

    def signal_name(self, name: str) -> str:
        """The name of a signal, as an attribute or as a local variable."""
        if name not in self.signals:
            self.signals[name] = self.names.fresh(name)
        return self.signals[name]

    def constant_made(self, name: str) -> Code:
        """A constant as the constructor assigns it."""
        return own(self.signal_name(name))

    def parameter(self, name: str) -> Code:
        """A parameter."""
        return self.bind(self.members.arguments[name])

    def bind(self, attribute: str) -> Name:
        """The local variable for an attribute of ``self``."""
        self.bound[attribute] = None
        return Name(attribute)

    def local(self, member: Code) -> Code:
        """The local variable for an attribute of ``self``, or an expression that begins with it."""
        match member:
            case Attribute(operand=operand, name=name) if operand == SELF:
                return self.bind(name)
            case Attribute(operand=operand, name=name):
                return self.local(operand).field(name)
            case Element(operand=operand, index=index):
                return self.local(operand).at(index)
            case _:
                raise AssertionError(f"{member} is not a member")

    def shared(self) -> frozenset[str]:
        """Local variables that a nested function has to declare in order to assign them."""
        return (
            frozenset(self._variables.values())
            | frozenset(self.kept)
            | frozenset(
                spelled for name, spelled in self.signals.items() if name in self.states and not self.runs_again
            )
        )

    def local_declarations(self) -> Iterable[tuple[str, str]]:
        """Channel and local variable of each variable that is local."""
        return self._variables.items()

    # Ends

    def medium(self, end: End) -> Medium:
        """The medium of an end."""
        if isinstance(end, PortEnd):
            return self._media[end.port][end.index or 0]
        channel = self._channels[end.channel]
        return Medium(channel.kind, channel.guarded_reads, channel.guarded_writes)

    def is_dedicated(self, end: End) -> bool:
        """Whether each end of the channel belongs to one task."""
        return place_of(self.process.name, end) in self._dedicated

    def are_dedicated(self, channels: Iterable[Row]) -> Iterator[bool]:
        """The same for each of several channels of the process."""
        dedicated, process = self._dedicated, self.process.name
        return ((process, channel.name, None) in dedicated for channel in channels)

    def type_of(self, end: End) -> Type:
        """The type of the values that are passed at an end."""
        if isinstance(end, PortEnd):
            return next(port.type for port in self.process.ports if port.name == end.port)
        return self._channels[end.channel].type

    def source(self, end: End) -> Code:
        """The local name of an end to read from."""
        return self.local(self.members.source(end))

    def sink(self, end: End) -> Code:
        """The local name of an end to write to."""
        return self.local(self.members.sink(end))

    def value_at(self, end: End) -> Code:
        """The value of a variable or a constant at an end."""
        if isinstance(end, ChannelEnd):
            return self.variable(end.channel)
        member = self.members.sink(end) if self.medium(end).kind == "var" else self.members.source(end)
        return self.local(member).field("value")

    def part(self, instance: str) -> Code:
        """The local name of an inlined process or a law."""
        return self.bind(self.parts[instance])


def is_inline(medium: Medium) -> bool:
    """Whether the generated code itself communicates over it, in the slots of a ``Rendezvous`` or a ``Dedicated``
    channel.
    """
    return medium.kind == "sync" and not medium.guarded_writes


def is_alternated(medium: Medium) -> bool:
    """Whether it is a ``Rendezvous`` that alternatives watch."""
    return is_inline(medium) and medium.guarded_reads


def is_plain_access(end: End, medium: Medium) -> bool:
    """Whether an access is not a communication."""
    return medium.kind in MEDIA_WITHOUT_COMMUNICATION or (isinstance(end, ChannelEnd) and medium.kind == "var")
