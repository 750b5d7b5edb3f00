"""What can be wrong with the equations of a submodel."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Label, Span
from cspdiag.base.record import record


@record
class MissingEquation(Diagnostic):
    """An output of a submodel has no equation.

    A submodel writes all its outputs each time it runs, so that each needs exactly one equation.

    Refused::

        submodel Law {
          in  x : double
          out y, z : double
          y = 2 * x
        }

    Mended::

        submodel Law {
          in  x : double
          out y, z : double
          y = 2 * x
          z = -x
        }
    """

    code = "E0401"
    title = "an output without an equation"

    name: str
    owner: str

    @property
    def message(self) -> str:
        return f"the output `{self.name}` of `{self.owner}` has no equation"

    @property
    def help(self) -> str:
        return f"write `{self.name} = ...`"


@record
class RepeatedEquation(Diagnostic):
    """Two equations give one thing a value.

    Equations hold at the same time and in any order, so that each name has exactly one.

    Refused::

        submodel Law {
          in  x : double
          out y : double
          y = 2 * x
          y = 3 * x
        }

    Mended::

        submodel Law {
          in  x : double
          out y : double
          y = 2 * x + 3 * x
        }
    """

    code = "E0402"
    title = "two equations for one name"

    name: str
    first: Span

    @property
    def message(self) -> str:
        return f"`{self.name}` has two equations"

    @property
    def help(self) -> str:
        return "keep one of them, or choose by `if condition then a else b`"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.first, "the first one"),)


@record
class EquationForInput(Diagnostic):
    """An equation gives a value to something that gets its value elsewhere.

    Inputs come from outside, and outputs of an inner submodel from its own equations. Equations are for outputs, for local values
    (``let``) and for inputs of inner submodels.

    Refused::

        submodel Law {
          in  x : double
          out y : double
          x = 1
          y = x
        }

    Mended::

        submodel Law {
          in  x : double
          out y : double
          let z = x + 1
          y = z
        }
    """

    code = "E0403"
    title = "an equation for an input"

    name: str
    kind: str
    advice: str
    declared: Span | None

    @property
    def message(self) -> str:
        return f"`{self.name}` is {self.kind} and cannot be given a value here"

    @property
    def help(self) -> str:
        return self.advice

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, f"`{self.name}` is declared here"),) if self.declared else ()


@record
class StateWithoutLaw(Diagnostic):
    """A state has neither a next value nor a derivative.

    ``next s = e`` says what the state is at the next sample, ``der s = e`` how fast it changes. A state without either never changes
    and is a parameter.

    Refused::

        submodel Law {
          in  x : double
          out y : double
          state s : double = 0
          y = x + s
        }

    Mended::

        submodel Law {
          in  x : double
          out y : double
          state s : double = 0
          y = x + s
          next s = x
        }
    """

    code = "E0404"
    title = "a state that never changes"

    name: str

    @property
    def message(self) -> str:
        return f"the state `{self.name}` has neither a next value nor a derivative"

    @property
    def help(self) -> str:
        return f"write `next {self.name} = ...` (discrete) or `der {self.name} = ...` (continuous)"


@record
class StateWithTwoLaws(Diagnostic):
    """A state has two laws: two next values, two derivatives, or one of each.

    A state is either discrete or continuous, and has one law.

    Refused::

        submodel Law {
          in  x : double
          out y : double
          state s : double = 0
          y = s
          next s = x
          der s = x
        }

    Mended::

        submodel Law {
          in  x : double
          out y : double
          state s : double = 0
          y = s
          next s = x
        }
    """

    code = "E0405"
    title = "a state with two laws"

    name: str
    second: str
    first: Span
    first_law: str

    @property
    def message(self) -> str:
        second = "a second one" if self.second == self.first_law else f"{self.second} as well"
        return f"the state `{self.name}` already has {self.first_law}; it cannot have {second}"

    @property
    def help(self) -> str:
        return "keep one of them"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.first, f"{self.first_law} is given here"),)


@record
class UnconnectedInput(Diagnostic):
    """An input of an inner submodel has no equation.

    A submodel reads all its inputs each time it runs. One that has a default may be left out.

    Refused::

        submodel Gain {
          in  x : double
          out y : double
          y = 2 * x
        }

        submodel Law {
          in  x : double
          out y : double
          gain : Gain
          y = gain.y + x
        }

    Mended::

        submodel Gain {
          in  x : double
          out y : double
          y = 2 * x
        }

        submodel Law {
          in  x : double
          out y : double
          gain : Gain
          gain.x = x
          y = gain.y + x
        }
    """

    code = "E0406"
    title = "an inner submodel without an input"

    names: tuple[str, ...]
    instance: str
    declared: Span | None

    @property
    def message(self) -> str:
        shown = ", ".join(f"`{self.instance}.{name}`" for name in self.names)
        plural = "inputs" if len(self.names) > 1 else "input"
        return f"the {plural} {shown} of the inner submodel {'have' if len(self.names) > 1 else 'has'} no equation"

    @property
    def help(self) -> str:
        return f"write `{self.instance}.{self.names[0]} = ...`"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, "the input is declared here"),) if self.declared else ()


@record
class NotContinuous(Diagnostic):
    """A state that is no real number has a derivative.

    Only quantities of type double or float change continuously; others have a next value.

    Refused::

        submodel Law {
          in  x : int
          out y : int
          state s : int = 0
          y = s
          der s = x
        }

    Mended::

        submodel Law {
          in  x : int
          out y : int
          state s : int = 0
          y = s
          next s = x
        }
    """

    code = "E0407"
    title = "a derivative of a discrete value"

    name: str
    type: str
    declared: Span

    @property
    def message(self) -> str:
        return f"the state `{self.name}` is of type {self.type} and has no derivative"

    @property
    def help(self) -> str:
        return f"write `next {self.name} = ...`, or declare the state as a double"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, "the state is declared here"),)
