"""What can be wrong with the arguments of an instance, a struct or a function."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Label, Span
from cspdiag.base.record import record


def _at(declared: Span | None, text: str) -> tuple[Label, ...]:
    return (Label(declared, text),) if declared else ()


@record
class MissingArgument(Diagnostic):
    """A parameter without a default was given no value.

    Parameters are constants of the drawn-out diagram. One that has no default is different for every instance, and nobody can guess it.

    Refused::

        process Sender(value: int) {
          out y : int
          composition { y ! value }
        }

        process Main {
          out y : int
          communication {
            sender : Sender
            sender.y -> y
          }
          composition { sender }
        }

    Mended::

        process Sender(value: int) {
          out y : int
          composition { y ! value }
        }

        process Main {
          out y : int
          communication {
            sender : Sender(value = 1)
            sender.y -> y
          }
          composition { sender }
        }
    """

    code = "E0211"
    title = "a missing argument"

    owner: str
    names: tuple[str, ...]
    example: str | None
    declared: Span | None

    @property
    def message(self) -> str:
        shown = ", ".join(f"`{name}`" for name in self.names)
        return f"`{self.owner}` needs a value for {shown}"

    @property
    def help(self) -> str | None:
        return f"write `{self.example}`" if self.example else None

    @property
    def labels(self) -> tuple[Label, ...]:
        return _at(self.declared, f"`{self.owner}` is defined here")


@record
class UnknownArgument(Diagnostic):
    """An argument is given by a name that is not among the parameters.

    Each argument belongs to a parameter of the definition, or to a field of the struct; a value without a receiver is a slip.

    Refused::

        struct Pose { x: double<m> }
        const origin = Pose(y = 0)

    Mended::

        struct Pose { x: double<m> }
        const origin = Pose(x = 0)
    """

    code = "E0212"
    title = "an unknown argument"

    owner: str
    name: str
    options: tuple[str, ...]
    suggestion: str | None
    declared: Span | None

    @property
    def message(self) -> str:
        return f"`{self.owner}` has no parameter `{self.name}`"

    @property
    def help(self) -> str:
        if self.suggestion:
            return f"did you mean `{self.suggestion}`?"
        if not self.options:
            return f"`{self.owner}` has no parameters"
        return "it has " + ", ".join(f"`{option}`" for option in self.options)

    @property
    def labels(self) -> tuple[Label, ...]:
        return _at(self.declared, f"`{self.owner}` is defined here")


@record
class RepeatedArgument(Diagnostic):
    """A parameter is given two values.

    An argument by position takes the parameters from the left; one by name may then only name those that are left.

    Refused::

        struct Pose { x: double }
        const origin = Pose(0, x = 1)

    Mended::

        struct Pose { x: double }
        const origin = Pose(x = 1)
    """

    code = "E0213"
    title = "an argument given twice"

    name: str
    first: Span

    @property
    def message(self) -> str:
        return f"`{self.name}` is given a value twice"

    @property
    def help(self) -> str:
        return "leave one of them out"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.first, f"the first value of `{self.name}`"),)


@record
class TooManyArguments(Diagnostic):
    """More arguments are given than there are parameters.

    Arguments by position take the parameters from the left, and each parameter takes one.

    Refused::

        struct Pose { x: double }
        const origin = Pose(0, 1)

    Mended::

        struct Pose { x: double }
        const origin = Pose(0)
    """

    code = "E0214"
    title = "too many arguments"

    owner: str
    given: int
    allowed: int
    declared: Span | None

    @property
    def message(self) -> str:
        taken = {0: "no arguments", 1: "one argument"}.get(self.allowed, f"{self.allowed} arguments")
        return f"`{self.owner}` takes {taken}, but {self.given} are given"

    @property
    def help(self) -> str:
        return (
            f"remove the last {self.given - self.allowed}" if self.given - self.allowed > 1 else "remove the last one"
        )

    @property
    def labels(self) -> tuple[Label, ...]:
        return _at(self.declared, f"`{self.owner}` is defined here")


@record
class PositionalAfterNamed(Diagnostic):
    """An argument without a name follows one with a name.

    Arguments are positional first, then by name: after a name the position no longer tells which parameter is meant.

    Refused::

        struct Pose { x: double  y: double }
        const origin = Pose(x = 0, 1)

    Mended::

        struct Pose { x: double  y: double }
        const origin = Pose(x = 0, y = 1)
    """

    code = "E0215"
    title = "a positional argument after a named one"

    names: tuple[str, ...]

    @property
    def message(self) -> str:
        return "an argument by position cannot follow one by name"

    @property
    def help(self) -> str:
        if not self.names:
            return "give it by name"
        return f"give it by name: `{self.names[0]} = ...`"


@record
class WrongNumberOfArguments(Diagnostic):
    """A function is given too few or too many arguments.

    The functions of the language take their arguments by position; only linear operators have an option, ``method``.

    Refused::

        const x = limit(3, 1)

    Mended::

        const x = limit(3, 1, 2)
    """

    code = "E0216"
    title = "the wrong number of arguments"

    function: str
    given: int
    signature: str

    @property
    def message(self) -> str:
        given = {0: "no arguments", 1: "one argument"}.get(self.given, f"{self.given} arguments")
        return f"`{self.function}` cannot be given {given}"

    @property
    def help(self) -> str:
        return f"write `{self.signature}`"


@record
class UnknownOption(Diagnostic):
    """A function has no option of this name, or the option has no such value.

    Linear operators take ``method = tustin``, ``zoh``, ``euler`` or ``backward``; a submodel is integrated by ``method = euler`` or
    ``rk4``.

    Refused::

        submodel Law {
          in  x : double
          out y : double
          y = lag(x, 1<s>, method = bilinear)
        }

    Mended::

        submodel Law {
          in  x : double
          out y : double
          y = lag(x, 1<s>, method = tustin)
        }
    """

    code = "E0217"
    title = "an unknown option"

    owner: str
    option: str
    options: tuple[str, ...]
    suggestion: str | None

    @property
    def message(self) -> str:
        return f"{self.owner} cannot be `{self.option}`"

    @property
    def help(self) -> str:
        if self.suggestion:
            return f"did you mean `{self.suggestion}`?"
        return "choose among " + ", ".join(f"`{option}`" for option in self.options)
