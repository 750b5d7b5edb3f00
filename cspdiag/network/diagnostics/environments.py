"""What can be wrong with an environment."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Label, Span
from cspdiag.base.record import record
from cspdiag.network.ir.network import Direction

_SHOWN = 5
"""How many of many names are shown."""


def _listed(names: list[str]) -> str:
    """``a``, ``a and b``, ``a, b and c``, in backticks; the first of many, and how many more there are."""
    quoted = [f"`{name}`" for name in names[:_SHOWN]]
    if len(names) > _SHOWN:
        return f"{', '.join(quoted)} and {len(names) - _SHOWN} more"
    return quoted[0] if len(quoted) == 1 else f"{', '.join(quoted[:-1])} and {quoted[-1]}"


@record
class IncompleteEnvironment(Diagnostic):
    code = "E0801"
    title = "an incomplete environment"

    environment: str
    process: str
    ports: tuple[tuple[str, Direction, Span], ...]

    @property
    def message(self) -> str:
        names = _listed([name for name, _, _ in self.ports])
        verb = "is" if len(self.ports) == 1 else "are"
        return f"{names} of the process `{self.process}` {verb} not connected in the environment `{self.environment}`"

    @property
    def help(self) -> str:
        lines = [f"{name} -> _" if direction == "out" else f"... -> {name}" for name, direction, _ in self.ports]
        return (
            "connect it: " + " or ".join(f"`{line}`" for line in lines) if len(lines) == 1 else "add " + _listed(lines)
        )

    @property
    def labels(self) -> tuple[Label, ...]:
        declared = {span: name.partition("[")[0] for name, _, span in self.ports}
        return tuple(Label(span, f"`{name}` is declared here") for span, name in declared.items())


@record
class UnconnectedInputs(Diagnostic):
    code = "E0802"
    title = "an input of the environment that nothing drives"

    member: str
    ports: tuple[tuple[str, Span], ...]

    @property
    def message(self) -> str:
        return f"nothing drives {_listed([f'{self.member}.{name}' for name, _ in self.ports])}"

    @property
    def help(self) -> str:
        return f"connect it, `... -> {self.member}.{self.ports[0][0]}`, or give the port a default value"

    @property
    def labels(self) -> tuple[Label, ...]:
        declared = {span: name.partition("[")[0] for name, span in self.ports}
        return tuple(Label(span, f"`{name}` is declared here") for span, name in declared.items())


@record
class EnvironmentStepNotPositive(Diagnostic):
    code = "E0808"
    title = "a step that is not positive"
    message = "the step of an environment must be positive"


@record
class UnknownMissPolicy(Diagnostic):
    code = "E0809"
    title = "an unknown answer to a missed sample"
    help = "write `on miss timeout` or `on miss count`"

    name: str

    @property
    def message(self) -> str:
        return f"a missed sample cannot be answered by `{self.name}`"


@record
class UnknownPlaced(Diagnostic):
    code = "E0850"
    title = "a place with an instance that does not exist"

    instance: str
    process: str
    known: tuple[str, ...]

    @property
    def message(self) -> str:
        return f"the process `{self.process}` has no instance `{self.instance}`"

    @property
    def help(self) -> str:
        return "it has " + ", ".join(f"`{name}`" for name in self.known) if self.known else "it has no instances"


@record
class PlacedTwice(Diagnostic):
    code = "E0851"
    title = "an instance or a place that is named twice"

    what: str
    first: Span

    @property
    def message(self) -> str:
        return f"{self.what} occurs twice among the places of this environment"

    @property
    def help(self) -> str:
        return "each place has a name of its own, and each instance belongs to one place"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.first, "it occurs here for the first time"),)


@record
class NotPlaced(Diagnostic):
    code = "E0852"
    title = "an instance without a place"

    instance: str
    declared: Span

    @property
    def message(self) -> str:
        return f"no place has the instance `{self.instance}`"

    @property
    def help(self) -> str:
        return f"add it to one: `place NAME : {self.instance}`"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, "declared here"),)


@record
class PlacesNeedParallel(Diagnostic):
    code = "E0853"
    title = "places for a process that is no parallel of instances"

    process: str
    composition: Span | None

    @property
    def message(self) -> str:
        return f"the composition of `{self.process}` is not a parallel of its instances, so it cannot be divided"

    @property
    def help(self) -> str:
        return "make it `a || b`, and put what comes before, after or around that inside the instances"

    @property
    def labels(self) -> tuple[Label, ...]:
        return () if self.composition is None else (Label(self.composition, "this composition"),)


@record
class IndivisibleChannel(Diagnostic):
    code = "E0854"
    title = "a channel that cannot connect two places"

    channel: str
    why: str
    places: tuple[str, str]
    declared: Span

    @property
    def message(self) -> str:
        first, second = self.places
        return f"`{self.channel}` connects the places `{first}` and `{second}`, but {self.why}"

    @property
    def help(self) -> str:
        return (
            "put its users into one place, or let them communicate by a rendezvous or a broadcast without output guards"
        )

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, f"`{self.channel}` is declared here"),)


@record
class DriverOfTwoPlaces(Diagnostic):
    code = "E0855"
    title = "a driver for two places"

    driver: str
    places: tuple[str, str]

    @property
    def message(self) -> str:
        first, second = self.places
        return f"processes in `{first}` and in `{second}` use the driver `{self.driver}`, which one host has"

    @property
    def help(self) -> str:
        return "give each place a driver of its own, or let one place pass the values on over a channel"
