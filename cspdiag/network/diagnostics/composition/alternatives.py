"""Guards and branches."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Edit, Label, Span
from cspdiag.base.record import record
from cspdiag.model.constants.durations import duration


@record
class UnguardedBranch(Diagnostic):
    code = "E0602"
    title = "branch without a guard"
    message = "this branch of the alternative has no guard, so nothing says when it may be chosen"

    communicates: bool

    @property
    def help(self) -> str | None:
        if self.communicates:
            return "to make its communication the guard write `-> skip` after it"
        return "begin it with a guard: `port -> ...`, `port ? x -> ...`, `after 5 ms -> ...` or `skip -> ...`"

    @property
    def edits(self) -> tuple[Edit, ...]:
        return (Edit(Span(self.span.source, self.span.end, self.span.end), " -> skip"),) if self.communicates else ()


@record
class MixedAlternative(Diagnostic):
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
            return (
                f"keep the latest value of `{self.beside}` in a variable (`{self.beside} ? x`), and connect the "
                "variable"
            )
        return f"begin by reading `{self.port}`, or read it in the guard (`{self.port} ? x -> ...`)"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.first, "the guarded process begins here"),)


@record
class BranchNeverChosen(Diagnostic):
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
            return "remove the branch, or correct the condition"
        return "put this branch before the one that is always ready, or use the fair `[]`"

    @property
    def labels(self) -> tuple[Label, ...]:
        return () if self.earlier is None else (Label(self.earlier, "always ready"),)


@record
class SamePortTwice(Diagnostic):
    code = "E0614"
    title = "one port in two branches"

    port: str
    first: Span
    writes: bool

    @property
    def message(self) -> str:
        return f"two branches of this alternative are guarded by `{self.port}`, and nothing decides which one to choose"

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
            return (
                f"these {duration(self.waits)} never elapse: another time-out of this alternative is over after "
                f"{duration(self.period)}"
            )
        if self.port is None:
            return f"these {duration(self.waits)} never elapse: another branch is ready at once"
        return (
            f"these {duration(self.waits)} never elapse: a sample of `{self.port}` comes every "
            f"{duration(self.period)}, and is read before"
        )

    @property
    def help(self) -> str | None:
        if self.port is None and self.period:
            return "remove one of the two, or put a `when` before the shorter one"
        if self.port is None:
            return "a time-out is for an alternative that waits: remove one of the two"
        waits = duration(self.waits)
        return (
            f"keep the instant from which they count, `start := now`, and write `at start + {waits}`; or count samples "
            f"of `{self.port}`, or let a process in parallel `wait {waits}`"
        )

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.earlier, f"chosen within {duration(self.period)}" if self.period else "always ready"),)


@record
class ReleaseNotDistinguished(Diagnostic):
    code = "W0616"
    title = "guard that takes a release for a press"
    severity = "warning"

    port: str
    variable: str
    is_interrupt: bool

    @property
    def message(self) -> str:
        return (
            f"`{self.port}` comes when it becomes true and when it becomes false, and nothing tests "
            f"`{self.variable}` to distinguish the two"
        )

    @property
    def help(self) -> str | None:
        if self.is_interrupt:
            return (
                f"continue after a release: `mu (... interrupt {self.port} ? {self.variable} -> skip) until "
                f"{self.variable}`"
            )
        return f"look at the value: `{self.port} ? {self.variable} -> if {self.variable} then ...`"
