"""Sizes and indexes."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Label, Span
from cspdiag.base.record import record
from cspdiag.model.types import Type


@record
class IndexOutOfRange(Diagnostic):
    code = "E0503"
    title = "index out of range"

    index: int
    what: str
    size: int
    declared: Span

    @property
    def message(self) -> str:
        elements = "one element, 0" if self.size == 1 else f"{self.size} elements, 0 to {self.size - 1}"
        if self.size == 0:
            elements = "no elements"
        return f"index {self.index} is out of range: {self.what} has {elements}"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, "declared here"),)


@record
class IndexMissing(Diagnostic):
    code = "E0504"
    title = "element of an array needed"

    name: str

    @property
    def message(self) -> str:
        return f"`{self.name}` is an array, and one element of it is needed here"

    @property
    def help(self) -> str | None:
        return f"choose one: `{self.name}[0]`"


@record
class SizeNotPositive(Diagnostic):
    code = "E0505"
    title = "size that is not positive"

    what: str
    size: int
    least: int

    @property
    def message(self) -> str:
        return f"{self.what} cannot have {self.size} elements"

    @property
    def help(self) -> str | None:
        return f"a size is at least {self.least}" if self.least else "it is at least 0: with 0, nothing is repeated"


@record
class TooManyInstances(Diagnostic):
    code = "E0506"
    title = "too many elements"

    what: str
    number: int
    limit: int

    @property
    def message(self) -> str:
        return f"{self.what} has {self.number} elements, and at most {self.limit} are possible"


@record
class ArraysDiffer(Diagnostic):
    code = "E0510"
    title = "arrays of different size connected"
    help = "arrays are connected element by element: give both the same size, or index one with `[i]`"

    size: int
    other: Span
    other_size: int

    @property
    def message(self) -> str:
        if self.size == self.other_size:
            return f"an array of {self.size} is connected to a single port"
        return f"an array of {self.size} is connected to {'one' if self.other_size == 1 else self.other_size}"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.other, "the other end"),)


@record
class ValueSizesDiffer(Diagnostic):
    code = "E0513"
    title = "arrays of different lengths"
    help = "give the parameter that the length depends on the value that fits"

    one: str
    one_type: Type
    other: str
    other_type: Type

    @property
    def message(self) -> str:
        return f"`{self.one}` carries a {self.one_type}, but `{self.other}` a {self.other_type}"
