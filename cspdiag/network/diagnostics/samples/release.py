"""What a process leaves behind on its outputs."""

from __future__ import annotations

from typing import ClassVar

from cspdiag.base import Diagnostic, Label, Severity, Span
from cspdiag.base.record import record


@record
class OutputNotReleased(Diagnostic):
    code = "W0690"
    title = "output not released"
    severity: ClassVar[Severity] = "warning"

    process: str
    port: str
    instance: str
    release: str
    """A value that lets go of the actuator, as it is written."""
    port_span: Span

    @property
    def message(self) -> str:
        return f"`{self.process}` ends with the last value of `{self.instance}` on its output `{self.port}`"

    @property
    def label(self) -> str:
        return f"writes `{self.port}` until the loop ends"

    @property
    def help(self) -> str:
        return f"write what `{self.port}` is to be afterwards: `(…) ; {self.port} ! {self.release}`"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.port_span, "a sampled output keeps its value until it is written again"),)
