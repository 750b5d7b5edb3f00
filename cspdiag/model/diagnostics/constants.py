"""Diagnostics of values that are computed before the program runs."""

from __future__ import annotations

from cspdiag.base import Diagnostic
from cspdiag.base.record import record
from cspdiag.model.types import Type
from cspdiag.model.wording import noun


@record
class NumberTooLarge(Diagnostic):
    code = "E0901"
    title = "a number that does not fit"

    type: Type

    @property
    def message(self) -> str:
        return f"this number does not fit {noun(self.type)}"


@record
class ConstantOverflow(Diagnostic):
    code = "E0902"
    title = "a constant out of range"

    value: str
    type: Type

    @property
    def message(self) -> str:
        return f"this is {self.value}, which does not fit {noun(self.type)}"


@record
class ConstantDivision(Diagnostic):
    code = "E0903"
    title = "an undefined constant"

    problem: str

    @property
    def message(self) -> str:
        return self.problem


@record
class IndexOutOfRange(Diagnostic):
    code = "E0904"
    title = "an index out of range"

    index: int
    size: int

    @property
    def message(self) -> str:
        elements = "one element" if self.size == 1 else f"{self.size} elements"
        return f"the index {self.index} is outside an array of {elements}"

    @property
    def help(self) -> str:
        if self.size == 0:
            return "the array is empty"
        if self.size == 1:
            return "its only index is 0"
        return f"indexes go from 0 to {self.size - 1}"


@record
class CertainFault(Diagnostic):
    code = "W0907"
    title = "an expression that always faults"
    severity = "warning"
    help = "change the constants, or compute it only where they allow it: `if ... then ... else ...`"

    problem: str

    @property
    def message(self) -> str:
        return f"{self.problem}: evaluating it always raises `Fault`"


@record
class BadSize(Diagnostic):
    code = "E0905"
    title = "an impossible size"

    size: int
    most: int

    @property
    def message(self) -> str:
        if self.size < 0:
            return f"the size {self.size} is negative"
        return f"the size {self.size} is too large"

    @property
    def help(self) -> str | None:
        return f"at most {self.most} are possible" if self.size > 0 else "a size is at least 0"


@record
class NegativeDuration(Diagnostic):
    code = "E0906"
    title = "a negative duration"

    what: str
    value: str

    @property
    def message(self) -> str:
        return f"{self.what} is {self.value}; it cannot be negative"
