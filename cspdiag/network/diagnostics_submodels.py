"""What can be wrong with the equations of a submodel once they are put together."""

from __future__ import annotations

from typing import ClassVar

from cspdiag.diagnostics import Diagnostic, Label, Severity, Span
from cspdiag.diagnostics.record import record


@record
class AlgebraicLoop(Diagnostic):
    """Some signals of a submodel depend on themselves within one sample.

    The equations of a submodel are evaluated one after another, each after those that it reads. For signals that need
    each other at the same instant there is no such order. A value of the sample before, a state or an operator without direct
    feedthrough breaks the loop. (Cellier and Kofman, Continuous System Simulation, section 7.2.)

    Refused::

        submodel Speed(gain: double) {
          in  setpoint : double
          out control  : double

          let error = setpoint - control
          control = gain * error
        }

    Mended::

        submodel Speed(gain: double) {
          in  setpoint : double
          out control  : double

          let error = setpoint - pre(control, 0)
          control = gain * error
        }
    """

    code = "E0450"
    title = "an algebraic loop"

    loop: tuple[tuple[str, Span], ...]
    """Name and place of each equation, each reading the next and the last the first."""
    in_environment: bool = False

    @property
    def message(self) -> str:
        if len(self.loop) == 1:
            return f"`{self.loop[0][0]}` depends on itself within one sample"
        names = [name for name, _ in self.loop]
        return "these equations need each other within one sample: " + " ← ".join([*names, names[0]])

    @property
    def label(self) -> str:
        return f"reads `{self.loop[1 % len(self.loop)][0]}`"

    @property
    def labels(self) -> tuple[Label, ...]:
        following = [*self.loop[1:], self.loop[0]]
        pairs = list(zip(self.loop, following, strict=True))[1:]
        return tuple(Label(span, f"`{name}` reads `{other}`") for (name, span), (other, _) in pairs)

    @property
    def help(self) -> str:
        if self.in_environment:
            return (
                "let one of these submodels put out its value of the sample before, `pre(x, 0)`, or keep it in a state"
            )
        names = [name for name, _ in self.loop]
        name = min(reversed(names), key=lambda name: (name.count("."), not name.replace(".", "").isidentifier()))
        return f"take one of them from the sample before, for example `pre({name}, 0)`, or make it a state"


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


@record
class TimeOutsideEnvironment(Diagnostic):
    """A submodel that runs in a process reads the time.

    A control law knows its sample period, ``sample``, but not the present instant: so it behaves the same whenever it starts. Only the submodels of
    environments see ``time``.

    Refused::

        submodel Ramp {
          out y : double

          y = 1<1/s> * time
        }

        process Source {
          out y : double @ 10 ms

          communication {
            ramp : Ramp
            ramp.y -> y
          }
          composition { mu (ramp ; wait 10 ms) }
        }

    Mended::

        submodel Ramp {
          out y : double

          state count : double = 0
          y = count
          next count = count + sample / 1<s>
        }

        process Source {
          out y : double @ 10 ms

          communication {
            ramp : Ramp
            ramp.y -> y
          }
          composition { mu (ramp ; wait 10 ms) }
        }
    """

    code = "E0458"
    title = "time outside an environment"

    submodel: str

    @property
    def message(self) -> str:
        return f"the submodel `{self.submodel}` runs in a process, where there is no `time`"

    @property
    def help(self) -> str:
        return "count samples in a state: `next t = t + sample`"


@record
class StepNotPositive(Diagnostic):
    """The step of an integration is zero or negative.

    ``step`` is the longest sub-step in which the states with ``der`` are integrated over a sample.

    Refused::

        submodel Wheel step 0 ms {
          in  a : double
          out v : double

          state speed : double = 0
          der speed = a
          v = speed
        }

    Mended::

        submodel Wheel step 1 ms {
          in  a : double
          out v : double

          state speed : double = 0
          der speed = a
          v = speed
        }
    """

    code = "E0459"
    title = "a step that is not positive"

    @property
    def message(self) -> str:
        return "the step of an integration must be positive"


@record
class TooManyEquations(Diagnostic):
    """Nested submodels unfold to more equations than can be handled.

    Every instance of a submodel brings its own equations, so that nested in several levels they multiply. One outermost submodel or
    environment may have 20 000.

    Refused::

        submodel Cell {
          out y : double
          y = 1
        }

        submodel Row {
          out y : double
          cell[150] : Cell
          y = cell[0].y
        }

        submodel Field {
          out y : double
          row[150] : Row
          y = row[0].y
        }

    Mended::

        submodel Cell {
          out y : double
          y = 1
        }

        submodel Row {
          out y : double
          cell[150] : Cell
          y = cell[0].y
        }

        submodel Field {
          out y : double
          row[15] : Row
          y = row[0].y
        }
    """

    code = "E0461"
    title = "too many equations"

    submodel: str
    limit: int

    @property
    def message(self) -> str:
        return f"the submodels nested in `{self.submodel}` have more than {self.limit} equations in all"

    @property
    def help(self) -> str:
        return "compute them in a body in another language, or divide them over several submodels of a process"
