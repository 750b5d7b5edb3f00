"""Sizes and indexes."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Label, Span
from cspdiag.base.record import record
from cspdiag.model.types import Type


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
