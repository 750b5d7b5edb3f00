"""Equations of control laws and environments as C statements, in order."""

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
"""From the place of a statement to the statements that check for a fault after it."""


@record
class LocalVariable:
    """A local variable that a statement defines."""

    type_name: str
    name: str


Target = Code | LocalVariable


@record
class EquationWriter:
    """Writes assignments. ``place`` gives the place of a declaration in the source text, ``external`` the lvalue of a
    nested body in C.
    """

    printer: Printer
    place: Callable[[Declared], str]
    check: Check
    external: Callable[[str], Code]
    body_name: Callable[[ExternalCall], str]

    def assign(self, target: Target, value: Expression, place: str | None, fallback_place: str = "") -> list[Statement]:
        """``target = value;``, preceded by the statements that the value needs and followed by a check if it can fault.

        Faults are reported at ``place``, or at ``fallback_place`` if the assignment has no place of its own.
        """
        evaluation = self.printer.evaluate(value)
        fault_check = self.check(place or fallback_place) if evaluation.faults else []
        return [*evaluation.setup, set_to(target, evaluation.code, place), *fault_check]

    def equations(self, equations: Sequence[Equation], target: Callable[[str], Target]) -> list[Statement]:
        """All equations; ``target`` gives the left-hand side for a signal."""
        statements: list[Statement] = []
        for equation in equations:
            if isinstance(equation, ExternalCall):
                statements += self.call(equation, target)
            else:
                statements += self.assign(target(equation.name), equation.value, self.place(equation))
        return statements

    def call(self, called: ExternalCall, target: Callable[[str], Target]) -> list[Statement]:
        """A nested body in C: its inputs, one run, its outputs."""
        body, place = self.external(called.name), self.place(called)
        types = self.printer.types
        statements: list[Statement] = []
        for port, value in called.inputs:
            statements += self.assign(body.field(types.field(port)), value, place)
        statements.append(run(call(f"{self.body_name(called)}_calculate", address(body))))
        for port, local, _ in called.outputs:
            statements.append(set_to(target(local), body.field(types.field(port))))
        return statements


def set_to(target: Target, value: Code, remark: str | None = None) -> Plain:
    """The statement that gives a variable its value."""
    if isinstance(target, LocalVariable):
        return define(target.type_name, target.name, value, remark)
    return store(target, value, remark)


def record_fault_place(place: str) -> list[Plain]:
    """The statement that records the place of a fault, for functions that do not return whether they failed: their
    callers check.
    """
    return [run(call("csp_fault_in", quoted(place)))] if place else []
