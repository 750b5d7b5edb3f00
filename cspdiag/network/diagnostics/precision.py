"""What can be wrong with a program that computes in single precision."""

from __future__ import annotations

from typing import ClassVar

from cspdiag.base import Diagnostic, Severity
from cspdiag.base.record import record


@record
class NotInSinglePrecision(Diagnostic):
    code = "E0908"
    title = "a number that single precision does not have"
    help = "compute in double precision (without --real float32), or in a unit in which the number is nearer to 1"

    number: str
    is_large: bool

    @property
    def message(self) -> str:
        limit = "the largest is about 3.4e38" if self.is_large else "the smallest is about 1.4e-45"
        return f"{self.number} is too {'large' if self.is_large else 'small'} for single precision: {limit}"


@record
class ChangedArgument(Diagnostic):
    code = "E0909"
    title = "an argument that single precision changes"
    help = "compute it from whole numbers or times, or give it as a number"

    name: str
    before: str
    after: str

    @property
    def message(self) -> str:
        return (
            f"`{self.name}` is {self.before}, but {self.after} if it is computed from what single precision has rounded"
        )


@record
class RoundedWhole(Diagnostic):
    code = "W0910"
    title = "a whole number that single precision rounds"
    help = "single precision has every whole number up to 16777216; use a type of whole numbers for a count"
    severity: ClassVar[Severity] = "warning"

    number: int
    nearest: int

    @property
    def message(self) -> str:
        return f"{self.number} becomes {self.nearest} in single precision"
