"""The diagnostic of a field of a struct where only the whole struct is allowed."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Label, Span
from cspdiag.base.record import record


@record
class PartOfStruct(Diagnostic):
    code = "E0236"
    title = "a field of a struct by itself"

    name: str
    problem: str
    advice: str
    declared: Span | None
    whole: str

    @property
    def message(self) -> str:
        return f"`{self.name}` {self.problem}"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, f"`{self.whole}` is declared here"),) if self.declared else ()
