"""The diagnostic of an overloaded processor."""

from __future__ import annotations

from typing import ClassVar

from cspdiag.base import Diagnostic, Label, Severity, Span
from cspdiag.base.record import record


@record
class Overload(Diagnostic):
    code: ClassVar[str] = "W0710"
    title: ClassVar[str] = "more work than time"
    severity: ClassVar[Severity] = "warning"

    process: str
    percent: int
    laws: tuple[tuple[str, int, Span], ...]
    """Path, share in per cent and place of the laws, the most demanding first."""

    @property
    def message(self) -> str:
        return f"the control laws of `{self.process}` need {self.percent} % of the processor"

    @property
    def help(self) -> str | None:
        return "let some of them run at longer periods, or make them faster and state the new `wcet`"

    @property
    def labels(self) -> tuple[Label, ...]:
        return tuple(Label(place, f"`{path}` needs {share} %") for path, share, place in self.laws[:4])
