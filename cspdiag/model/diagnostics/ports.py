"""Diagnostics of ports, of the two ends of a relationship, and of what a composition reads and writes."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Label, Span
from cspdiag.base.record import record
from cspdiag.model.types import IntType, RealType, Type
from cspdiag.model.wording import noun


@record
class MisusedName(Diagnostic):
    """A name in a place where what it means is not allowed."""

    name: str
    kind: str
    advice: str
    declared: Span | None

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, f"`{self.name}` is declared here"),) if self.declared else ()


@record
class WrongSource(MisusedName):
    code = "E0230"
    title = "an arrow that begins at a sink"

    @property
    def message(self) -> str:
        return f"`{self.name}` is {self.kind}, which is not a source of values"


@record
class WrongSink(MisusedName):
    code = "E0231"
    title = "an arrow that ends at a source"

    @property
    def message(self) -> str:
        return f"`{self.name}` is {self.kind}, which takes no values"


@record
class NotReadable(MisusedName):
    code = "E0232"
    title = "reading what cannot be read"

    @property
    def message(self) -> str:
        return f"`{self.name}` is {self.kind} and cannot be read here"


@record
class NotWritable(MisusedName):
    code = "E0233"
    title = "writing what cannot be written"

    @property
    def message(self) -> str:
        return f"`{self.name}` is {self.kind} and cannot be written here"


@record
class NotVariable(MisusedName):
    code = "E0234"
    title = "not a variable"

    @property
    def message(self) -> str:
        return f"`{self.name}` is {self.kind}, not a variable"


@record
class DifferentEnds(Diagnostic):
    code = "E0316"
    title = "two ends of different types"

    first: str
    first_type: Type
    second: str
    second_type: Type
    places: tuple[Label, ...]
    advice: str | None = None

    @property
    def message(self) -> str:
        return f"`{self.first}` carries {noun(self.first_type)}, but `{self.second}` {noun(self.second_type)}"

    @property
    def help(self) -> str:
        if self.advice is not None:
            return self.advice
        first, second = self.first_type, self.second_type
        if isinstance(first, RealType) and isinstance(second, RealType) and first.bits == second.bits:
            if first.unit.exponents == second.unit.exponents and first.unit.scale != second.unit.scale:
                return f"give both one unit, or put a submodel between them that computes `convert(x, {second.unit})`"
            return "give both the same unit"
        if isinstance(first, RealType | IntType) and isinstance(second, RealType | IntType):
            name = str(second) if isinstance(second, IntType) else "double" if second.bits == 64 else "float"
            return f"give both one type, or put a submodel between them that computes `{name}(x)`"
        return "give both the same type"

    @property
    def labels(self) -> tuple[Label, ...]:
        return self.places


@record
class MisplacedPortOption(Diagnostic):
    code = "E0235"
    title = "a port option in the wrong place"
    help = "remove it, or turn the port around"

    option: str
    expected: str

    @property
    def message(self) -> str:
        return f"{self.option} belongs to {self.expected}"
