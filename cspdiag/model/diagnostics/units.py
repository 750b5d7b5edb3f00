"""Diagnostics of units and scales."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Edit, Span
from cspdiag.base.record import record
from cspdiag.model.diagnostics.types import MixedOperands, UnexpectedType, WrongType
from cspdiag.model.types import RealType, Type
from cspdiag.model.units import canonical
from cspdiag.model.wording import conversion, conversion_help, noun, shortened


@record
class WrongUnit(UnexpectedType):
    code = "E0302"
    title = "a value of the wrong unit"

    is_number: bool = False

    @property
    def help(self) -> str | None:
        if self.is_number and isinstance(self.expected, RealType):
            return f"write the unit with the number: `{self.span.text}<{self.expected.unit}>`"
        return None


@record
class WrongScale(WrongType):
    code = "E0303"
    title = "a value of a different scale"


@record
class MixedUnits(MixedOperands):
    code = "E0305"
    title = "quantities of different units"

    number: Span | None = None

    @property
    def help(self) -> str | None:
        if not isinstance(self.left, RealType) or not isinstance(self.right, RealType):
            return None
        if self.number is not None:
            unit = self.right.unit if self.number is self.left_span else self.left.unit
            return f"write the unit with the number: `{self.number.text}<{unit}>`"
        if self.left.unit.exponents != self.right.unit.exponents:
            return None
        found, expected, span = self.to_convert
        return conversion_help(found, expected, span.text)

    @property
    def edits(self) -> tuple[Edit, ...]:
        if not isinstance(self.left, RealType) or not isinstance(self.right, RealType) or self.number is not None:
            return ()
        return conversion(*self.to_convert)


@record
class NotDimensionless(Diagnostic):
    code = "E0307"
    title = "a quantity where a number is expected"

    what: str
    found: Type

    @property
    def message(self) -> str:
        return f"{self.what} must be a number without a unit, but this is {noun(self.found)}"

    @property
    def help(self) -> str | None:
        if not isinstance(self.found, RealType):
            return None
        unit = self.found.unit
        if unit.is_dimensionless:
            return f"write `convert({shortened(self.span)}, {canonical(unit)})`"
        return f"divide by a quantity of the same unit, such as `1<{unit}>`"

    @property
    def edits(self) -> tuple[Edit, ...]:
        if not isinstance(self.found, RealType) or not self.found.unit.is_dimensionless or "\n" in self.span.text:
            return ()
        return (Edit(self.span, f"convert({self.span.text}, {canonical(self.found.unit)})"),)


@record
class UnknownUnit(Diagnostic):
    code = "E0309"
    title = "an unknown unit"

    text: str
    suggestion: str | None

    @property
    def message(self) -> str:
        return f"`{self.text}` is not a unit"

    @property
    def help(self) -> str:
        if self.suggestion:
            return f"did you mean `{self.suggestion}`?"
        return "combine SI units by `*`, `/` and `^`, such as `kg*m^2` or `rad/s`"


@record
class UnitNotAllowed(Diagnostic):
    code = "E0310"
    title = "a unit on a type without units"

    name: str
    meaning: Type

    @property
    def message(self) -> str:
        return f"`{self.name}` cannot carry a unit"

    @property
    def help(self) -> str:
        if str(self.meaning) != self.name:
            return f"`{self.name}` already means {self.meaning}"
        return "only `double` and `float` carry units"


@record
class PowerWithoutUnit(Diagnostic):
    code = "E0313"
    title = "a power of a unit that is not a unit"
    help = "make it a number first by dividing by a quantity of the same unit, or use a whole number as the power"

    found: Type
    operation: str

    @property
    def message(self) -> str:
        return f"{self.operation} of {noun(self.found)} has no unit"


@record
class NotConvertible(Diagnostic):
    code = "E0314"
    title = "an impossible conversion"

    found: Type
    target: str

    @property
    def message(self) -> str:
        return f"{noun(self.found)} cannot be converted to {self.target}"
