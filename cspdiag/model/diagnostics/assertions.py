"""Diagnostics of assertions."""

from __future__ import annotations

from cspdiag.base import Diagnostic, Label
from cspdiag.base.record import record
from cspdiag.base.span import Span


@record
class UnspecifiedPort(Diagnostic):
    code = "E0218"
    title = "a port that a specification says nothing about"

    ports: tuple[str, ...]
    process: str
    specification: str
    hidden: tuple[str, ...]
    declared: Span

    @property
    def message(self) -> str:
        shown = " and ".join(filter(None, (", ".join(self._quoted[:-1]), self._quoted[-1])))
        noun = "port" if len(self.ports) == 1 else "ports"
        return f"`{self.specification}` says nothing about the {noun} {shown} of `{self.process}`"

    @property
    def _quoted(self) -> tuple[str, ...]:
        return tuple(f"`{port}`" for port in self.ports)

    @property
    def help(self) -> str | None:
        hidden = ", ".join((*self.hidden, *self.ports))
        return f"add `hide {hidden}` to the assertion, or give `{self.specification}` such a port"

    @property
    def labels(self) -> tuple[Label, ...]:
        return (Label(self.declared, "the port"),)
