"""Equations of control laws and environments as C statements, in order."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from cspdiag.base.record import record
from cspdiag.codegen.c.text.code import CSP, OR, SUM, Call, Code, address, call, cast, code, infix, negated, own
from cspdiag.codegen.c.text.expressions import Printer
from cspdiag.codegen.c.text.literals import quoted
from cspdiag.codegen.c.text.statements import If, Plain, Remark, Statement, choose, define, return_if, run, store
from cspdiag.codegen.shared.laws.equations import Equation, is_tested
from cspdiag.model.names.described import LANGUAGE
from cspdiag.model.types import is_single
from cspdiag.network.ir.declared import Declared
from cspdiag.network.ir.equations import ExternalCall
from cspdiag.network.ir.expressions import Expression, FunctionCall
from cspdiag.network.ir.network import SubmodelState

Check = Callable[[str], list[Statement]]
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
        fault_check = self.check(place or fallback_place) if evaluation.faults_inside else []
        return [*evaluation.setup, set_to(target, evaluation.code, place), *fault_check]

    def reset(self, target: Code, state: SubmodelState) -> list[Statement]:
        """A state gets its initial value again; after a fault it keeps the present one."""
        evaluation = self.printer.evaluate(state.initial)
        check = self.check(self.place(state)) if evaluation.faults_inside else []
        return evaluation.stored(target, self.printer.types.type_name(state.type), check)

    def equations(self, equations: Sequence[Equation], target: Callable[[str], Target]) -> list[Statement]:
        """All equations; ``target`` gives the left-hand side for a signal.

        Values that have to be finite are tested together, before the next equation that can fault in another way: until
        then nothing but the signals of the law has changed.
        """
        statements: list[Statement] = []
        for group in self._groups(equations):
            tested: list[tuple[Code, str]] = []
            widths = [is_single(part.type) for part in map(self._tested_part, group) if part is not None]
            together = len(widths) > 1 and len(set(widths)) == 1
            for equation in group:
                if isinstance(equation, ExternalCall):
                    statements += self.call(equation, target)
                    continue
                place, variable = self.place(equation), target(equation.name)
                part = self._tested_part(equation) if together else None
                statements += self.assign(variable, equation.value if part is None else part, place)
                if part is not None:
                    tested.append((code(variable.name) if isinstance(variable, LocalVariable) else variable, place))
            if tested:
                statements += check_finite_together(tested, self.check, single=widths[0])
        return statements

    def _groups(self, equations: Sequence[Equation]) -> list[list[Equation]]:
        """Successive equations that cannot fault, or only because their value is not finite; others are alone."""
        groups: list[list[Equation]] = []
        alone = True
        for equation in equations:
            faults = isinstance(equation, ExternalCall) or (
                self._tested_part(equation) is None and self.printer.faults(equation.value)
            )
            if faults or alone:
                groups.append([])
            groups[-1].append(equation)
            alone = faults
        return groups

    def _tested_part(self, equation: Equation) -> Expression | None:
        """The value of an equation that can fault only because this is not finite; None for other equations."""
        if isinstance(equation, ExternalCall):
            return None
        value = equation.value
        if not is_tested(value):
            return None
        assert isinstance(value, FunctionCall)
        (part,) = value.arguments
        return None if self.printer.faults(part) else part

    def call(self, called: ExternalCall, target: Callable[[str], Target]) -> list[Statement]:
        """A nested body in C: its inputs, one run, its outputs."""
        body, place = self.external(called.name), self.place(called)
        types = self.printer.types
        statements: list[Statement] = []
        for port, value in called.inputs:
            statements += self.assign(body.field(types.field(port)), value, place)
        if called.external.language == LANGUAGE:
            time = call("csp_seconds", own("now"))
            statements.append(run(call(f"{self.body_name(called)}_calculate", CSP, address(body), time)))
            statements += self.check(place) or record_fault_place(place)
        else:
            statements.append(run(call(f"{self.body_name(called)}_calculate", address(body))))
            outputs = [(body.field(types.field(port)), type_) for port, _, type_ in called.outputs]
            tests = [run(test) for value, type_ in outputs for test in types.enumerator_checks(type_, value)]
            if tests:
                statements += [*tests, *(self.check(place) or record_fault_place(place))]
        for port, local, _ in called.outputs:
            statements.append(set_to(target(local), body.field(types.field(port))))
        return statements


def set_to(target: Target, value: Code, remark: str | None = None) -> Plain:
    """The statement that gives a variable its value."""
    if isinstance(target, LocalVariable):
        return define(target.type_name, target.name, value, remark)
    return store(target, value, remark)


def end_if_faulted(place: str) -> list[Statement]:
    """The check for a fault in a function that returns whether it succeeded."""
    return [return_if(call("csp_faulted_at", quoted(place)), "false")]


def leave_if_faulted(place: str) -> list[Statement]:
    """The check for a fault in a function without a result, whose caller checks for one."""
    return [return_if(call("csp_faulted_at", quoted(place)))]


def without_last_return(statements: Sequence[Statement]) -> list[Statement]:
    """The body of such a function, whose last check for a fault need not return."""
    match statements:
        case [*before, If(condition=Call(function="csp_faulted_at", arguments=arguments), otherwise=())]:
            return [*before, Plain(Call("csp_fault_in", arguments))]
        case [*before, If(otherwise=()) as last]:
            return [*before, If(last.condition, tuple(without_last_return(last.then)))]
        case _:  # Any other body.
            return list(statements)


def record_fault_place(place: str) -> list[Statement]:
    """The statement that records the place of a fault, for functions that do not return whether they failed: their
    callers check.
    """
    return [run(call("csp_fault_in", quoted(place)))] if place else []


def check_finite_together(
    values: Sequence[tuple[Code, str]], check: Check, *, may_have_faulted: bool = False, single: bool = False
) -> list[Statement]:
    """The check that all of several values are finite: one test, and those of each only if that fails.

    ``values`` have the place at which the fault of each is reported. ``may_have_faulted`` if a fault may have been
    noted before; ``single`` if they are floats.
    """
    total, last = values[0][0], values[-1][1]
    for value, _ in values[1:]:
        total = infix("+", SUM, total, value)
    doubtful = negated(call("csp_is_finite_single" if single else "csp_is_finite", total))
    if may_have_faulted:
        doubtful = infix("||", OR, call("csp_faulted"), doubtful)
    each = [
        run(call("csp_finite_at", cast("double", value) if single else value, quoted(place))) for value, place in values
    ]
    remark = Remark("A sum is finite only if its terms are.") if len(values) > 1 else None
    return [*([remark] if remark else []), *choose(doubtful, [*each, *check(last)])]
