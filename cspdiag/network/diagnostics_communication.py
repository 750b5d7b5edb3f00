"""What is wrong with a communication diagram: sizes, indexes and ends of relationships."""

from __future__ import annotations

from cspdiag.diagnostics import Diagnostic, Label, Span
from cspdiag.diagnostics.record import record
from cspdiag.model.types import Type


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
        return f"`{self.port}` is connected twice"

    @property
    def help(self) -> str | None:
        if self.direction == "in":
            return "an input has one relationship: leave one away, or list both sources before one arrow"
        return "an output has one relationship: list all its readers after one arrow"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.first, "connected here first"),)


@record
class IndexOutOfRange(Diagnostic):
    """An index names an element that is not there.

    Elements of arrays of instances and of ports are counted from 0. All indexes are known before the program runs, so that none is
    found out of range only then.

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
            receiver[2] : Receiver
            sender.output -> broadcast -> receiver[1].input, receiver[2].input
          }
          composition { sender || par i < 2 : receiver[i] }
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
            receiver[2] : Receiver
            sender.output -> broadcast -> receiver[0].input, receiver[1].input
          }
          composition { sender || par i < 2 : receiver[i] }
        }
    """

    code = "E0503"
    title = "index out of range"

    index: int
    what: str
    size: int
    declared: Span

    @property
    def message(self) -> str:
        return f"index {self.index} is out of range: {self.what} has {self.size} elements, 0 to {self.size - 1}"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, "declared here"),)


@record
class IndexMissing(Diagnostic):
    """The name of an array stands where one element is wanted.

    What is declared inside `for` is there once for every repetition: an array. Inside the same `for` its bare name means that of the same
    repetition; everywhere else an index chooses one.

    Refused::

        process Sender {
          out output : int
          composition { output ! 1 }
        }

        process Main {
          communication {
            for i < 3 {
              cell : Sender
              cell.output -> _
            }
          }
          composition { cell }
        }

    Mended::

        process Sender {
          out output : int
          composition { output ! 1 }
        }

        process Main {
          communication {
            for i < 3 {
              cell : Sender
              cell.output -> _
            }
          }
          composition { par i < 3 : cell[i] }
        }
    """

    code = "E0504"
    title = "element of an array wanted"

    name: str

    @property
    def message(self) -> str:
        return f"`{self.name}` is an array, and one element of it is wanted here"

    @property
    def help(self) -> str | None:
        return f"choose one: `{self.name}[0]`"


@record
class SizeNotPositive(Diagnostic):
    """An array, a buffer or a replicator has a size that is not positive.

    An array of instances or of ports has at least one element, and a buffer keeps at least one value. A replicator may
    repeat nothing, but not less than nothing.

    Refused::

        process Sender {
          out output : int
          composition { output ! 1 }
        }

        process Main {
          communication {
            cell[2 - 2] : Sender
            for i < 0 { cell[i].output -> _ }
          }
          composition { skip }
        }

    Mended::

        process Sender {
          out output : int
          composition { output ! 1 }
        }

        process Main {
          communication {
            cell[2 - 1] : Sender
            for i < 1 { cell[i].output -> _ }
          }
          composition { cell[0] }
        }
    """

    code = "E0505"
    title = "size that is not positive"

    what: str
    size: int

    @property
    def message(self) -> str:
        return f"{self.what} cannot have {self.size} elements"

    @property
    def help(self) -> str | None:
        return "a size is at least 1"


@record
class TooManyInstances(Diagnostic):
    """The program has more elements than any machine would run.

    Every instance exists before the program starts. Sizes beyond a hundred thousand in one process, or a million in all, are taken for a
    slip of the pen, and refused before they use up the memory of the compiler.

    Refused::

        process Sender {
          out output : int
          composition { output ! 1 }
        }

        process Main {
          communication {
            for i < 1000 {
              for j < 1000 {
                cell : Sender
                cell.output -> _
              }
            }
          }
          composition { skip }
        }

    Mended::

        process Sender {
          out output : int
          composition { output ! 1 }
        }

        process Main {
          communication {
            for i < 10 {
              for j < 10 {
                cell : Sender
                cell.output -> _
              }
            }
          }
          composition { par i < 10 : par j < 10 : cell[i][j] }
        }
    """

    code = "E0506"
    title = "too many elements"

    what: str
    number: int
    limit: int

    @property
    def message(self) -> str:
        return f"{self.what} has {self.number} elements, and at most {self.limit} are possible"


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


