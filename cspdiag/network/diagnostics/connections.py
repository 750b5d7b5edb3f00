"""Ports and relationships that do not fit together."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Label, Span
from cspdiag.base.record import record

_SHOWN = 3
"""How many of many ports are named."""


@record
class OpenPort:
    """A port, or an element of one, that nothing is connected to; ``declared`` is where the port is."""

    name: str
    direction: str
    declared: Span


@record
class NotConnected(Diagnostic):
    code = "E0501"
    title = "port that is not connected"

    instance: str
    definition: str
    ports: tuple[OpenPort, ...]

    @property
    def message(self) -> str:
        *others, last = [f"`{port.name}`" for port in self.ports[:_SHOWN]]
        if len(self.ports) > _SHOWN:
            others, last = [*others, last], f"{len(self.ports) - _SHOWN} more"
        names = f"{', '.join(others)} and {last}" if others else last
        many = len(self.ports) > 1
        return f"port{'s' if many else ''} {names} of `{self.instance}` {'are' if many else 'is'} not connected"

    @property
    def help(self) -> str | None:
        inputs = [f"{self.instance}.{port.name}" for port in self.ports if port.direction == "in"]
        outputs = [f"{self.instance}.{port.name}" for port in self.ports if port.direction != "in"]
        both = bool(inputs and outputs)
        ways = []
        if inputs:
            it = _meant(inputs, "the input", is_distinct=both)
            default = "the port a default" if len(inputs) == 1 else "the ports defaults"
            ways.append(f"connect {it} (`... -> {inputs[0]}`), or give {default} in `{self.definition}`")
        if outputs:
            it = _meant(outputs, "the output", is_distinct=both)
            ways.append(f"connect {it}, or discard the values with `{outputs[0]} -> _`")
        return "; ".join(ways)

    @property
    def labels(self) -> tuple[Label, ...]:
        return tuple(Label(port.declared, f"the port `{port.name}` is declared here") for port in self.ports[:_SHOWN])


def _meant(ports: list[str], noun: str, *, is_distinct: bool) -> str:
    """``it``, ``each``, or the noun where there are ports of both kinds."""
    if not is_distinct:
        return "it" if len(ports) == 1 else "each"
    return noun if len(ports) == 1 else f"{noun}s"


@record
class ConnectedTwice(Diagnostic):
    code = "E0502"
    title = "port connected twice"

    port: str
    direction: str
    first: Span

    @property
    def message(self) -> str:
        again = "again in each step of `for`" if self._repeated else "twice"
        return f"`{self.port}` is connected {again}"

    @property
    def _repeated(self) -> bool:
        return self.first == self.span

    @property
    def help(self) -> str | None:
        if self._repeated and self.direction == "in":
            return f"list all sources before one arrow, without `for`: `a[0].port, a[1].port -> {self.port}`"
        if self._repeated:
            return f"list all readers after one arrow, without `for`: `{self.port} -> a[0].port, a[1].port`"
        if self.direction == "in":
            return "an input has one relationship: remove one, or list both sources before one arrow"
        return "an output has one relationship: list all its readers after one arrow"

    @property
    def labels(self) -> tuple[Label, ...]:
        return () if self._repeated else (Label(self.first, "connected here first"),)


@record
class PortToPort(Diagnostic):
    code = "E0507"
    title = "port connected straight to a port"
    help = "put an instance between them, or connect the two where this process is used"

    source: str
    sink: str
    first: Span

    @property
    def message(self) -> str:
        return f"there is no process between the ports `{self.source}` and `{self.sink}` to pass the values on"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.first, "the other port"),)


@record
class JoinsTwoObjects(Diagnostic):
    code = "E0508"
    title = "relationship with two communication objects"
    help = "give the instance a port for each, or copy the values in a process between them"

    one: str
    other: str
    first: Span

    @property
    def message(self) -> str:
        return f"one relationship cannot join `{self.one}` and `{self.other}`: each is a channel of its own"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.first, f"`{self.one}` here"),)


@record
class PortEndsInLabel(Diagnostic):
    code = "E0509"
    title = "port connected to a label"

    port: str
    label_name: str

    @property
    def message(self) -> str:
        return f"no process carries the values of the port `{self.port}` into `{self.label_name}`"

    @property
    def help(self) -> str | None:
        return (
            f"declare `var {self.label_name}`, and read the port in the composition: `{self.port} ? {self.label_name}`"
        )
