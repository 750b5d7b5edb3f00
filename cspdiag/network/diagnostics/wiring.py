"""What can be wrong with the connections of an environment."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Label, Span
from cspdiag.base.record import record
from cspdiag.network.ir.network import Direction


@record
class WrongDirection(Diagnostic):
    code = "E0803"
    title = "a relationship against the direction of a port"
    help = "turn the arrow around"

    reference: str
    direction: Direction
    is_member: bool
    declared: Span

    @property
    def message(self) -> str:
        owner = "" if self.is_member else " of the process"
        role = "source" if self.direction == "in" else "sink"
        return f"`{self.reference}` is an {self.direction} port{owner} and cannot be a {role} in the environment"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, f"declared as `{self.direction}` here"),)


@record
class TwoSources(Diagnostic):
    code = "E0804"
    title = "two sources for one port"
    help = "keep one of them, or combine them in a submodel"

    sink: str
    first: str
    second: str
    first_span: Span

    @property
    def message(self) -> str:
        return f"`{self.sink}` is driven by both `{self.first}` and `{self.second}`"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.first_span, f"driven by `{self.first}` here"),)


@record
class DriverToSubmodel(Diagnostic):
    code = "E0805"
    title = "a driver connected to a submodel"
    help = "connect drivers to ports of the process"

    driver: str
    source: str
    sink: str

    @property
    def message(self) -> str:
        return f"the driver `{self.driver}` is connected to a submodel: `{self.source} -> {self.sink}`"


@record
class SharedPort(Diagnostic):
    code = "E0806"
    title = "a port with two counterparts"
    help = "write an environment for each, or one driver that does both"

    port: str
    first: str
    second: str
    first_span: Span

    @property
    def message(self) -> str:
        owners = [f"the driver `{name}`" if name else "the simulated system" for name in (self.first, self.second)]
        return f"`{self.port}` of the process is connected to both {owners[0]} and {owners[1]}"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.first_span, "the other relationship"),)


@record
class NotInEnvironment(Diagnostic):
    code = "E0807"
    title = "not in an environment"
    help = "compute in submodels, and connect their ports"

    what: str

    @property
    def message(self) -> str:
        return f"an environment cannot have {self.what}"
