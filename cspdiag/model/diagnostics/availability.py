"""Diagnostics of values that are not available where they are used."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Label, Span
from cspdiag.base.record import record


@record
class NotConstant(Diagnostic):
    code = "E0209"
    title = "a value that must be known before the program runs"
    help = "use numbers, constants and parameters here"

    name: str
    kind: str
    declared: Span | None

    @property
    def message(self) -> str:
        return f"`{self.name}` is {self.kind}, but this must be known before the program runs"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, f"`{self.name}` is declared here"),) if self.declared else ()


@record
class NotAvailableHere(Diagnostic):
    code = "E0210"
    title = "not available here"

    what: str
    where: str
    declared: Span | None = None
    advice: str | None = None

    @property
    def message(self) -> str:
        return f"`{self.what}` is not available in {self.where}"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, f"`{self.what}` is used here"),) if self.declared else ()
