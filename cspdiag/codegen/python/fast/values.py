"""The common part of all statements of one optimized process: source places, values, variables."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field

from cspdiag.base import Span
from cspdiag.codegen.python.fast.communications import Communications
from cspdiag.codegen.python.fast.expressions import FastPrinter
from cspdiag.codegen.python.fast.spelling import Spelling
from cspdiag.codegen.python.fast.statements import assigned
from cspdiag.codegen.python.plain.external import ExternalModules
from cspdiag.codegen.python.text.code import SELF, Code, call
from cspdiag.codegen.python.text.imports import Imports
from cspdiag.codegen.python.text.statements import Remark, Statement, Statements, assign
from cspdiag.network.ir.actions import Action, InputEvent, ReadValue, Step, Target
from cspdiag.network.ir.declared import Declared
from cspdiag.network.ir.expressions import Expression, LiteralValue, ParameterValue, SignalValue, VariableValue

_LONGEST_COMMENT = 70
_LONGEST_SIMPLE = 40


@dataclass
class Values:
    """The names, printers and communications of one process class."""

    spelling: Spelling
    communications: Communications
    printer: FastPrinter
    initial: FastPrinter
    """For expressions in the constructor."""
    imports: Imports
    modules: ExternalModules
    prologue: list[Statement] = field(default_factory=list)
    """What is computed once, before the process begins."""
    process: Code = SELF
    """The process or law that is executed here."""

    def statements(self, action: Action) -> Statements:
        """An action as statements."""
        raise NotImplementedError

    def set_current_task(self) -> Statements:
        """Tell the scheduler which task runs, before a call of the runtime that may need it."""
        return self.communications.set_current_task()

    def place(self, action: Step) -> str:
        """The place of an action in the text."""
        return self.imports.names.place(action.span.file, action.span.line)

    def place_of(self, item: Declared) -> str:
        """The place of a declaration in the text."""
        return self.imports.names.place(item.span.file, item.span.line)

    def comment(self, action: Step, what: str | None = None) -> Statement:
        """The place and the text of an action as a comment."""
        return Remark(f"{self.place(action)}  {one_line(action.span) if what is None else what}".rstrip())

    def set(self, target: Target, value: Expression, place: str) -> Iterable[Statement]:
        """Assign a variable, or an element of it."""
        name = self.spelling.variable(target.channel)
        if not target.indexes:
            yield from assigned(name, self.printer, value, place)
        else:
            yield self.replaced(target, self.printer.print(value), place)

    def replaced(self, target: Target, value: Code, place: str | None = None) -> Statement:
        """Assign an element of a variable."""
        variable = self.spelling.variable(target.channel)
        indexes = [self.printer.print(index) for index in target.indexes]
        return assign(variable, call(self.imports.runtime("replaced"), variable, value, *indexes), place)

    def read_into(self, step: ReadValue | InputEvent, read: Callable[[Code], Statements]) -> Statements:
        """Read into a variable or an element of it; ``read`` gives the statements for a target."""
        if not step.target.indexes:
            return read(self.spelling.variable(step.target.channel))
        value = self.spelling["value"]
        return (*read(value), self.replaced(step.target, value, self.place(step)))

    def simple(self, value: Expression) -> tuple[Statements, Code]:
        """A value as a name or a literal, and the statements that have to compute it before."""
        if isinstance(value, LiteralValue | ParameterValue | SignalValue) or (
            isinstance(value, VariableValue) and self.spelling.is_local(value.channel)
        ):
            code = self.printer.print(value)
            if len(code.flat) < _LONGEST_SIMPLE:
                return (), code
        name = self.spelling["value"]
        return tuple(assigned(name, self.printer, value, None)), name


def one_line(span: Span) -> str:
    """The text at a place on one line, truncated if it is long."""
    joined = " ".join(span.text.split())
    return joined if len(joined) <= _LONGEST_COMMENT else f"{joined[:_LONGEST_COMMENT]}..."
