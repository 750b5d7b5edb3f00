"""What can be wrong with the equations of a submodel once they are put together."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Label, Span
from cspdiag.base.record import record


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
