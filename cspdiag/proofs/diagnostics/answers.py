"""The diagnostics of proofs: assertions that do not hold, and those that are neither proved nor refuted."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Label
from cspdiag.base.record import record


@record
class Refutation(Diagnostic):
    """An assertion that does not hold."""

    process: str
    found: str
    places: tuple[Label, ...] = ()
    advice: str | None = None

    @property
    def message(self) -> str:
        return f"`{self.process}` {self.found}"

    @property
    def labels(self) -> tuple[Label, ...]:
        return self.places


@record
class CanDeadlock(Refutation):
    code = "E1101"
    title = "processes that can wait for each other forever"


@record
class CanLivelock(Refutation):
    code = "E1102"
    title = "a process that can be busy with itself forever"


@record
class MayNotTerminate(Refutation):
    code = "E1103"
    title = "a process that may never end"


@record
class DoesNotRefine(Refutation):
    code = "E1104"
    title = "a process that does not refine its specification"


@record
class NotProved(Diagnostic):
    code = "E1105"
    title = "an assertion that is neither proved nor refuted"

    assertion: str
    reason: str
    candidate: tuple[str, ...] = ()

    @property
    def message(self) -> str:
        return f"`{self.assertion}` is not proved: {self.reason}"

    @property
    def help(self) -> str | None:
        if not self.candidate:
            return None
        return "\n".join(("this could not be ruled out:", *self.candidate))
