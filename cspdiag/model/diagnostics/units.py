"""What can be wrong with units and scales."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Label, Span
from cspdiag.base.record import record
from cspdiag.model.types import RealType, Type
from cspdiag.model.units import canonical
from cspdiag.model.wording import conversion_help, noun, shortened


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
            return f"write `convert({shortened(self.right_span)}, {self.left.unit})`"
        return f"write `convert({shortened(self.left_span)}, {self.right.unit})`"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (
            Label(self.left_span, f"this is {noun(self.left)}"),
            Label(self.right_span, f"this is {noun(self.right)}"),
        )


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
            return f"write `convert({shortened(self.span)}, {canonical(unit)})`"
        return f"divide by a quantity of the same unit, such as `1<{unit}>`"


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
