"""Diagnostics of the equations of a submodel."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Label, Span
from cspdiag.base.record import record
from cspdiag.model.diagnostics.ports import MisusedName


@record
class MissingEquation(Diagnostic):
    code = "E0401"
    title = "an output without an equation"

    name: str
    owner: str

    @property
    def message(self) -> str:
        return f"the output `{self.name}` of `{self.owner}` has no equation"

    @property
    def help(self) -> str:
        return f"write `{self.name} = ...`"


@record
class RepeatedEquation(Diagnostic):
    code = "E0402"
    title = "two equations for one name"
    help = "keep one of them, or choose by `if condition then a else b`"

    name: str
    first: Span

    @property
    def message(self) -> str:
        return f"`{self.name}` has two equations"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.first, "the first one"),)


@record
class EquationForInput(MisusedName):
    code = "E0403"
    title = "an equation for an input"

    @property
    def message(self) -> str:
        return f"`{self.name}` is {self.kind} and cannot be given a value here"


@record
class StateWithoutLaw(Diagnostic):
    code = "E0404"
    title = "a state that never changes"

    name: str

    @property
    def message(self) -> str:
        return f"the state `{self.name}` has neither a next value nor a derivative"

    @property
    def help(self) -> str:
        return f"write `next {self.name} = ...` (discrete) or `der {self.name} = ...` (continuous)"


@record
class StateWithTwoLaws(Diagnostic):
    code = "E0405"
    title = "a state with two laws"
    help = "keep one of them"

    name: str
    second: str
    first: Span
    first_law: str

    @property
    def message(self) -> str:
        second = "a second one" if self.second == self.first_law else f"{self.second} as well"
        return f"the state `{self.name}` already has {self.first_law}; it cannot have {second}"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.first, f"{self.first_law} is given here"),)


@record
class UnconnectedInput(Diagnostic):
    code = "E0406"
    title = "an inner submodel without an input"

    names: tuple[str, ...]
    instance: str
    declared: Span | None

    @property
    def message(self) -> str:
        shown = ", ".join(f"`{self.instance}.{name}`" for name in self.names)
        plural = "inputs" if len(self.names) > 1 else "input"
        return f"the {plural} {shown} of the inner submodel {'have' if len(self.names) > 1 else 'has'} no equation"

    @property
    def help(self) -> str:
        return f"write `{self.instance}.{self.names[0]} = ...`"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, "the input is declared here"),) if self.declared else ()


@record
class NotContinuous(Diagnostic):
    code = "E0407"
    title = "a derivative of a discrete value"

    name: str
    type: str
    declared: Span

    @property
    def message(self) -> str:
        return f"the state `{self.name}` is of type {self.type} and has no derivative"

    @property
    def help(self) -> str:
        return f"write `next {self.name} = ...`, or declare the state as a double"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, "the state is declared here"),)
