"""What runs, when, and what it finds."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Label, Span
from cspdiag.base.record import record
from cspdiag.network.relations import Access


@record
class NoComposition(Diagnostic):
    """A process has no composition.

    The communication diagram says who exists and what flows between them. In which order or at the same time they run is said by the
    composition diagram alone; there is no default for it.

    Refused::

        process Sender {
          out output : int
          composition { output ! 1 }
        }

        process Receiver {
          in input : int
          communication { var last : int = 0 }
          composition { input ? last }
        }

        process Main {
          communication {
            sender   : Sender
            receiver : Receiver
            sender.output -> receiver.input
          }
        }

    Mended::

        process Sender {
          out output : int
          composition { output ! 1 }
        }

        process Receiver {
          in input : int
          communication { var last : int = 0 }
          composition { input ? last }
        }

        process Main {
          communication {
            sender   : Sender
            receiver : Receiver
            sender.output -> receiver.input
          }
          composition { sender ; receiver }
        }
    """

    code = "E0606"
    title = "process without a composition"

    process: str

    @property
    def message(self) -> str:
        return f"nothing says what `{self.process}` does: it has no composition"

    @property
    def help(self) -> str | None:
        return "add `composition { ... }` with the instances in the order in which they run"


@record
class InstanceNeverRun(Diagnostic):
    """An instance is declared and never runs.

    Everything that is connected to it would wait for it in vain, or use values that never come. The composition
    names every instance of the communication diagram.

    Refused::

        process Sender {
          out output : int
          composition { output ! 1 }
        }

        process Receiver {
          in input : int
          communication { var last : int = 0 }
          composition { input ? last }
        }

        process Main {
          communication {
            sender   : Sender
            receiver : Receiver
            sender.output -> receiver.input
          }
          composition { receiver }
        }

    Mended::

        process Sender {
          out output : int
          composition { output ! 1 }
        }

        process Receiver {
          in input : int
          communication { var last : int = 0 }
          composition { input ? last }
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

    code = "E0607"
    title = "instance that never runs"

    instance: str
    process: str

    @property
    def message(self) -> str:
        return f"`{self.instance}` never runs: the composition of `{self.process}` does not name it"

    @property
    def help(self) -> str | None:
        return f"put `{self.instance}` where it belongs in the composition, or leave the instance away"


@record
class RunTwiceAtOnce(Diagnostic):
    """An instance runs in two parallel parts.

    An instance is one process with one state. It may run again later, in a loop or further on in a sequence, but not a second time
    while it is still running; nor may it be reset then.

    Refused::

        process Sender {
          out output : int
          composition { output ! 1 }
        }

        process Main {
          communication {
            sender : Sender
            sender.output -> _
          }
          composition { sender || sender }
        }

    Mended::

        process Sender {
          out output : int
          composition { output ! 1 }
        }

        process Main {
          communication {
            sender : Sender
            other  : Sender
            sender.output -> _
            other.output  -> _
          }
          composition { sender || other }
        }
    """

    code = "E0608"
    title = "instance that runs twice at the same time"

    instance: str
    first: Span

    @property
    def message(self) -> str:
        return f"`{self.instance}` is used in two parallel parts, but one instance cannot run twice at the same time"

    @property
    def help(self) -> str | None:
        return "declare a second instance of the same definition"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.first, "in parallel with this"),)


@record
class ReadBeforeWrite(Diagnostic):
    """A value is read before anything has written it.

    A variable without an initial value, and a channel between parts in sequence, have no value until they are written for the first
    time. On every way to the reader there must be a writer: through `;` and `||`, in every branch of an alternative and of `if`, and
    before a `while`, which may run no time at all. Of a part that can be abandoned (`interrupt`, `catch`) it is assumed that it ended.

    Refused::

        process Main {
          in  ready  : bool
          out output : int
          communication {
            var is_ready : bool
            var value : int
          }
          composition { ready ? is_ready ; (if is_ready then value := 1) ; output ! value }
        }

    Mended::

        process Main {
          in  ready  : bool
          out output : int
          communication {
            var is_ready : bool
            var value : int
          }
          composition { ready ? is_ready ; (if is_ready then value := 1 else value := 2) ; output ! value }
        }
    """

    code = "E0609"
    title = "value read before it was written"

    variable: str
    reader: str
    is_variable: bool
    declared: Span
    writer: Access | None

    @property
    def message(self) -> str:
        reader = f"by `{self.reader}` " if self.reader else ""
        if self.writer is None:
            return f"`{self.variable}` is read {reader}but nothing ever writes it"
        return f"`{self.variable}` may be read {reader}before it was written"

    @property
    def help(self) -> str | None:
        if self.is_variable:
            return (
                f"give it an initial value (`var {self.variable} : ... = ...`), or write it before on every way to here"
            )
        return "run the writer before the reader on every way to here, or the two in parallel"

    @property
    def labels(self) -> tuple[Label, ...]:
        places = [Label(self.declared, "declared here")]
        if self.writer is not None:
            places.append(Label(self.writer.run, f"written here by {self.writer.who}"))
        return tuple(places)


@record
class Unreachable(Diagnostic):
    """A part of the composition is never reached.

    What follows `stop`, `raise`, an endless `mu` or an instance that never ends is never run. It does no harm, but was surely
    meant to happen.

    Refused::

        process Main {
          out count : int @ 1 ms
          communication { var n : int = 0 }
          composition { mu (wait 1 ms ; n := n + 1) ; count ! n }
        }

    Mended::

        process Main {
          out count : int @ 1 ms
          communication { var n : int = 0 }
          composition { mu (wait 1 ms ; n := n + 1) until n == 10 ; count ! n }
        }
    """

    code = "W0611"
    title = "part that is never reached"
    severity = "warning"

    endless: Span

    @property
    def message(self) -> str:
        return "this part is never reached: what stands before it never ends by itself"

    @property
    def help(self) -> str | None:
        return "leave it away, or let the part before it end (`mu ... until ...`)"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.endless, "this never comes to its end"),)


@record
class EndlessLoop(Diagnostic):
    """A loop never waits, and never ends.

    One process runs until it must wait. A loop that never waits for a communication or for time, and whose condition nothing in it
    changes, keeps all others from running: time stands still. A delay of no time does not wait: ``wait 0 ms``, or one by a parameter
    that is zero in every instance.

    Refused::

        process Main {
          out light : bool @ 10 ms
          composition { mu light ! true }
        }

    Mended::

        process Main {
          out light : bool @ 10 ms
          composition { mu (light ! true ; wait 10 ms) }
        }
    """

    code = "E0612"
    title = "loop in which no time passes"

    conditional: bool
    delay: Span | None = None
    """A delay inside that is over at once."""

    @property
    def labels(self) -> tuple[Label, ...]:
        return () if self.delay is None else (Label(self.delay, "takes no time"),)

    @property
    def message(self) -> str:
        if self.conditional:
            return "this loop never waits, and nothing inside changes its condition: once in it, time stands still"
        return "this loop never waits for a communication or for time, so that nothing else could ever run"

    @property
    def help(self) -> str | None:
        if self.delay is not None:
            return "a delay of no or a negative duration is over at once: let it last longer"
        return "put a communication or a `wait` into the loop"
