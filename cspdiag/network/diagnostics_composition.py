"""What is wrong with a composition diagram."""

from __future__ import annotations

from cspdiag.diagnostics import Diagnostic
from cspdiag.diagnostics.record import record


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
