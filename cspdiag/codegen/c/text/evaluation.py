"""When operands are evaluated: what has to be done before a statement, so that faults come in the order of the text."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import count

from cspdiag.base.record import record
from cspdiag.codegen.c.text.code import (
    Atom,
    Code,
    assign,
    call,
    in_order,
)
from cspdiag.codegen.c.text.statements import Statement, define, run
from cspdiag.codegen.c.text.types import CTypes
from cspdiag.model.types import Type
from cspdiag.network.ir.expressions import (
    Expression,
    VariableValue,
)
from cspdiag.network.ir.faults import (
    may_fault,
    variables_in,
)


def _unexpected(name: str) -> Code:
    raise LookupError(f"{name} cannot be used here")


def _sure(_: str) -> None:
    return None


@record
class Evaluation:
    """An expression in C: what has to be done before the statement in which it stands, and whether it can note a fault
    itself.
    """

    setup: tuple[Statement, ...]
    code: Code
    late: bool

    @property
    def faults(self) -> bool:
        """Whether a fault may have been noted when it has been evaluated."""
        return self.late or bool(self.setup)


@dataclass
class _Progress:
    """What was printed since the last evaluation began."""

    setup: list[Statement] = field(default_factory=list)
    inside: list[Code] | None = None
    """What has to be done first where no statement can stand, because it is evaluated only sometimes."""
    unsure: bool = False
    """Whether it is looked inside an expression whether a variable was written."""
    numbers: Iterator[int] = field(default_factory=lambda: count(1))


@dataclass(frozen=True)
class Evaluator:
    """Evaluates the expressions of one class; the functions give the C lvalue of a name where the expression stands.

    C does not say which operand comes first, so operands that can fault are evaluated before the statement, in their
    order, where there is more than one. ``written`` gives a pointer to the flag whether a variable was written, where
    that is not sure.
    """

    types: CTypes
    parameter: Callable[[str], Code] = _unexpected
    signal: Callable[[str], Code] = _unexpected
    variable: Callable[[str], Code] = _unexpected
    written: Callable[[str], Code | None] = _sure
    seconds: Callable[[str], Code] | None = None
    """A parameter of type ``time`` in seconds."""
    time: str | None = None
    constants_by_value: bool = False
    """For static initializers, which C wants to be made of literals."""
    progress: _Progress = field(default_factory=_Progress)

    def evaluate(self, expression: Expression) -> Evaluation:
        """The expression at the place of a statement."""
        return self._evaluated(expression, self._print)

    def opposite(self, condition: Expression) -> Evaluation:
        """The opposite of a condition."""
        return self._evaluated(condition, self._negated)

    def _evaluated(self, expression: Expression, made: Callable[[Expression], Code]) -> Evaluation:
        progress = self.progress
        progress.setup.clear()
        progress.unsure = False
        code = made(expression)
        return Evaluation(tuple(progress.setup), code, progress.unsure or may_fault(expression))

    def plain(self, expression: Expression) -> Code:
        """An expression before which nothing has to be done."""
        evaluation = self.evaluate(expression)
        assert not evaluation.setup, "it stands where no statement can be put in front"
        return evaluation.code

    def arguments(self, expressions: Sequence[Expression]) -> tuple[list[Statement], list[Code]]:
        """Several expressions in one statement, and what has to be done before it."""
        self.progress.setup.clear()
        codes = self._in_order(expressions)
        return list(self.progress.setup), codes

    def faults(self, expression: Expression) -> bool:
        """Whether the evaluation of an expression can note a fault."""
        if may_fault(expression):
            return True
        return any(self.written(channel) is not None for channel in variables_in(expression))

    def _print(self, expression: Expression) -> Code:
        """The C expression; it has the C type of the type of ``expression``."""
        raise NotImplementedError

    def _negated(self, condition: Expression) -> Code:
        """The opposite of a condition."""
        raise NotImplementedError

    def _variable(self, channel: str) -> Code:
        flag = self.written(channel)
        if flag is not None:
            required, progress = call("csp_require_written", flag), self.progress
            if progress.inside is not None:
                progress.unsure = True
                progress.inside.append(required)
            elif run(required) not in progress.setup:
                progress.setup.append(run(required))
        return self.variable(channel)

    def _in_order(self, expressions: Sequence[Expression]) -> list[Code]:
        """The operands, so that faults come in order: of those that can fault only the last stays in place."""
        faulting = [position for position, part in enumerate(expressions) if self.faults(part)]
        return [
            self._kept(part) if position in faulting[:-1] else self._print(part)
            for position, part in enumerate(expressions)
        ]

    def _kept(self, expression: Expression) -> Code:
        """The value of an operand, known before the operands behind it are evaluated."""
        code = self._print(expression)
        return code if isinstance(expression, VariableValue) else self._stored(code, expression.type)

    def _stored(self, code: Code, type_: Type) -> Code:
        progress = self.progress
        name, kind = f"csp_operand_{next(progress.numbers)}", self.types.type_name(type_)
        if progress.inside is None:
            progress.setup.append(define(f"const {kind}", name, code))
        else:
            progress.setup.append(define(kind, name))
            progress.inside.append(assign(name, code))
        return Atom(name)

    def _sometimes(self, expression: Expression) -> Code:
        """An operand that is not always evaluated: what has to be done first is a part of it."""
        progress = self.progress
        outer = progress.inside
        before: list[Code] = []
        progress.inside = before
        code = self._print(expression)
        progress.inside = outer
        return in_order((*before, code))
