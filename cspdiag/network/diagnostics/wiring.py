"""What can be wrong with the connections of an environment."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Label, Span
from cspdiag.base.record import record
from cspdiag.network.ir.network import Direction


@record
class WrongDirection(Diagnostic):
    """A relationship of an environment goes against the direction of a port.

    An environment sees the process from outside: outputs of the process are sources, its inputs are sinks. Submodels and drivers give at their
    outputs and take at their inputs.

    Refused::

        process Sink {
          in  x : double @ 10 ms
          communication { var last : double = 0 }
          composition { mu x ? last }
        }

        submodel One {
          out y : double
          y = 1
        }

        environment Bench for Sink {
          one : One
          x -> one.y
        }

    Mended::

        process Sink {
          in  x : double @ 10 ms
          communication { var last : double = 0 }
          composition { mu x ? last }
        }

        submodel One {
          out y : double
          y = 1
        }

        environment Bench for Sink {
          one : One
          one.y -> x
        }
    """

    code = "E0803"
    title = "a relationship against the direction of a port"

    reference: str
    direction: Direction
    is_member: bool
    declared: Span

    @property
    def message(self) -> str:
        owner = "" if self.is_member else " of the process"
        role = "source" if self.direction == "in" else "sink"
        return f"`{self.reference}` is an {self.direction} port{owner} and cannot be a {role} in the environment"

    @property
    def help(self) -> str:
        return "turn the arrow round"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, f"declared as `{self.direction}` here"),)


@record
class TwoSources(Diagnostic):
    """Two relationships of an environment drive the same port.

    A port of the plant or an input of the process has one value at an instant, from one source.

    Refused::

        process Sink {
          in  x : double @ 10 ms
          communication { var last : double = 0 }
          composition { mu x ? last }
        }

        submodel One {
          out y : double
          y = 1
        }

        environment Bench for Sink {
          first  : One
          second : One
          first.y  -> x
          second.y -> x
        }

    Mended::

        process Sink {
          in  x : double @ 10 ms
          communication { var last : double = 0 }
          composition { mu x ? last }
        }

        submodel One {
          out y : double
          y = 1
        }

        environment Bench for Sink {
          first : One
          first.y -> x
        }
    """

    code = "E0804"
    title = "two sources for one port"

    sink: str
    first: str
    second: str
    first_span: Span

    @property
    def message(self) -> str:
        return f"`{self.sink}` is driven by both `{self.first}` and `{self.second}`"

    @property
    def help(self) -> str:
        return "keep one of them, or combine them in a submodel"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.first_span, f"driven by `{self.first}` here"),)


@record
class DriverToSubmodel(Diagnostic):
    """A driver and a submodel of an environment are connected to each other.

    Drivers belong to ports of the process: they are read and written when the process communicates. The simulated plant sees what passes
    those ports.

    Refused::

        driver Stick python "stick.py:Stick" {
          out x : double
        }

        process Follow {
          in  angle : double @ 10 ms
          communication { var last : double = 0 }
          composition { mu angle ? last }
        }

        submodel Arm {
          in  force : double
          out angle : double
          angle = 2 * force
        }

        environment Bench for Follow {
          stick : Stick
          arm   : Arm
          stick.x   -> arm.force
          arm.angle -> angle
        }

    Mended::

        driver Stick python "stick.py:Stick" {
          out x : double
        }

        process Follow {
          in  angle : double @ 10 ms
          communication { var last : double = 0 }
          composition { mu angle ? last }
        }

        environment Bench for Follow {
          stick : Stick
          stick.x -> angle
        }
    """

    code = "E0805"
    title = "a driver connected to a submodel"

    driver: str
    source: str
    sink: str

    @property
    def message(self) -> str:
        return f"the driver `{self.driver}` is connected to a submodel: `{self.source} -> {self.sink}`"

    @property
    def help(self) -> str:
        return "connect drivers to ports of the process"


@record
class SharedPort(Diagnostic):
    """A port of the process is connected both to the simulated system and to a driver, or to two drivers.

    Each port of the process has one counterpart that takes or gives its values.

    Refused::

        driver Amplifier python "amplifier.py:Amplifier" {
          in voltage : double<V>
        }

        process Constant {
          out voltage : double<V> @ 10 ms
          composition { mu (voltage ! 1<V> ; wait 10 ms) }
        }

        environment Bench for Constant {
          left  : Amplifier
          right : Amplifier
          voltage -> left.voltage, right.voltage
        }

    Mended::

        driver Amplifier python "amplifier.py:Amplifier" {
          in voltage : double<V>
        }

        process Constant {
          out voltage : double<V> @ 10 ms
          composition { mu (voltage ! 1<V> ; wait 10 ms) }
        }

        environment Bench for Constant {
          left : Amplifier
          voltage -> left.voltage
        }
    """

    code = "E0806"
    title = "a port with two counterparts"

    port: str
    first: str
    second: str
    first_span: Span

    @property
    def message(self) -> str:
        owners = [f"the driver `{name}`" if name else "the simulated system" for name in (self.first, self.second)]
        return f"`{self.port}` of the process is connected to both {owners[0]} and {owners[1]}"

    @property
    def help(self) -> str:
        return "write an environment for each, or one driver that does both"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.first_span, "the other relationship"),)


@record
class NotInEnvironment(Diagnostic):
    """An environment declares something that only processes have.

    Variables, channels, labels at the end of an arrow and kinds of channels belong to the communication diagram of a process. In an environment
    relationships are signals: a sink always has the present value of its source.

    Refused::

        process Sink {
          in  x : double @ 10 ms
          communication { var last : double = 0 }
          composition { mu x ? last }
        }

        submodel One {
          out y : double
          y = 1
        }

        environment Bench for Sink {
          one : One
          var scale : double = 2
          one.y -> x
        }

    Mended::

        process Sink {
          in  x : double @ 10 ms
          communication { var last : double = 0 }
          composition { mu x ? last }
        }

        submodel One {
          out y : double
          y = 1
        }

        environment Bench for Sink {
          one : One
          one.y -> x
        }
    """

    code = "E0807"
    title = "not in an environment"

    what: str

    @property
    def message(self) -> str:
        return f"an environment has no place for {self.what}"

    @property
    def help(self) -> str:
        return "compute in submodels, and connect their ports"
