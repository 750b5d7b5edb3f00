"""What runs, when, and what it finds."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Label, Span
from cspdiag.base.record import record
from cspdiag.network.relations import Access


@record
class NoComposition(Diagnostic):
    code = "E0606"
    title = "process without a composition"
    help = "add `composition { ... }` with the instances in the order in which they run"

    process: str

    @property
    def message(self) -> str:
        return f"nothing says what `{self.process}` does: it has no composition"


@record
class InstanceNeverRun(Diagnostic):
    code = "E0607"
    title = "instance that never runs"

    instance: str
    process: str
    is_named: bool
    """Whether the composition names it where a replicator never reaches it."""

    @property
    def message(self) -> str:
        if self.is_named:
            return (
                f"`{self.instance}` never runs: no iteration of the replicators in the composition of "
                f"`{self.process}` runs it"
            )
        return f"`{self.instance}` never runs: the composition of `{self.process}` does not name it"

    @property
    def help(self) -> str | None:
        if self.is_named:
            return "let the replicators run every instance that is declared, or declare an array of as many as they run"
        if self.instance == "stop":
            return "`stop` by itself is the process that never ends: give the instance another name"
        return f"put `{self.instance}` where it belongs in the composition, or remove the instance"


@record
class RunTwiceAtOnce(Diagnostic):
    code = "E0608"
    title = "instance that runs twice at the same time"
    help = "declare a second instance of the same definition"

    instance: str
    first: Span

    @property
    def message(self) -> str:
        return f"`{self.instance}` is used in two parallel parts, but one instance cannot run twice at the same time"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.first, "in parallel with this"),)


@record
class ReadBeforeWrite(Diagnostic):
    code = "E0609"
    title = "value read before it was written"

    variable: str
    reader: str
    is_variable: bool
    declared: Span
    writer: Access | None
    is_element: bool = False
    """Whether it is an array of which an element is written."""

    @property
    def message(self) -> str:
        if self.is_element:
            return f"an element of `{self.variable}` may be written before `{self.variable}` has a value"
        reader = f"by `{self.reader}` " if self.reader else ""
        if self.writer is None:
            return f"`{self.variable}` is read {reader}but nothing ever writes it"
        return f"`{self.variable}` may be read {reader}before it was written"

    @property
    def help(self) -> str | None:
        if self.is_element:
            return (
                f"give it an initial value (`var {self.variable} : ... = [...]`), or write the whole array before: the "
                "other elements would have no values"
            )
        if self.is_variable:
            return (
                f"give it an initial value (`var {self.variable} : ... = ...`), or write it before on every path to "
                "this point"
            )
        return "run the writer before the reader on every path to this point, or the two in parallel"

    @property
    def labels(self) -> tuple[Label, ...]:
        places = [Label(self.declared, "declared here")]
        if self.writer is not None and not self.is_element:
            places.append(Label(self.writer.run, f"written here by {self.writer.user}"))
        return tuple(places)


@record
class Unreachable(Diagnostic):
    code = "W0611"
    title = "part that is never reached"
    severity = "warning"
    message = "this part is never reached: what comes before it never ends by itself"
    help = "remove it, or let the part before it end (`mu ... until ...`)"

    endless: Span

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.endless, "this never ends"),)


@record
class EndlessLoop(Diagnostic):
    code = "E0612"
    title = "loop in which no time passes"

    conditional: bool
    may_end_first: bool = False
    """Whether its condition may hold after the first iteration, and so end it."""
    delay: Span | None = None
    """A delay inside that is over at once."""
    is_instant: bool = False
    """Whether it is one until an instant, the same in every iteration."""
    write: Span | None = None
    """A communication inside that waits for no reader."""
    instance: str | None = None
    """An instance in which that is so."""

    @property
    def labels(self) -> tuple[Label, ...]:
        if self.delay is not None:
            return (Label(self.delay, "the same instant in every iteration" if self.is_instant else "takes no time"),)
        if self.write is not None:
            where = "" if self.instance is None else f"in `{self.instance}` "
            return (Label(self.write, f"{where}this waits for no reader"),)
        return ()

    @property
    def message(self) -> str:
        if self.is_instant and not self.conditional:
            return "from one instant on this loop never waits, so that nothing else could ever run"
        if self.may_end_first:
            return (
                "this loop never waits, and nothing inside changes its condition: it ends after its first iteration, "
                "or time stands still"
            )
        if self.conditional:
            return "this loop never waits, and nothing inside changes its condition: once in it, time stands still"
        return "this loop never waits for a communication or for time, so that nothing else could ever run"

    @property
    def help(self) -> str | None:
        if self.is_instant:
            return "let the instant move with the iterations, as in `wait until last + 10 ms`, or wait for a duration"
        if self.delay is not None:
            return "a delay of zero or negative duration ends immediately: make it longer"
        if self.may_end_first:
            return "remove the loop if one iteration is meant; otherwise put a communication or a `wait` into it"
        if self.write is not None:
            return "let a process read with `?` what the loop writes, or put a `wait` into the loop"
        return "put a communication or a `wait` into the loop"
