"""Ports and relationships that do not fit together."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Label, Span
from cspdiag.base.record import record


@record
class NotConnected(Diagnostic):
    """A port of an instance is connected to nothing.

    A process that reads an unconnected input would wait for ever, and what it writes to an unconnected output would be lost
    without anybody having said so. An input may be left alone where its declaration gives a default; an output
    that nobody needs is connected to `_`.

    Refused::

        process Sender {
          out output : int
          composition { mu output ! 1 }
        }

        process Receiver {
          in input : int
          communication { var last : int = 0 }
          composition { mu input ? last }
        }

        process Main {
          communication {
            sender   : Sender
            receiver : Receiver
          }
          composition { sender || receiver }
        }

    Mended::

        process Sender {
          out output : int
          composition { mu output ! 1 }
        }

        process Receiver {
          in input : int
          communication { var last : int = 0 }
          composition { mu input ? last }
        }

        process Main {
          communication {
            sender   : Sender
            receiver : Receiver
            sender.output -> receiver.input
          }
          composition { sender || receiver }
        }
    """

    code = "E0501"
    title = "port that is not connected"

    instance: str
    definition: str
    ports: tuple[str, ...]
    direction: str
    declared: Span

    @property
    def message(self) -> str:
        ports = " and ".join(f"`{port}`" for port in self.ports[:3])
        more = f" and {len(self.ports) - 3} more" if len(self.ports) > 3 else ""
        plural = "s" if len(self.ports) > 1 else ""
        return f"port{plural} {ports}{more} of `{self.instance}` {'are' if plural else 'is'} not connected"

    @property
    def help(self) -> str | None:
        port = f"{self.instance}.{self.ports[0]}"
        if self.direction == "in":
            return f"connect it (`... -> {port}`), or give the port a default in `{self.definition}`"
        return f"connect it, or throw the values away with `{port} -> _`"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, f"the port `{self.ports[0]}` is declared here"),)


@record
class ConnectedTwice(Diagnostic):
    """A port of an instance has two relationships.

    An arrow of the communication diagram is one communication object. An input that hung on two of them could not tell which one to
    read, and an output on two of them which one to write. Several sources, or several sinks, stand on one arrow; the composition
    then decides what kind of channel that is.

    Refused::

        process Sender {
          out output : int
          composition { mu output ! 1 }
        }

        process Receiver {
          in input : int
          communication { var last : int = 0 }
          composition { mu input ? last }
        }

        process Main {
          communication {
            one      : Sender
            other    : Sender
            receiver : Receiver
            one.output   -> receiver.input
            other.output -> receiver.input
          }
          composition { one || other || receiver }
        }

    Mended::

        process Sender {
          out output : int
          composition { mu output ! 1 }
        }

        process Receiver {
          in input : int
          communication { var last : int = 0 }
          composition { mu input ? last }
        }

        process Main {
          communication {
            one      : Sender
            other    : Sender
            receiver : Receiver
            one.output, other.output -> any -> receiver.input
          }
          composition { one || other || receiver }
        }
    """

    code = "E0502"
    title = "port connected twice"

    port: str
    direction: str
    first: Span

    @property
    def message(self) -> str:
        again = "again in each step of `for`" if self._repeated else "twice"
        return f"`{self.port}` is connected {again}"

    @property
    def _repeated(self) -> bool:
        return self.first == self.span

    @property
    def help(self) -> str | None:
        if self._repeated and self.direction == "in":
            return f"list all sources before one arrow, without `for`: `a[0].port, a[1].port -> {self.port}`"
        if self._repeated:
            return f"list all readers after one arrow, without `for`: `{self.port} -> a[0].port, a[1].port`"
        if self.direction == "in":
            return "an input has one relationship: leave one away, or list both sources before one arrow"
        return "an output has one relationship: list all its readers after one arrow"

    @property
    def labels(self) -> tuple[Label, ...]:
        return () if self._repeated else (Label(self.first, "connected here first"),)


@record
class PortToPort(Diagnostic):
    """A port of the process is connected straight to another port of it.

    A relationship hands a port on to an instance inside. Between two ports of one process there is no instance that would
    carry a value from one to the other, nor a place in the composition that says when.

    Refused::

        process Main {
          in  input  : int
          out output : int
          communication { input -> output }
          composition { skip }
        }

    Mended::

        process Main {
          in  input  : int
          out output : int
          communication { var value : int = 0 }
          composition { mu (input ? value ; output ! value) }
        }
    """

    code = "E0507"
    title = "port connected straight to a port"

    source: str
    sink: str
    first: Span

    @property
    def message(self) -> str:
        return f"no process is between the ports `{self.source}` and `{self.sink}`: nobody would carry the values"

    @property
    def help(self) -> str | None:
        return "put an instance between them, or connect the two where this process is used"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.first, "the other port"),)


@record
class JoinsTwoObjects(Diagnostic):
    """One relationship joins two communication objects.

    Ports of the process, channels and variables are communication objects of their own. Instances are attached to one of them at each
    arrow; an arrow cannot make one object of two.

    Refused::

        process Receiver {
          in input : int
          communication { var last : int = 0 }
          composition { mu input ? last }
        }

        process Main {
          in one, other : int
          communication {
            receiver : Receiver
            one, other -> receiver.input
          }
          composition { receiver }
        }

    Mended::

        process Receiver {
          in input : int
          communication { var last : int = 0 }
          composition { mu input ? last }
        }

        process Main {
          in one, other : int
          communication {
            first  : Receiver
            second : Receiver
            one    -> first.input
            other  -> second.input
          }
          composition { first || second }
        }
    """

    code = "E0508"
    title = "relationship with two communication objects"

    one: str
    other: str
    first: Span

    @property
    def message(self) -> str:
        return f"one relationship cannot join `{self.one}` and `{self.other}`: each is a channel of its own"

    @property
    def help(self) -> str | None:
        return "give the instance a port for each, or copy the values in a process between them"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.first, f"`{self.one}` here"),)


@record
class PortEndsInLabel(Diagnostic):
    """An input of the process ends in a label.

    A label that ends an arrow is a variable that an instance writes. Nothing writes the values of a port into it: that is a
    communication, and the composition says when it takes place.

    Refused::

        process Main {
          in input : int
          communication { input -> value : int }
          composition { mu skip until value == 1 }
        }

    Mended::

        process Main {
          in input : int
          communication { var value : int = 0 }
          composition { mu input ? value until value == 1 }
        }
    """

    code = "E0509"
    title = "port connected to a label"

    port: str
    label_name: str

    @property
    def message(self) -> str:
        return f"nobody carries the values of the port `{self.port}` into `{self.label_name}`"

    @property
    def help(self) -> str | None:
        return (
            f"declare `var {self.label_name}`, and read the port in the composition: `{self.port} ? {self.label_name}`"
        )
