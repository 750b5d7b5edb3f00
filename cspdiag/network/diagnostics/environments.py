"""What can be wrong with an environment."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Label, Span
from cspdiag.base.record import record
from cspdiag.network.ir.network import Direction

_SHOWN = 5
"""How many of many names are told."""


def _listed(names: list[str]) -> str:
    """``a``, ``a and b``, ``a, b and c``, in backticks; the first of many, and how many more there are."""
    quoted = [f"`{name}`" for name in names[:_SHOWN]]
    if len(names) > _SHOWN:
        return f"{', '.join(quoted)} and {len(names) - _SHOWN} more"
    return quoted[0] if len(quoted) == 1 else f"{', '.join(quoted[:-1])} and {quoted[-1]}"


@record
class IncompleteEnvironment(Diagnostic):
    """An environment leaves ports of its process unconnected.

    The process would wait for samples that never come, or write to nowhere. An output that nobody needs goes to ``_``.

    Refused::

        process Blink {
          in  button : int
          out lamp   : bool @ 10 ms

          communication { var pressed : int = 0 }
          composition { mu (button ? pressed ; lamp ! pressed == 1) }
        }

        submodel Finger {
          out button : int
          button = if time < 1 s then 0 else 1
        }

        environment Bench for Blink {
          finger : Finger
          finger.button -> button
        }

    Mended::

        process Blink {
          in  button : int
          out lamp   : bool @ 10 ms

          communication { var pressed : int = 0 }
          composition { mu (button ? pressed ; lamp ! pressed == 1) }
        }

        submodel Finger {
          out button : int
          button = if time < 1 s then 0 else 1
        }

        environment Bench for Blink {
          finger : Finger
          finger.button -> button
          lamp          -> _
        }
    """

    code = "E0801"
    title = "an incomplete environment"

    environment: str
    process: str
    ports: tuple[tuple[str, Direction, Span], ...]

    @property
    def message(self) -> str:
        names = _listed([name for name, _, _ in self.ports])
        verb = "is" if len(self.ports) == 1 else "are"
        return f"{names} of the process `{self.process}` {verb} not connected in the environment `{self.environment}`"

    @property
    def help(self) -> str:
        lines = [f"{name} -> _" if direction == "out" else f"... -> {name}" for name, direction, _ in self.ports]
        return (
            "connect it: " + " or ".join(f"`{line}`" for line in lines) if len(lines) == 1 else "add " + _listed(lines)
        )

    @property
    def labels(self) -> tuple[Label, ...]:
        declared = {span: name.partition("[")[0] for name, _, span in self.ports}
        return tuple(Label(span, f"`{name}` is declared here") for span, name in declared.items())


@record
class UnconnectedInputs(Diagnostic):
    """A submodel or a driver of an environment has an input that nothing drives.

    Its equations would have no value to compute with. Connect the input, or give its port a default value.

    Refused::

        process Sink {
          in  x : double @ 10 ms
          communication { var last : double = 0 }
          composition { mu x ? last }
        }

        submodel Sum {
          in  a, b : double
          out y    : double
          y = a + b
        }

        submodel One {
          out y : double
          y = 1
        }

        environment Bench for Sink {
          one : One
          sum : Sum

          one.y -> sum.a
          sum.y -> x
        }

    Mended::

        process Sink {
          in  x : double @ 10 ms
          communication { var last : double = 0 }
          composition { mu x ? last }
        }

        submodel Sum {
          in  a, b : double
          out y    : double
          y = a + b
        }

        submodel One {
          out y : double
          y = 1
        }

        environment Bench for Sink {
          one : One
          sum : Sum

          one.y -> sum.a, sum.b
          sum.y -> x
        }
    """

    code = "E0802"
    title = "an input of the environment that nothing drives"

    member: str
    ports: tuple[tuple[str, Span], ...]

    @property
    def message(self) -> str:
        return f"nothing drives {_listed([f'{self.member}.{name}' for name, _ in self.ports])}"

    @property
    def help(self) -> str:
        return f"connect it, `... -> {self.member}.{self.ports[0][0]}`, or give the port a default value"

    @property
    def labels(self) -> tuple[Label, ...]:
        declared = {span: name.partition("[")[0] for name, span in self.ports}
        return tuple(Label(span, f"`{name}` is declared here") for span, name in declared.items())


@record
class StepNotPositive(Diagnostic):
    """The step of an environment is zero or negative.

    ``step`` is the grid on which the environment is evaluated besides the sample instants.

    Refused::

        process Constant {
          out voltage : double<V> @ 10 ms
          composition { mu (voltage ! 1<V> ; wait 10 ms) }
        }

        environment Bench for Constant step 0 ms {
          voltage -> _
        }

    Mended::

        process Constant {
          out voltage : double<V> @ 10 ms
          composition { mu (voltage ! 1<V> ; wait 10 ms) }
        }

        environment Bench for Constant step 1 ms {
          voltage -> _
        }
    """

    code = "E0808"
    title = "a step that is not positive"

    @property
    def message(self) -> str:
        return "the step of an environment must be positive"


@record
class UnknownMissPolicy(Diagnostic):
    """``on miss`` names something that cannot be done about a missed sample.

    A sample that was not taken before the next one came is a missed deadline: ``timeout`` raises ``Timeout`` in the reader (the default), ``count`` counts
    and goes on.

    Refused::

        process Constant {
          out voltage : double<V> @ 10 ms
          composition { mu (voltage ! 1<V> ; wait 10 ms) }
        }

        environment Bench for Constant on miss ignore {
          voltage -> _
        }

    Mended::

        process Constant {
          out voltage : double<V> @ 10 ms
          composition { mu (voltage ! 1<V> ; wait 10 ms) }
        }

        environment Bench for Constant on miss count {
          voltage -> _
        }
    """

    code = "E0809"
    title = "an unknown answer to a missed sample"

    name: str

    @property
    def message(self) -> str:
        return f"a missed sample cannot be answered by `{self.name}`"

    @property
    def help(self) -> str:
        return "write `on miss timeout` or `on miss count`"
