"""What can be wrong with types and units of values."""

from __future__ import annotations

from cspdiag.diagnostics import Diagnostic, Label, Span
from cspdiag.diagnostics.record import record
from cspdiag.model.types import IntType, RealType, TimeType, Type
from cspdiag.model.units import canonical


def noun(found: Type) -> str:
    """A type with its article: ``an int``, ``a double<rad>``."""
    text = str(found)
    return f"an {text}" if text[0] in "aeioAEIO" else f"a {text}"


def conversion_help(found: Type, wanted: Type, written: str) -> str | None:
    """How ``written``, which is ``found``, is turned into what is wanted; None where it cannot."""
    shown = written if len(written) <= 30 and "\n" not in written else "x"
    match found, wanted:
        case RealType(), RealType() if found.unit.exponents == wanted.unit.exponents:
            if found.unit.scale != wanted.unit.scale:
                return f"write `convert({shown}, {wanted.unit})`"
            if found.bits != wanted.bits:
                return f"write `{'double' if wanted.bits == 64 else 'float'}({shown})`"
        case ((IntType() | RealType()), (IntType() | RealType())):
            if isinstance(wanted, RealType) and not wanted.unit.is_dimensionless and isinstance(found, IntType):
                return f"write `double({shown}) * 1<{wanted.unit}>`"
            if isinstance(found, IntType) or found.unit.is_dimensionless:
                name = str(wanted) if isinstance(wanted, IntType) else "double" if wanted.bits == 64 else "float"
                return f"write `{name}({shown})`"
        case ((IntType() | RealType()), TimeType()) if written.replace(".", "", 1).isdigit():
            return f"write it as a duration, such as `{written} s`"
        case TimeType(), RealType():
            return f"`double({shown})` is this time in seconds, a double<s>"
        case _:
            pass
    return None


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
class WrongUnit(Diagnostic):
    """A value has another dimension than is wanted where it stands.

    Units are checked by dimension. ``rad`` counts as 1; a bare ``0`` takes any unit; any other bare number has none.

    Refused::

        const speed: double<rad/s> = 0.5<V>

    Mended::

        const speed: double<rad/s> = 0.5<rad/s>
    """

    code = "E0302"
    title = "a value of the wrong unit"

    what: str
    found: Type
    wanted: Type
    is_number: bool
    declared: Span | None = None
    declared_text: str = ""

    @property
    def message(self) -> str:
        return f"{self.what} is {noun(self.wanted)}, but this is {noun(self.found)}"

    @property
    def help(self) -> str | None:
        if self.is_number and isinstance(self.wanted, RealType):
            return f"write the unit with the number: `{self.span.text}<{self.wanted.unit}>`"
        return None

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, self.declared_text),) if self.declared else ()


@record
class WrongScale(Diagnostic):
    """A value has the right dimension in another scale, such as degrees for radians.

    Nothing is converted silently. ``convert(x, rad)`` says where it happens.

    Refused::

        const reach: double<rad> = 90<deg>

    Mended::

        const reach: double<rad> = convert(90<deg>, rad)
    """

    code = "E0303"
    title = "a value of another scale"

    what: str
    found: Type
    wanted: Type
    declared: Span | None = None
    declared_text: str = ""

    @property
    def message(self) -> str:
        return f"{self.what} is {noun(self.wanted)}, but this is {noun(self.found)}"

    @property
    def help(self) -> str | None:
        return conversion_help(self.found, self.wanted, self.span.text)

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
class MixedUnits(Diagnostic):
    """Quantities of different dimension or scale are added or compared.

    ``+``, ``-`` and comparisons need equal units; ``*``, ``/`` and ``^`` combine them. ``rad`` counts as 1, ``deg`` and ``rev`` do not.

    Refused::

        const angle = 0.5<rad> + 2<V>

    Mended::

        const angle = 0.5<rad> + 2<V> * 0.1<rad/V>
    """

    code = "E0305"
    title = "quantities of different units"

    operator: str
    left: Type
    right: Type
    left_span: Span
    right_span: Span
    number: Span | None = None

    @property
    def message(self) -> str:
        return f"`{self.operator}` stands between {noun(self.left)} and {noun(self.right)}"

    @property
    def help(self) -> str | None:
        if not isinstance(self.left, RealType) or not isinstance(self.right, RealType):
            return None
        if self.number is not None:
            unit = self.right.unit if self.number is self.left_span else self.left.unit
            return f"write the unit with the number: `{self.number.text}<{unit}>`"
        if self.left.unit.exponents != self.right.unit.exponents:
            return None
        if self.left.unit.factor == 1 or self.right.unit.factor != 1:
            return f"write `convert({_short(self.right_span)}, {self.left.unit})`"
        return f"write `convert({_short(self.left_span)}, {self.right.unit})`"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (
            Label(self.left_span, f"this is {noun(self.left)}"),
            Label(self.right_span, f"this is {noun(self.right)}"),
        )


