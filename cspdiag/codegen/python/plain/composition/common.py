"""The common part of all statements of a readable process: source places, and accesses to variables and ends."""

from __future__ import annotations

from dataclasses import dataclass, field

from cspdiag.base.record import record
from cspdiag.codegen.python.plain.expressions import Printer
from cspdiag.codegen.python.plain.members import Members
from cspdiag.codegen.python.text.code import (
    Code,
    awaited,
    call,
)
from cspdiag.codegen.python.text.imports import Imports
from cspdiag.codegen.python.text.statements import (
    Statement,
    Statements,
    assign,
)
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.expressions import Expression
from cspdiag.network.ir.faults import may_fault, variables_in


@record
class Method:
    """A part of a composition that runs in parallel with others, and so needs a coroutine of its own."""

    name: str
    body: Statements
    parameter: str | None = None


@dataclass
class CompositionWriter:
    """The names and printers of one process class.

    ``members`` knows the attributes. ``alternatives`` and ``methods`` collect the alternatives that the constructor
    makes, and the coroutines of branches.
    """

    members: Members
    printer: Printer
    """For expressions in ``run``."""
    initial: Printer
    """For expressions in the constructor."""
    imports: Imports
    unwritten: frozenset[str] = frozenset()
    """Variables that may be read before they are written, which is a fault."""
    alternatives: list[Statement] = field(default_factory=list)
    methods: list[Method] = field(default_factory=list)

    def _read(self, step: ir.Step, source: ir.End, target: ir.Target) -> Statement:
        value = awaited(self.members.source(source).call("read"))
        return self._set(target, value, self._place(step))

    def _set(self, target: ir.Target, value: Code, comment: str | None = None) -> Statement:
        variable = self.members.channel(target.channel).field("value")
        if not target.indexes:
            return assign(variable, value, comment)
        indexes = [self.printer.print(index) for index in target.indexes]
        return assign(variable, call(self.imports.runtime("replaced"), variable, value, *indexes), comment)

    def _place(self, action: ir.Step) -> str:
        return self.imports.names.place(action.span.file, action.span.line)

    def _place_of_fault(self, expression: Expression, action: ir.Step) -> str | None:
        """The place of an expression of an action, if it can fault."""
        if not self._may_fault(expression):
            return None
        span = expression.span or action.span
        return self.imports.names.place(span.file, span.line)

    def _may_fault(self, expression: Expression) -> bool:
        return may_fault(expression) or not self.unwritten.isdisjoint(variables_in(expression))
