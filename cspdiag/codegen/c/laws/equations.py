"""Equations of control laws and environments as C statements, one after the other."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from cspdiag.base.record import record
from cspdiag.codegen.c.text.code import INDENT, Code, statement
from cspdiag.codegen.c.text.expressions import Printer
from cspdiag.codegen.shared.equations import Equation
from cspdiag.network.ir.declared import Declared
from cspdiag.network.ir.equations import ExternalCall
from cspdiag.network.ir.expressions import Expression
from cspdiag.network.ir.faults import may_fault

Check = Callable[[str], list[str]]
"""From the place of a statement to what looks for a fault behind it, without indentation."""


@record
class EquationWriter:
    """Prints assignments. ``place`` says where something stands in the text; ``external`` gives the lvalue of a nested body in C."""

    printer: Printer
    place: Callable[[Declared], str]
    check: Check
    external: Callable[[str], str]
    body_name: Callable[[ExternalCall], str]
    indent: str = INDENT

    def assign(self, target: str, value: Expression, place: str) -> list[str]:
        """``target = value;`` with temporaries before it and a look for a fault behind it where there may be one."""
        return self.assign_code(target, self.printer.print(value), place, faulty=may_fault(value))

    def assign_code(self, target: str, code: Code, place: str | None, *, faulty: bool) -> list[str]:
        """The same for what is printed already."""
        rows = [f"{self.indent}{declaration}" for declaration in self.printer.take_temporaries()]
        rows += statement(f"{target} = ", code, ";", self.indent, place)
        if faulty:
            rows += [self.indent + row for row in self.check(place or "")]
        return rows

    def equations(self, equations: Sequence[Equation], target: Callable[[str], str]) -> list[str]:
        """All equations; ``target`` gives the left side of a signal, with its type where it is to be declared."""
        rows: list[str] = []
        for equation in equations:
            if isinstance(equation, ExternalCall):
                rows += self.call(equation, target)
            else:
                rows += self.assign(target(equation.name), equation.value, self.place(equation))
        return rows

    def call(self, call: ExternalCall, target: Callable[[str], str]) -> list[str]:
        """A nested body in C: its inputs, one run, its outputs."""
        body, place = self.external(call.name), self.place(call)
        types = self.printer.types
        rows: list[str] = []
        for port, value in call.inputs:
            rows += self.assign(f"{body}.{types.field(port)}", value, place)
        rows += [f"{self.indent}{self.body_name(call)}_calculate(&{body});"]
        for port, local, _ in call.outputs:
            rows += statement(f"{target(local)} = ", f"{body}.{types.field(port)}", ";", self.indent)
        return rows