def _short(span: Span) -> str:
    return span.text if len(span.text) <= 30 and "\n" not in span.text else "x"


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
class NotDimensionless(Diagnostic):
    """A function of pure numbers is given a quantity with a unit.

    Exponentials, logarithms and trigonometric functions are defined on numbers; an angle in radians is a number.

    Refused::

        const x = sin(30<deg>)

    Mended::

        const x = sin(convert(30<deg>, rad))
    """

    code = "E0307"
    title = "a quantity where a number is wanted"

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
            return f"write `convert({_short(self.span)}, {canonical(unit)})`"
        return f"divide by a quantity of the same unit, such as `1<{unit}>`"


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
            return f"compare it: `{_short(self.span)} != 0`"
        return None


@record
class UnknownUnit(Diagnostic):
    """The text between angle brackets is no unit.

    Units are SI symbols with prefixes (``m s kg A K mol cd rad Hz N Pa J W C V F Ohm S Wb T H l bar``), and ``deg rev rpm min h %``,
    combined by ``*``, ``/`` and ``^``.

    Refused::

        const torque = 0.5<Nm>

    Mended::

        const torque = 0.5<N*m>
    """

    code = "E0309"
    title = "an unknown unit"

    text: str
    suggestion: str | None

    @property
    def message(self) -> str:
        return f"`{self.text}` is no unit"

    @property
    def help(self) -> str:
        if self.suggestion:
            return f"did you mean `{self.suggestion}`?"
        return "combine SI units by `*`, `/` and `^`, such as `kg*m^2` or `rad/s`"


@record
class UnitNotAllowed(Diagnostic):
    """A unit is given to a type that cannot have one.

    Only ``double`` and ``float`` carry units: integers count, and a ``time`` is a number of nanoseconds.

    Refused::

        const n: int<V> = 0

    Mended::

        const n: double<V> = 0
    """

    code = "E0310"
    title = "a unit on a type without units"

    name: str
    stands_for: Type

    @property
    def message(self) -> str:
        return f"`{self.name}` cannot carry a unit"

    @property
    def help(self) -> str:
        if str(self.stands_for) != self.name:
            return f"`{self.name}` stands for {self.stands_for} already"
        return "only `double` and `float` carry units"


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
class BrokenPower(Diagnostic):
    """A quantity with a unit is raised to a power that is not fixed, or a root of its unit is none.

    The unit of ``x ^ n`` depends on ``n``, which therefore must be a number in the text; the square root of a metre is no unit.

    Refused::

        const x = sqrt(2<m>)

    Mended::

        const x = sqrt(2<m^2>)
    """

    code = "E0313"
    title = "a power of a unit that is no unit"

    found: Type
    operation: str

    @property
    def message(self) -> str:
        return f"{self.operation} of {noun(self.found)} has no unit"

    @property
    def help(self) -> str:
        return "make it a number first by dividing by a quantity of the same unit, or use a whole number as the power"


@record
class NotConvertible(Diagnostic):
    """``convert`` is asked for a unit of another dimension, or a conversion is given something that is no number.

    A conversion changes the scale or the representation of a quantity, but an angle never becomes a voltage. What relates two dimensions
    is a factor with a unit, such as ``2<V/rad>``.

    Refused::

        const x = convert(90<deg>, V)

    Mended::

        const x = convert(90<deg>, rad)
    """

    code = "E0314"
    title = "an impossible conversion"

    found: Type
    target: str

    @property
    def message(self) -> str:
        return f"{noun(self.found)} cannot be converted to {self.target}"


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
