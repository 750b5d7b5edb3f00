"""Equations of control laws and environments as C statements, one after the other."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from cspdiag.base.record import record
from cspdiag.codegen.c.text.code import Code, address, call
from cspdiag.codegen.c.text.expressions import Printer
from cspdiag.codegen.c.text.literals import quoted
from cspdiag.codegen.c.text.statements import Plain, Statement, define, run, store
from cspdiag.codegen.shared.equations import Equation
from cspdiag.network.ir.declared import Declared
from cspdiag.network.ir.equations import ExternalCall
from cspdiag.network.ir.expressions import Expression

Check = Callable[[str], list[Plain]]
"""From the place of a statement to what looks for a fault behind it."""


@record
class LocalVariable:
    """A local variable that a statement defines."""

    type_name: str
    name: str


Target = Code | LocalVariable


@record
class EquationWriter:
    """Prints assignments. ``place`` says where something stands in the text; ``external`` gives the lvalue of a nested
    body in C.
    """

    printer: Printer
    place: Callable[[Declared], str]
    check: Check
    external: Callable[[str], Code]
    body_name: Callable[[ExternalCall], str]

    def assign(self, target: Target, value: Expression, place: str | None, fault_at: str = "") -> list[Statement]:
        """``target = value;`` with what has to be done before it, and a look for a fault behind it where there may be
        one.
        """
        found = self.printer.evaluate(value)
        look = self.check(place or fault_at) if found.faults else []
        return [*found.setup, set_to(target, found.code, place), *look]

    def equations(self, equations: Sequence[Equation], target: Callable[[str], Target]) -> list[Statement]:
        """All equations; ``target`` gives the left side of a signal."""
        found: list[Statement] = []
        for equation in equations:
            if isinstance(equation, ExternalCall):
                found += self.call(equation, target)
            else:
                found += self.assign(target(equation.name), equation.value, self.place(equation))
        return found

    def call(self, called: ExternalCall, target: Callable[[str], Target]) -> list[Statement]:
        """A nested body in C: its inputs, one run, its outputs."""
        body, place = self.external(called.name), self.place(called)
        types = self.printer.types
        found: list[Statement] = []
        for port, value in called.inputs:
            found += self.assign(body.field(types.field(port)), value, place)
        found.append(run(call(f"{self.body_name(called)}_calculate", address(body))))
        for port, local, _ in called.outputs:
            found.append(set_to(target(local), body.field(types.field(port))))
        return found


def set_to(target: Target, value: Code, remark: str | None = None) -> Plain:
    """The statement that gives a variable its value."""
    if isinstance(target, LocalVariable):
        return define(target.type_name, target.name, value, remark)
    return store(target, value, remark)


def noted_at(place: str) -> list[Plain]:
    """The look for a fault in a function that does not report whether it has failed: its caller looks again."""
    return [run(call("csp_fault_in", quoted(place)))] if place else []
