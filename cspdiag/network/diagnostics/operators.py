"""What can be wrong with the operators of submodels, and with how they are discretized."""

from __future__ import annotations

from typing import ClassVar

from cspdiag.base import Diagnostic, Severity
from cspdiag.base.record import record


@record
class ImproperTransfer(Diagnostic):
    """The numerator of a transfer function has a higher degree than the denominator.

    Such an operator would need future samples: it contains a pure differentiator. Give it a pole that limits its bandwidth.

    Refused::

        submodel Lead {
          in  x : double
          out y : double

          y = transfer([0.1, 1], [1], x)
        }

    Mended::

        submodel Lead {
          in  x : double
          out y : double

          y = transfer([0.1, 1], [0.01, 1], x)
        }
    """

    code = "E0453"
    title = "an improper transfer function"

    numerator: int
    denominator: int

    @property
    def message(self) -> str:
        return (
            f"the numerator is of degree {self.numerator} and the denominator of degree {self.denominator}: "
            "a transfer function may not look into the future"
        )

    @property
    def help(self) -> str:
        return "add a fast pole to the denominator; coefficients go from the highest power of s down to the constant"


@record
class WrongShape(Diagnostic):
    """The coefficients of a transfer function or the matrices of a state space do not fit.

    ``transfer`` takes two lists, neither empty, the first coefficient of the denominator not zero. ``statespace`` takes A (nxn), B (nxm), C (pxn)
    and D (pxm), as lists of rows.

    Refused::

        submodel Plant {
          in  u : double
          out y : double

          y = statespace([[0, 1], [-4, -1]], [[0], [1], [2]], [[1, 0]], [[0]], u)
        }

    Mended::

        submodel Plant {
          in  u : double
          out y : double

          y = statespace([[0, 1], [-4, -1]], [[0], [1]], [[1, 0]], [[0]], u)
        }
    """

    code = "E0454"
    title = "coefficients that do not fit"

    problem: str

    @property
    def message(self) -> str:
        return self.problem


@record
class ValueOutOfRange(Diagnostic):
    """A time constant is not positive, or a delay is not a whole number of samples between 1 and 10000.

    A lag with a time constant of zero or below has no difference equation that means anything.

    Refused::

        submodel Smooth {
          in  x : double
          out y : double

          y = delay(x, 0, 0)
        }

    Mended::

        submodel Smooth {
          in  x : double
          out y : double

          y = delay(x, 3, 0)
        }
    """

    code = "E0455"
    title = "an argument out of range"

    problem: str

    @property
    def message(self) -> str:
        return self.problem


@record
class UnknownMethod(Diagnostic):
    """A method of integration or discretization that does not exist.

    Linear operators are discretized by ``tustin`` (the default), ``zoh``, ``euler`` or ``backward``; states with ``der`` are integrated by
    ``rk4`` (the default) or ``euler``.

    Refused::

        submodel Smooth method = trapezium {
          in  x : double
          out y : double

          y = lag(x, 10 ms)
        }

    Mended::

        submodel Smooth method = tustin {
          in  x : double
          out y : double

          y = lag(x, 10 ms)
        }
    """

    code = "E0456"
    title = "an unknown method"

    name: str

    @property
    def message(self) -> str:
        return f"there is no method `{self.name}`"

    @property
    def help(self) -> str:
        return "the methods are tustin, zoh, euler and backward, and rk4 for states with `der`"


@record
class UnstableDiscretization(Diagnostic):
    """A stable operator becomes unstable by its discretization.

    The forward Euler method puts a pole at s = -a to z = 1 - aT: beyond T = 2/a it leaves the unit circle, and the signal grows
    without bound. (Åström and Wittenmark, Computer-Controlled Systems, section 8.3.)

    Refused::

        submodel Smooth method = euler {
          in  x : double
          out y : double

          y = lag(x, 1 ms)
        }

        process Filter {
          in  x : double @ 10 ms
          out y : double @ 10 ms

          communication {
            smooth : Smooth
            x -> smooth.x
            smooth.y -> y
          }
          composition { mu smooth }
        }

    Mended::

        submodel Smooth method = tustin {
          in  x : double
          out y : double

          y = lag(x, 1 ms)
        }

        process Filter {
          in  x : double @ 10 ms
          out y : double @ 10 ms

          communication {
            smooth : Smooth
            x -> smooth.x
            smooth.y -> y
          }
          composition { mu smooth }
        }
    """

    code = "W0457"
    title = "an unstable discretization"
    severity: ClassVar[Severity] = "warning"

    sample: str
    radius: float

    @property
    def message(self) -> str:
        return f"this operator is stable, but discretized by euler at {self.sample} it has a pole at |z| = {self.radius:.3g}"

    @property
    def help(self) -> str:
        return "choose the method tustin or backward, or a shorter sample period"
