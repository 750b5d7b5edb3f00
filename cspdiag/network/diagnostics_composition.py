"""What is wrong with a composition diagram."""

from __future__ import annotations

from cspdiag.diagnostics import Diagnostic, Label, Span
from cspdiag.diagnostics.record import record
from cspdiag.network.relations import Access


@record
class UnguardedBranch(Diagnostic):
    """E0602."""

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
    """E0603."""

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
class NoOutermostProcess(Diagnostic):
    """E0604."""

    code = "E0604"
    title = "no process to begin with"

    top: str | None

    @property
    def message(self) -> str:
        if self.top is not None:
            return f"there is no process `{self.top}`"
        return "the program has no process to begin with"

    @property
    def help(self) -> str | None:
        return "define a process that no other one contains, or an environment for one"


@record
class ParameterWithoutValue(Diagnostic):
    """E0605."""

    code = "E0605"
    title = "outermost process without arguments"

    process: str
    parameter: str

    @property
    def message(self) -> str:
        return f"the outermost process `{self.process}` has no value for its parameter `{self.parameter}`"

    @property
    def help(self) -> str | None:
        return f"give the parameter a default, or write `environment ... for {self.process}(...)`"


@record
class NoComposition(Diagnostic):
    """E0606."""

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
    """E0607."""

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
    """E0608."""

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
    """E0609."""

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
    """E0610."""

    code = "E0610"
    title = "guarded process that begins with something else"

    port: str
    first: Span
    what: str

    @property
    def message(self) -> str:
        return f"`{self.port}` guards this branch, but what follows {self.what}"

    @property
    def help(self) -> str | None:
        return f"begin with the port of the guard, read it in the guard (`{self.port} ? x -> ...`), or guard with the port read first"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.first, "the guarded process begins here"),)


@record
class Unreachable(Diagnostic):
    """W0611."""

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
    """E0612."""

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
    """W0613."""

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
    """E0614."""

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
