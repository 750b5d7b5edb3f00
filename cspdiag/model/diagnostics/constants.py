"""What can be wrong with values that are computed before the program runs."""

from __future__ import annotations

from cspdiag.base import Diagnostic
from cspdiag.base.record import record
from cspdiag.model.types import Type
from cspdiag.model.wording import noun


@record
class NumberTooLarge(Diagnostic):
    """A number in the text does not fit its type.

    An int has 64 bits and a sign, ``int8`` to ``uint32`` have what their names say, a double reaches to about 1.8e308.

    Refused::

        const n: uint8 = 300

    Mended::

        const n: uint16 = 300
    """

    code = "E0901"
    title = "a number that does not fit"

    type: Type

    @property
    def message(self) -> str:
        return f"this number does not fit {noun(self.type)}"


@record
class ConstantOverflow(Diagnostic):
    """A value that is computed before the program runs is out of the range of its type.

    The same happens while the program runs as the exception ``Fault``; what is known beforehand is refused at once.

    Refused::

        const n = 9000000000000000000 * 2

    Mended::

        const n = 9e18 * 2
    """

    code = "E0902"
    title = "a constant out of range"

    value: str
    type: Type

    @property
    def message(self) -> str:
        return f"this is {self.value}, which does not fit {noun(self.type)}"


@record
class ConstantDivision(Diagnostic):
    """A division by zero, or a function outside its domain, is known before the program runs.

    While the program runs this is the exception ``Fault``; what is known beforehand is refused at once.

    Refused::

        const n = 1 / 0

    Mended::

        const n = 1 / 2
    """

    code = "E0903"
    title = "an undefined constant"

    problem: str

    @property
    def message(self) -> str:
        return self.problem


@record
class IndexOutOfRange(Diagnostic):
    """An index that is known before the program runs lies outside the array.

    Arrays are counted from 0, so that ``x[n]`` is just outside an array of ``n`` elements.

    Refused::

        const x = [1, 2, 3]
        const last = x[3]

    Mended::

        const x = [1, 2, 3]
        const last = x[2]
    """

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
        return f"indexes go from 0 to {self.size - 1}"


@record
class BadSize(Diagnostic):
    """The size of an array of values is negative or too large.

    Arrays are passed on as a whole and stand in generated code element by element.

    Refused::

        const n = 2
        const x: double[n - 3] = [1]

    Mended::

        const n = 4
        const x: double[n - 3] = [1]
    """

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
        return f"at most {self.most} are possible" if self.size > 0 else None


@record
class NegativeDuration(Diagnostic):
    """A delay or a time-out is negative.

    Nothing can be waited for in the past.

    Refused::

        process Main {
          out y : int
          composition { wait 1 ms - 2 ms ; y ! 1 }
        }

    Mended::

        process Main {
          out y : int
          composition { wait 2 ms - 1 ms ; y ! 1 }
        }
    """

    code = "E0906"
    title = "a negative duration"

    what: str
    value: str

    @property
    def message(self) -> str:
        return f"{self.what} is {self.value}; it cannot be negative"