@record
class ArraysDiffer(Diagnostic):
    """Arrays of different sizes are connected to each other.

    An array of ports that is named without an index is connected element by element, so that both ends have the same number of elements. A
    single port is connected to one element, chosen by its index.

    Refused::

        process Reader(n: int) {
          in input[n] : int
          communication { var last : int = 0 }
          composition { mu (alt i < n : input[i] ? last -> skip) }
        }

        process Main {
          in request[3] : int
          communication {
            reader : Reader(n = 2)
            request -> reader.input
          }
          composition { reader }
        }

    Mended::

        process Reader(n: int) {
          in input[n] : int
          communication { var last : int = 0 }
          composition { mu (alt i < n : input[i] ? last -> skip) }
        }

        process Main {
          in request[3] : int
          communication {
            reader : Reader(n = 3)
            request -> reader.input
          }
          composition { reader }
        }
    """

    code = "E0510"
    title = "arrays of different size connected"

    size: int
    other: Span
    other_size: int

    @property
    def message(self) -> str:
        if self.size == self.other_size:
            return f"an array of {self.size} is connected to a single port"
        return f"an array of {self.size} is connected to {'one' if self.other_size == 1 else self.other_size}"

    @property
    def help(self) -> str | None:
        return "arrays are connected element by element: give both the same size, or index one with `[i]`"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.other, "the other end"),)


@record
class ValueSizesDiffer(Diagnostic):
    """Arrays of different lengths are passed from one end of a communication to the other.

    Both ends of a communication have the same type, and the length of an array belongs to its type. Here it depends on a parameter,
    and the values given for it do not fit together.

    Refused::

        submodel Mean(n: int) {
          in  values : double[n]
          out mean   : double
          mean = values[0] / 2 + values[n - 1] / 2
        }

        process Main {
          in  values : double[4]
          out mean   : double
          communication {
            law : Mean(n = 3)
            values   -> law.values
            law.mean -> mean
          }
          composition { mu law }
        }

    Mended::

        submodel Mean(n: int) {
          in  values : double[n]
          out mean   : double
          mean = values[0] / 2 + values[n - 1] / 2
        }

        process Main {
          in  values : double[4]
          out mean   : double
          communication {
            law : Mean(n = 4)
            values   -> law.values
            law.mean -> mean
          }
          composition { mu law }
        }
    """

    code = "E0513"
    title = "arrays of different lengths"

    one: str
    one_type: Type
    other: str
    other_type: Type

    @property
    def message(self) -> str:
        return f"`{self.one}` carries a {self.one_type}, but `{self.other}` a {self.other_type}"

    @property
    def help(self) -> str | None:
        return "give the parameter that the length depends on the value that fits"


@record
class VariableUnused(Diagnostic):
    """A variable or a channel is declared and never used.

    It does no harm, but a reader of the diagram looks for its purpose in vain; often another name was meant where it should occur.

    Refused::

        process Main {
          out output : int
          communication {
            var count : int = 0
            var limit : int = 10
          }
          composition { mu (output ! count ; count := count + 1) until count == 10 }
        }

    Mended::

        process Main {
          out output : int
          communication {
            var count : int = 0
            var limit : int = 10
          }
          composition { mu (output ! count ; count := count + 1) until count == limit }
        }
    """

    code = "W0511"
    title = "variable, channel or label that nobody uses"
    severity = "warning"

    name: str

    @property
    def message(self) -> str:
        return f"nobody uses `{self.name}`"

    @property
    def help(self) -> str | None:
        return "leave it away"


@record
class PortUnused(Diagnostic):
    """A process declares a port and never uses it.

    Whoever is connected to an input that nobody reads may wait there for ever; an output that nobody writes never has a value. If
    an input is ignored on purpose, the communication block says so with `port -> _`.

    Refused::

        process Main {
          in  request : int
          out answer  : int
          composition { mu (answer ! 1 ; wait 1 ms) }
        }

    Mended::

        process Main {
          in  request : int
          out answer  : int
          communication { var last : int = 0 }
          composition { mu (request ? last ; answer ! last) }
        }
    """

    code = "W0512"
    title = "port that its process never uses"
    severity = "warning"

    port: str
    process: str
    direction: str

    @property
    def message(self) -> str:
        verb = "reads" if self.direction == "in" else "writes"
        return f"`{self.process}` never {verb} its port `{self.port}`"

    @property
    def help(self) -> str | None:
        if self.direction == "in":
            return f"use it, leave it away, or say that it is ignored with `{self.port} -> _`"
        return "write it with `!` or connect an instance to it, or leave it away"
