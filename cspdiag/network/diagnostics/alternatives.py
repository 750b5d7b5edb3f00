"""Guards and branches."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Label, Span
from cspdiag.base.record import record
from cspdiag.model.constants.durations import duration


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

    communicates: bool

    @property
    def message(self) -> str:
        return "this branch of the alternative has no guard, so nothing says when it may be chosen"

    @property
    def help(self) -> str | None:
        if self.communicates:
            return "to make its communication the guard write `-> skip` after it"
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
    writes: bool

    @property
    def message(self) -> str:
        return f"two branches of this alternative are guarded by `{self.port}`, and nothing tells which one to choose"

    @property
    def help(self) -> str | None:
        if self.writes:
            return (
                "put a `when` before each of the guards; where either value will do, write `skip ->` before each branch"
            )
        return "read the port in one branch and decide with `if`, or put a `when` before each of the guards"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.first, "the other branch"),)


@record
class TimeOutNeverElapses(Diagnostic):
    """A time-out stands beside a branch that is always chosen before it elapses.

    `after 50 ms` counts from the beginning of the alternative, and so does a shorter `after` beside it. Where a sample comes every 10 ms, the alternative chooses it long before, and
    begins again, with a new time-out, when a loop comes back to it. What is to happen every so often beside the samples is counted in samples, or belongs to a
    process in parallel.

    Refused::

        process Main {
          in  angle : double @ 10 ms
          out motor : double @ 10 ms
          out alive : int
          communication {
            var now   : double = 0
            var times : int    = 0
          }
          composition {
            mu (
              angle ? now -> motor ! now
              []
              after 50 ms -> (times := times + 1 ; alive ! times)
            )
          }
        }

    Mended::

        process Main {
          in  angle : double @ 10 ms
          out motor : double @ 10 ms
          out alive : int
          communication {
            var now   : double = 0
            var times : int    = 0
          }
          composition {
            (mu (angle ? now ; motor ! now))
            ||
            (mu (wait 50 ms ; times := times + 1 ; alive ! times))
          }
        }
    """

    code = "W0615"
    title = "time-out that never elapses"
    severity = "warning"

    waits: int
    port: str | None
    """The sampled input that is read before; None where a branch is always ready, or another time-out shorter."""
    period: int
    """Within how long the other branch is ready."""
    earlier: Span

    @property
    def message(self) -> str:
        if self.port is None and self.period:
            return f"these {duration(self.waits)} never elapse: another time-out of this alternative is over after {duration(self.period)}"
        if self.port is None:
            return f"these {duration(self.waits)} never elapse: another branch is ready at once"
        return f"these {duration(self.waits)} never elapse: a sample of `{self.port}` comes every {duration(self.period)}, and is read before"

    @property
    def help(self) -> str | None:
        if self.port is None and self.period:
            return "leave one of the two away, or put a `when` before the shorter one"
        if self.port is None:
            return "a time-out is for an alternative that waits: leave one of the two away"
        return f"count samples of `{self.port}` instead, or let a process in parallel `wait {duration(self.waits)}`"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.earlier, f"chosen within {duration(self.period)}" if self.period else "always ready"),)


@record
class ReleaseNotToldApart(Diagnostic):
    """A guard waits for a `bool` event, and nobody looks at the value.

    An event comes when its value changes: a button that is pressed gives `true`, and `false` when it is released. A guard without a look
    at the value takes either. What is to happen at the press only looks at the variable, and goes on where it is false.

    Refused::

        process Main {
          in  halt  : bool
          in  angle : double @ 1 ms
          out motor : double @ 1 ms
          communication {
            var pressed : bool   = false
            var now     : double = 0
          }
          composition {
            (mu (angle ? now ; motor ! 1 - now)) interrupt halt ? pressed -> motor ! 0
          }
        }

    Mended::

        process Main {
          in  halt  : bool
          in  angle : double @ 1 ms
          out motor : double @ 1 ms
          communication {
            var pressed : bool   = false
            var now     : double = 0
          }
          composition {
            mu (
              (mu (angle ? now ; motor ! 1 - now)) interrupt halt ? pressed -> skip
            ) until pressed ;
            motor ! 0
          }
        }
    """

    code = "W0616"
    title = "guard that takes a release for a press"
    severity = "warning"

    port: str
    variable: str
    is_interrupt: bool

    @property
    def message(self) -> str:
        return f"`{self.port}` comes when it becomes true and when it becomes false, and nobody looks at `{self.variable}` to tell the two apart"

    @property
    def help(self) -> str | None:
        if self.is_interrupt:
            return f"go on after a release: `mu (... interrupt {self.port} ? {self.variable} -> skip) until {self.variable}`"
        return f"look at the value: `{self.port} ? {self.variable} -> if {self.variable} then ...`"
