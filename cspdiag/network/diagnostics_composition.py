"""What is wrong with a composition diagram."""

from __future__ import annotations

from cspdiag.diagnostics import Diagnostic, Label, Span
from cspdiag.diagnostics.record import record
from cspdiag.network.relations import Access


@record
class UnguardedBranch(Diagnostic):
    """A branch of an alternative has no guard.

    An alternative waits until the guard of one of its branches is ready, and chooses that branch. For a branch without a guard
    nothing says when it may be chosen.

    Refused::

        process Main {
          in button : int
          communication { var value : int = 0 }
          composition { button ? value -> skip [] wait 5 ms }
        }

    Mended::

        process Main {
          in button : int
          communication { var value : int = 0 }
          composition { button ? value -> skip [] after 5 ms -> skip }
        }
    """

    code = "E0602"
    title = "branch without a guard"

    @property
    def message(self) -> str:
        return "this branch of the alternative has no guard, so nothing says when it may be chosen"

    @property
    def help(self) -> str | None:
        return "begin it with a guard: `port -> ...`, `port ? x -> ...`, `after 5 ms -> ...` or `skip -> ...`"


@record
class MixedAlternative(Diagnostic):
    """A replicated alternative stands in an alternative of the other kind.

    The branches of `alt` and `prialt` become branches of the alternative around them. Either all of them have priorities, in text order,
    or none has.

    Refused::

        process Main {
          in stop_button : int
          in request[3] : int
          communication { var value : int = 0 }
          composition { stop_button ? value -> skip []> alt i < 3 : request[i] ? value -> skip }
        }

    Mended::

        process Main {
          in stop_button : int
          in request[3] : int
          communication { var value : int = 0 }
          composition { stop_button ? value -> skip []> prialt i < 3 : request[i] ? value -> skip }
        }
    """

    code = "E0603"
    title = "replicated alternative of the other kind"

    prioritized: bool

    @property
    def message(self) -> str:
        if self.prioritized:
            return "a fair `alt` cannot be a branch of a prioritized alternative"
        return "a prioritized `prialt` cannot be a branch of a fair alternative"

    @property
    def help(self) -> str | None:
        return "write `prialt` here" if self.prioritized else "write `alt` here, or `[]>` between the branches"


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
class GuardNotRead(Diagnostic):
    """A process behind a ready guard begins with something else than the guard promises.

    `port -> P` is chosen when the port is ready, because `P` begins by reading it. If `P` first waits for something else, the choice was
    made for the wrong reason, and `P` may be stuck while other guards become ready. The published code of JIWY guarded its control law by
    `feedback`, but read other ports first.

    On every way through `P` the port is read before anything that may wait. A submodel reads all its inputs at once; beside the
    port of the guard they may be values that are always there (`var` channels, defaults) and sampled inputs of the same
    period that this process reads only together with that port: they are ready at the same instant.

    Refused::

        process Main {
          in  feedback : int @ 1 ms
          in  button   : int
          out control  : int @ 1 ms
          communication {
            var angle  : int = 0
            var status : int = 0
          }
          composition { mu (feedback -> (button ? status ; feedback ? angle ; control ! angle)) until status == 2 }
        }

    Mended::

        process Main {
          in  feedback : int @ 1 ms
          in  button   : int
          out control  : int @ 1 ms
          communication {
            var angle  : int = 0
            var status : int = 0
          }
          composition {
            mu (
              button ? status -> skip
              []>
              feedback -> (feedback ? angle ; control ! angle)
            ) until status == 2
          }
        }
    """

    code = "E0610"
    title = "guarded process that begins with something else"

    port: str
    first: Span
    what: str
    beside: str | None

    @property
    def message(self) -> str:
        return f"`{self.port}` guards this branch, but {self.what}"

    @property
    def help(self) -> str | None:
        if self.beside is not None:
            return f"keep the latest value of `{self.beside}` in a variable (`{self.beside} ? x`), and connect the variable"
        return f"begin by reading `{self.port}`, or read it in the guard (`{self.port} ? x -> ...`)"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.first, "the guarded process begins here"),)


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
    changes, keeps all others from running: time stands still.

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

    @property
    def message(self) -> str:
        if self.conditional:
            return "this loop never waits, and nothing inside changes its condition: once in it, time stands still"
        return "this loop never waits for a communication or for time, so that nothing else could ever run"

    @property
    def help(self) -> str | None:
        return "put a communication or a `wait` into the loop"


@record
class BranchNeverChosen(Diagnostic):
    """A branch of an alternative can never be chosen.

    A prioritized alternative takes the first guard that is ready. Behind one that is always ready (`skip`, an output of the
    outermost process, a value that is always there) no other gets a turn. Nor is a branch ever chosen whose condition is `false`.

    Refused::

        process Main {
          in button : int
          communication { var pressed : int = 0 }
          composition {
            mu (
              skip -> wait 1 ms
              []>
              button ? pressed -> skip
            ) until pressed == 1
          }
        }

    Mended::

        process Main {
          in button : int
          communication { var pressed : int = 0 }
          composition {
            mu (
              button ? pressed -> skip
              []>
              skip -> wait 1 ms
            ) until pressed == 1
          }
        }
    """

    code = "W0613"
    title = "branch that is never chosen"
    severity = "warning"

    earlier: Span | None

    @property
    def message(self) -> str:
        if self.earlier is None:
            return "this guard never holds, so that its branch is never chosen"
        return "this branch is never chosen: an earlier one, which has priority, is always ready"

    @property
    def help(self) -> str | None:
        if self.earlier is None:
            return "leave the branch away, or mend the condition"
        return "put this branch before the one that is always ready, or use the fair `[]`"

    @property
    def labels(self) -> tuple[Label, ...]:
        return () if self.earlier is None else (Label(self.earlier, "always ready"),)


@record
class SamePortTwice(Diagnostic):
    """Two branches of an alternative are guarded by the same port.

    When the port is ready, both branches could be chosen, and nothing says which. What is to be done depends on the value: read it in one
    branch and decide there, or let conditions with `when` exclude each other.

    Refused::

        process Main {
          in  command : int
          out output  : int
          communication { var value : int = 0 }
          composition {
            command ? value -> output ! 1
            []
            command ? value -> output ! 2
          }
        }

    Mended::

        process Main {
          in  command : int
          out output  : int
          communication { var value : int = 0 }
          composition { command ? value -> (if value > 0 then output ! 1 else output ! 2) }
        }
    """

    code = "E0614"
    title = "one port in two branches"

    port: str
    first: Span

    @property
    def message(self) -> str:
        return f"two branches of this alternative are guarded by `{self.port}`, and nothing tells which one to choose"

    @property
    def help(self) -> str | None:
        return "read the port in one branch and decide with `if`, or put a `when` before each of the guards"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.first, "the other branch"),)
