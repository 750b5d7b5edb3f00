"""What is wrong with a communication diagram: sizes, indexes and ends of relationships."""

from __future__ import annotations

from cspdiag.diagnostics import Diagnostic, Label, Span
from cspdiag.diagnostics.record import record


@record
class NotConnected(Diagnostic):
    """E0501."""

    code = "E0501"
    title = "port that is not connected"

    instance: str
    definition: str
    ports: tuple[str, ...]
    direction: str
    declared: Span

    @property
    def message(self) -> str:
        ports = " and ".join(f"`{port}`" for port in self.ports[:3])
        more = f" and {len(self.ports) - 3} more" if len(self.ports) > 3 else ""
        plural = "s" if len(self.ports) > 1 else ""
        return f"port{plural} {ports}{more} of `{self.instance}` {'are' if plural else 'is'} not connected"

    @property
    def help(self) -> str | None:
        port = f"{self.instance}.{self.ports[0]}"
        if self.direction == "in":
            return f"connect it (`... -> {port}`), or give the port a default in `{self.definition}`"
        return f"connect it, or throw the values away with `{port} -> _`"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, f"the port `{self.ports[0]}` is declared here"),)


@record
class ConnectedTwice(Diagnostic):
    """E0502."""

    code = "E0502"
    title = "port connected twice"

    port: str
    direction: str
    first: Span

    @property
    def message(self) -> str:
        return f"`{self.port}` is connected twice"

    @property
    def help(self) -> str | None:
        if self.direction == "in":
            return "an input has one relationship: leave one away, or list both sources before one arrow"
        return "an output has one relationship: list all its readers after one arrow"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.first, "connected here first"),)


@record
class IndexOutOfRange(Diagnostic):
    """E0503."""

    code = "E0503"
    title = "index out of range"

    index: int
    what: str
    size: int
    declared: Span

    @property
    def message(self) -> str:
        return f"index {self.index} is out of range: {self.what} has {self.size} elements, 0 to {self.size - 1}"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, "declared here"),)


@record
class IndexMissing(Diagnostic):
    """E0504."""

    code = "E0504"
    title = "element of an array wanted"

    name: str

    @property
    def message(self) -> str:
        return f"`{self.name}` is an array, and one element of it is wanted here"

    @property
    def help(self) -> str | None:
        return f"choose one: `{self.name}[0]`"


@record
class SizeNotPositive(Diagnostic):
    """E0505."""

    code = "E0505"
    title = "size that is not positive"

    what: str
    size: int

    @property
    def message(self) -> str:
        return f"{self.what} cannot have {self.size} elements"

    @property
    def help(self) -> str | None:
        return "a size is at least 1"


@record
class TooManyInstances(Diagnostic):
    """E0506."""

    code = "E0506"
    title = "too many elements"

    what: str
    number: int
    limit: int

    @property
    def message(self) -> str:
        return f"{self.what} has {self.number} elements or more, and at most {self.limit} are possible"


@record
class PortToPort(Diagnostic):
    """E0507."""

    code = "E0507"
    title = "port connected straight to a port"

    source: str
    sink: str
    first: Span

    @property
    def message(self) -> str:
        return f"no process is between the ports `{self.source}` and `{self.sink}`: nobody would carry the values"

    @property
    def help(self) -> str | None:
        return "put an instance between them, or connect the two where this process is used"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.first, "the other port"),)


@record
class JoinsTwoObjects(Diagnostic):
    """E0508."""

    code = "E0508"
    title = "relationship with two communication objects"

    one: str
    other: str
    first: Span

    @property
    def message(self) -> str:
        return f"one relationship cannot join `{self.one}` and `{self.other}`: each is a channel of its own"

    @property
    def help(self) -> str | None:
        return "give the instance a port for each, or copy the values in a process between them"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.first, f"`{self.one}` here"),)


@record
class PortEndsInLabel(Diagnostic):
    """E0509."""

    code = "E0509"
    title = "port connected to a label"

    port: str
    label_name: str

    @property
    def message(self) -> str:
        return f"nobody carries the values of the port `{self.port}` into `{self.label_name}`"

    @property
    def help(self) -> str | None:
        return (
            f"declare `var {self.label_name}`, and read the port in the composition: `{self.port} ? {self.label_name}`"
        )


@record
class ArraysDiffer(Diagnostic):
    """E0510."""

    code = "E0510"
    title = "arrays of different size connected"

    size: int
    other: Span
    other_size: int

    @property
    def message(self) -> str:
        if self.size == self.other_size:
            return f"an array of {self.size} is connected to a single port"
        return f"an array of {self.size} is connected to {'one' if self.other_size == 1 else self.other_size}"

    @property
    def help(self) -> str | None:
        return "arrays are connected element by element: give both the same size, or index one with `[i]`"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.other, "the other end"),)


@record
class VariableUnused(Diagnostic):
    """W0511."""

    code = "W0511"
    title = "variable, channel or label that nobody uses"
    severity = "warning"

    name: str

    @property
    def message(self) -> str:
        return f"nobody uses `{self.name}`"

    @property
    def help(self) -> str | None:
        return "leave it away"


@record
class PortUnused(Diagnostic):
    """W0512."""

    code = "W0512"
    title = "port that its process never uses"
    severity = "warning"

    port: str
    process: str
    direction: str

    @property
    def message(self) -> str:
        verb = "reads" if self.direction == "in" else "writes"
        return f"`{self.process}` never {verb} its port `{self.port}`"

    @property
    def help(self) -> str | None:
        if self.direction == "in":
            return f"use it, leave it away, or say that it is ignored with `{self.port} -> _`"
        return "write it with `!` or connect an instance to it, or leave it away"
