"""What can be wrong with types of values."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Label, Span
from cspdiag.base.record import record
from cspdiag.model.types import IntType, RealType, Type
from cspdiag.model.wording import conversion_help, noun, shortened


@record
class WrongType(Diagnostic):
    """A value has another type than is wanted where it stands.

    There are no implicit conversions, so that no diagram changes a value unseen. A number without a point is taken as a double where a
    double is wanted; a variable of type int is not.

    Refused::

        const n: int = 0.5

    Mended::

        const n: double = 0.5
    """

    code = "E0301"
    title = "a value of the wrong type"

    what: str
    found: Type
    wanted: str
    advice: str | None = None
    declared: Span | None = None
    declared_text: str = ""

    @property
    def message(self) -> str:
        return f"{self.what} is {self.wanted}, but this is {noun(self.found)}"

    @property
    def help(self) -> str | None:
        return self.advice

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, self.declared_text),) if self.declared else ()


@record
class MixedNumbers(Diagnostic):
    """An operator stands between numbers of different types.

    No number is converted unseen. A number without a point is taken as a double beside a double; a variable of type int has to be
    converted with ``double(x)``.

    Refused::

        const n = 3
        const x = 0.5
        const y = n * x

    Mended::

        const n = 3
        const x = 0.5
        const y = double(n) * x
    """

    code = "E0304"
    title = "numbers of different types"

    operator: str
    left: Type
    right: Type
    left_span: Span
    right_span: Span

    @property
    def message(self) -> str:
        return f"`{self.operator}` stands between {noun(self.left)} and {noun(self.right)}"

    @property
    def help(self) -> str | None:
        if isinstance(self.left, RealType) and not isinstance(self.right, RealType):
            return conversion_help(self.right, RealType(self.left.bits), self.right_span.text)
        if isinstance(self.right, RealType) and not isinstance(self.left, RealType):
            return conversion_help(self.left, RealType(self.right.bits), self.left_span.text)
        if isinstance(self.left, IntType) and isinstance(self.right, IntType):
            if self.left.bits > self.right.bits:
                return conversion_help(self.right, self.left, self.right_span.text)
            return conversion_help(self.left, self.right, self.left_span.text)
        return conversion_help(self.right, self.left, self.right_span.text)

    @property
    def labels(self) -> tuple[Label, ...]:
        return (
            Label(self.left_span, f"this is {noun(self.left)}"),
            Label(self.right_span, f"this is {noun(self.right)}"),
        )


@record
class UnsuitableOperand(Diagnostic):
    """An operator or a function does not work on values of this type.

    Arithmetic is for numbers and times, ``%`` for integers and times only; order is for numbers and times, not for enums and structs.

    Refused::

        const rest = 7.5 % 2.0

    Mended::

        const rest = 7 % 2
    """

    code = "E0306"
    title = "an operand of the wrong type"

    operator: str
    found: Type
    advice: str | None

    @property
    def message(self) -> str:
        return f"`{self.operator}` does not work on {noun(self.found)}"

    @property
    def help(self) -> str | None:
        return self.advice


@record
class NotCondition(Diagnostic):
    """A condition is no bool.

    Numbers are not conditions: whether zero means yes or no is left to nobody's memory but written as a comparison.

    Refused::

        process Main {
          out y : int
          communication { var n : int = 1 }
          composition { if n then y ! 1 }
        }

    Mended::

        process Main {
          out y : int
          communication { var n : int = 1 }
          composition { if n != 0 then y ! 1 }
        }
    """

    code = "E0308"
    title = "a condition that is no bool"

    found: Type

    @property
    def message(self) -> str:
        return f"a condition is a bool, but this is {noun(self.found)}"

    @property
    def help(self) -> str | None:
        if isinstance(self.found, IntType | RealType):
            return f"compare it: `{shortened(self.span)} != 0`"
        return None


@record
class NotIndexed(Diagnostic):
    """Something that is no array is indexed, or an array needs an index that is not given.

    An index picks one element of an array, one port of an array of ports, or one instance of an array of instances. Fields belong to
    structs only.

    Refused::

        const n = 3
        const first = n[0]

    Mended::

        const n = [3]
        const first = n[0]
    """

    code = "E0311"
    title = "a wrong index"

    what: str
    problem: str
    advice: str | None
    declared: Span | None

    @property
    def message(self) -> str:
        return f"{self.what} {self.problem}"

    @property
    def help(self) -> str | None:
        return self.advice

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, f"{self.what} is declared here"),) if self.declared else ()


@record
class DifferentTypes(Diagnostic):
    """Values that must have one type have several.

    The two sides of a choice, the elements of an array, and the arguments of ``min``, ``max`` and ``limit`` are of one type and unit,
    because any of them may be the result.

    Refused::

        const x = if true then 1 else false

    Mended::

        const x = if true then 1 else 0
    """

    code = "E0312"
    title = "values of different types"

    what: str
    first: Type
    second: Type
    first_span: Span

    @property
    def message(self) -> str:
        return f"{self.what} must have one type, but there is {noun(self.first)} and {noun(self.second)}"

    @property
    def help(self) -> str | None:
        if isinstance(self.first, IntType) and isinstance(self.second, RealType):
            return conversion_help(self.first, self.second, self.first_span.text)
        return conversion_help(self.second, self.first, self.span.text)

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.first_span, f"this is {noun(self.first)}"),)


@record
class UselessValue(Diagnostic):
    """Something stands where a value is wanted but has none, such as a text outside the arguments of a driver.

    Texts are arguments of drivers and of bodies in other languages only.

    Refused::

        const greeting = "hello"

    Mended::

        const greeting = 1
    """

    code = "E0315"
    title = "no value"

    what: str
    advice: str | None

    @property
    def message(self) -> str:
        return f"{self.what} cannot be used here"

    @property
    def help(self) -> str | None:
        return self.advice


@record
class ConstantNoTime(Diagnostic):
    """A constant is a frequency or a number of seconds, and a time where it is used.

    Where a frequency is written for a time it means its period: `@ 10 Hz` is `@ 100 ms`. A constant without a type has that of its
    value, and so it is a `double<Hz>`. With the type `time` it is the period everywhere. Likewise `0.01<s>` is a `double<s>`, and `0.01 s` a time.

    Refused::

        const T = 10 Hz

        process Main {
          in  angle : double @ T
          out motor : double @ T
          communication { var now : double = 0 }
          composition { mu (angle ? now ; motor ! now) }
        }

    Mended::

        const T : time = 10 Hz

        process Main {
          in  angle : double @ T
          out motor : double @ T
          communication { var now : double = 0 }
          composition { mu (angle ? now ; motor ! now) }
        }
    """

    code = "E0317"
    title = "a constant that is no time"

    name: str
    found: Type
    what: str
    use: Span
    advice: str

    @property
    def message(self) -> str:
        return f"the constant `{self.name}` is {noun(self.found)}, but {self.what} is a time"

    @property
    def help(self) -> str | None:
        return self.advice

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.use, "used as a time here"),)
