"""What can be wrong with the operators of submodels, and with how they are discretized."""

from __future__ import annotations

from typing import ClassVar

from cspdiag.base import Diagnostic, Edit, Severity
from cspdiag.base.edits import slip
from cspdiag.base.record import record

_METHODS = ("tustin", "zoh", "euler", "backward", "rk4")


@record
class ImproperTransfer(Diagnostic):
    code = "E0453"
    title = "an improper transfer function"
    help = "add a fast pole to the denominator; coefficients go from the highest power of s down to the constant"

    numerator: int
    denominator: int

    @property
    def message(self) -> str:
        return (
            f"the numerator is of degree {self.numerator} and the denominator of degree {self.denominator}: "
            "a transfer function may not look into the future"
        )


@record
class WrongShape(Diagnostic):
    code = "E0454"
    title = "coefficients that do not fit"

    problem: str

    @property
    def message(self) -> str:
        return self.problem


@record
class ValueOutOfRange(Diagnostic):
    code = "E0455"
    title = "an argument out of range"

    problem: str

    @property
    def message(self) -> str:
        return self.problem


@record
class UnknownMethod(Diagnostic):
    code = "E0456"
    title = "an unknown method"
    help = "the methods are tustin, zoh, euler and backward, and rk4 for states with `der`"

    name: str

    @property
    def message(self) -> str:
        return f"there is no method `{self.name}`"

    @property
    def edits(self) -> tuple[Edit, ...]:
        return tuple(edit for method in _METHODS for edit in slip(self.span, self.name, method))


@record
class UnstableDiscretization(Diagnostic):
    code = "W0457"
    title = "an unstable discretization"
    help = "choose the method tustin or backward, or a shorter sample period"
    severity: ClassVar[Severity] = "warning"

    sample: str
    radius: float

    @property
    def message(self) -> str:
        return (
            f"this operator is stable, but discretized by euler at {self.sample} it has a pole at |z| = "
            f"{self.radius:.3g}"
        )


@record
class NotDiscretized(Diagnostic):
    code = "E0462"
    title = "an operator whose discretization needs numpy"

    operator: str
    method: str
    package: str

    @property
    def message(self) -> str:
        return (
            f"discretizing `{self.operator}` by {self.method} needs the package {self.package}, which is not there, as "
            "in a browser"
        )

    @property
    def help(self) -> str:
        simple = "choose the method tustin or backward" if self.operator == "transfer" else "write it with `transfer`"
        return f"{simple}, which needs no package, or use cspdiag on a machine (`pip install cspdiag`)"
