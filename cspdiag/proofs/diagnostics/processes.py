"""The diagnostics of processes that nothing can be proved of."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Label, Span
from cspdiag.base.record import record


@record
class OpenParameter(Diagnostic):
    code = "E1108"
    title = "an assertion about a process that lacks a value"

    process: str
    parameter: str
    declared: Span

    @property
    def message(self) -> str:
        return f"`{self.process}` has no value for its parameter `{self.parameter}`, so nothing can be proved of it"

    @property
    def help(self) -> str | None:
        return (
            f"give it a default, write an environment for `{self.process}({self.parameter} = ...)`, or set it: "
            f"`cspdiag verify --set {self.parameter}=...`"
        )

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, "the parameter"),)
