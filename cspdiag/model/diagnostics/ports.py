"""What can be wrong with ports, with the two ends of a relationship, and with what a composition reads and writes."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Label, Span
from cspdiag.base.record import record
from cspdiag.model.types import IntType, RealType, Type
from cspdiag.model.wording import noun


@record
class WrongSource(Diagnostic):
    """An arrow begins at something that gives no values.

    A source is an ``in`` port of this process (what comes from outside), an ``out`` port of an instance, a variable or a channel.

    Refused::

        submodel Law {
          in  x : int
          out y : int
          y = x
        }

        process Main {
          in  x : int
          out y : int
          communication {
            law : Law
            x     -> law.x
            y     -> law.y
          }
          composition { law }
        }

    Mended::

        submodel Law {
          in  x : int
          out y : int
          y = x
        }

        process Main {
          in  x : int
          out y : int
          communication {
            law : Law
            x     -> law.x
            law.y -> y
          }
          composition { law }
        }
    """

    code = "E0230"
    title = "an arrow that begins at a sink"

    name: str
    kind: str
    advice: str
    declared: Span | None

    @property
    def message(self) -> str:
        return f"`{self.name}` is {self.kind}, which is no source of values"

    @property
    def help(self) -> str:
        return self.advice

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, f"`{self.name}` is declared here"),) if self.declared else ()


@record
class WrongSink(Diagnostic):
    """An arrow ends at something that takes no values.

    A sink is an ``out`` port of this process (what goes outside), an ``in`` port of an instance, a variable, a channel, or ``_``.

    Refused::

        submodel Law {
          in  x : int
          out y : int
          y = x
        }

        process Main {
          in  x : int
          out y : int
          communication {
            law : Law
            x     -> law.x
            law.y -> x
          }
          composition { law }
        }

    Mended::

        submodel Law {
          in  x : int
          out y : int
          y = x
        }

        process Main {
          in  x : int
          out y : int
          communication {
            law : Law
            x     -> law.x
            law.y -> y
          }
          composition { law }
        }
    """

    code = "E0231"
    title = "an arrow that ends at a source"

    name: str
    kind: str
    advice: str
    declared: Span | None

    @property
    def message(self) -> str:
        return f"`{self.name}` is {self.kind}, which takes no values"

    @property
    def help(self) -> str:
        return self.advice

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, f"`{self.name}` is declared here"),) if self.declared else ()


@record
class NotReadable(Diagnostic):
    """A composition reads from something that cannot be read there.

    ``port ? x`` reads an ``in`` port of this process or a channel. What an instance writes goes to what it is connected to.

    Refused::

        process Main {
          out max : double
          communication { var x : double = 0 }
          composition { max ? x }
        }

    Mended::

        process Main {
          out max : double
          communication { var x : double = 0 }
          composition { max ! x }
        }
    """

    code = "E0232"
    title = "reading what cannot be read"

    name: str
    kind: str
    advice: str
    declared: Span | None

    @property
    def message(self) -> str:
        return f"`{self.name}` is {self.kind} and cannot be read here"

    @property
    def help(self) -> str:
        return self.advice

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, f"`{self.name}` is declared here"),) if self.declared else ()


@record
class NotWritable(Diagnostic):
    """A composition writes to something that cannot be written there.

    ``port ! e`` writes an ``out`` port of this process or a channel; ``x := e`` sets a variable.

    Refused::

        process Main {
          in  max : double
          composition { max ! 1 }
        }

    Mended::

        process Main {
          out max : double
          composition { max ! 1 }
        }
    """

    code = "E0233"
    title = "writing what cannot be written"

    name: str
    kind: str
    advice: str
    declared: Span | None

    @property
    def message(self) -> str:
        return f"`{self.name}` is {self.kind} and cannot be written here"

    @property
    def help(self) -> str:
        return self.advice

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, f"`{self.name}` is declared here"),) if self.declared else ()


@record
class NotVariable(Diagnostic):
    """A value is put into something that is no variable.

    What is read by ``?`` goes into a variable, and ``:=`` sets one: something declared by ``var``, or a label that ends an arrow.

    Refused::

        process Main {
          in  x : int
          out y : int
          composition { x ? y }
        }

    Mended::

        process Main {
          in  x : int
          out y : int
          communication { var value : int }
          composition { x ? value ; y ! value }
        }
    """

    code = "E0234"
    title = "no variable"

    name: str
    kind: str
    advice: str
    declared: Span | None

    @property
    def message(self) -> str:
        return f"`{self.name}` is {self.kind}, not a variable"

    @property
    def help(self) -> str:
        return self.advice

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, f"`{self.name}` is declared here"),) if self.declared else ()


@record
class DifferentEnds(Diagnostic):
    """The two ends of a communication have different types or units.

    A channel carries values as they are: nothing is converted on the way, not even an int to a double, a number to an angle, or degrees
    to radians. Give both ends one type, or put a submodel between them that converts.

    Refused::

        process Law {
          in  buttons : double
          out y       : int
          communication { var b : double }
          composition { buttons ? b ; y ! 1 }
        }

        process Main {
          in  buttons : int
          out y       : int
          communication {
            law : Law
            buttons -> law.buttons
            law.y   -> y
          }
          composition { law }
        }

    Mended::

        process Law {
          in  buttons : int
          out y       : int
          communication { var b : int }
          composition { buttons ? b ; y ! b }
        }

        process Main {
          in  buttons : int
          out y       : int
          communication {
            law : Law
            buttons -> law.buttons
            law.y   -> y
          }
          composition { law }
        }
    """

    code = "E0316"
    title = "two ends of different types"

    first: str
    first_type: Type
    second: str
    second_type: Type
    places: tuple[Label, ...]
    advice: str | None = None

    @property
    def message(self) -> str:
        return f"`{self.first}` carries {noun(self.first_type)}, but `{self.second}` {noun(self.second_type)}"

    @property
    def help(self) -> str:
        if self.advice is not None:
            return self.advice
        first, second = self.first_type, self.second_type
        if isinstance(first, RealType) and isinstance(second, RealType) and first.bits == second.bits:
            if first.unit.exponents == second.unit.exponents and first.unit.scale != second.unit.scale:
                return f"give both one unit, or put a submodel between them that computes `convert(x, {second.unit})`"
            return "give both the same unit"
        if isinstance(first, RealType | IntType) and isinstance(second, RealType | IntType):
            name = str(second) if isinstance(second, IntType) else "double" if second.bits == 64 else "float"
            return f"give both one type, or put a submodel between them that computes `{name}(x)`"
        return "give both the same type"

    @property
    def labels(self) -> tuple[Label, ...]:
        return self.places


@record
class MisplacedPortOption(Diagnostic):
    """A port has an option that belongs to the other direction.

    A default is what an input reads that is not connected; a safe value is what an output gets when the program ends; ``immediate``
    hands an output over at the write instead of at the tick.

    Refused::

        process Main {
          in  x : int safe 0
          out y : int
          communication { var v : int }
          composition { x ? v ; y ! v }
        }

    Mended::

        process Main {
          in  x : int
          out y : int safe 0
          communication { var v : int }
          composition { x ? v ; y ! v }
        }
    """

    code = "E0235"
    title = "a port option in the wrong place"

    option: str
    wanted: str

    @property
    def message(self) -> str:
        return f"{self.option} belongs to {self.wanted}"

    @property
    def help(self) -> str:
        return "remove it, or turn the port around"
