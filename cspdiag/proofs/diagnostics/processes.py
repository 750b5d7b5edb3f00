"""The diagnostics of processes that nothing can be proved of."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Label, Span
from cspdiag.base.record import record


@record
class OpenParameters(Diagnostic):
    code = "E1108"
    title = "an assertion about a process that lacks a value"

    process: str
    parameters: tuple[str, ...]
    declared: tuple[Span, ...]

    @property
    def message(self) -> str:
        names = ", ".join(f"`{name}`" for name in self.parameters)
        what = "value for its parameter" if len(self.parameters) == 1 else "values for its parameters"
        return f"`{self.process}` has no {what} {names}, so nothing can be proved of it"

    @property
    def help(self) -> str | None:
        arguments = ", ".join(f"{name} = ..." for name in self.parameters)
        options = " ".join(f"--set {name}=..." for name in self.parameters)
        it, default = ("it", "a default") if len(self.parameters) == 1 else ("them", "defaults")
        return (
            f"give {it} {default}, write an environment for `{self.process}({arguments})`, or set {it}: "
            f"`cspdiag verify {options}`"
        )

    @property
    def labels(self) -> tuple[Label, ...]:
        return tuple(Label(span, "the parameter") for span in self.declared)
