"""What is declared and never used."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Label, Span
from cspdiag.base.record import record


@record
class VariableUnused(Diagnostic):
    code = "W0511"
    title = "variable, channel or label that is never used"
    severity = "warning"
    help = "remove it"

    name: str

    @property
    def message(self) -> str:
        return f"`{self.name}` is never used"


@record
class PortUnused(Diagnostic):
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
            return f"use it, remove it, or discard its values with `{self.port} -> _`"
        return "write it with `!` or connect an instance to it, or remove it"


@record
class InputDiscarded(Diagnostic):
    code = "W0514"
    title = "input that no equation uses"
    severity = "warning"
    help = "use it in an equation, or remove the input"

    port: str
    submodel: str

    @property
    def message(self) -> str:
        return f"no equation of `{self.submodel}` uses its input `{self.port}`: its values are taken and discarded"


@record
class HandlerNeverRuns(Diagnostic):
    code = "W0515"
    title = "handler of an exception that is never raised there"
    severity = "warning"

    exception: str
    is_caught_inside: bool
    declared: Span

    @property
    def message(self) -> str:
        if self.is_caught_inside:
            return f"this handler never runs: `{self.exception}` is caught further inside"
        return f"this handler never runs: nothing that the `catch` watches raises `{self.exception}`"

    @property
    def help(self) -> str | None:
        if self.is_caught_inside:
            return "remove one of the two, or raise the exception again in the inner handler"
        return "put the `catch` around what raises the exception, in parentheses if that is several steps, or remove it"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, f"`{self.exception}` is declared here"),)


@record
class MayChange(Diagnostic):
    code = "E0911"
    title = "a parameter of the program where a value is needed that never changes"

    name: str
    what: str
    parameter: str
    """The parameter itself, or the one from which the constant of that name follows."""
    declared: Span

    @property
    def message(self) -> str:
        follows = "" if self.name == self.parameter else f" follows from `{self.parameter}`, which"
        return f"`{self.name}`{follows} may change while the program runs, but this is {self.what}"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, f"`{self.parameter}` is a parameter of the program"),)

    @property
    def help(self) -> str:
        return (
            f"write `const` instead of `parameter`: a constant can be set before a run, with `--set {self.parameter}=…`"
        )
