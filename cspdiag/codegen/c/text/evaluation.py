"""The order in which operands are evaluated, so that faults occur in the order of the source text."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
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
from cspdiag.codegen.c.text.statements import Statement, define, in_block, run, store
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


def _always_written(_: str) -> None:
    return None


@record
class Evaluation:
    """An expression in C: the statements before the one that contains it, and whether it can note a fault itself."""

    setup: tuple[Statement, ...]
    code: Code
    faults_inside: bool

    @property
    def faults(self) -> bool:
        """Whether a fault may have been noted once it has been evaluated."""
        return self.faults_inside or bool(self.setup)

    def stored(self, target: Code, type_name: str, check: Sequence[Statement]) -> list[Statement]:
        """Stores the value, after a ``check`` for faults; after a fault the target keeps what it had."""
        if not self.faults_inside:
            return in_block([*self.setup, *check, store(target, self.code)])
        result = define(f"const {type_name}", "csp_result", self.code)
        return in_block([*self.setup, result, *check, store(target, "csp_result")])


@dataclass
class _Progress:
    """What has been written since the present evaluation began."""

    setup: list[Statement] = field(default_factory=list)
    inside: list[Code] | None = None
    """The expressions to evaluate first within an operand that is evaluated only sometimes, where no statement is
    possible; None outside of such operands.
    """
    has_inner_check: bool = False
    """Whether an expression itself checks that a variable was written."""
    numbers: Iterator[int] = field(default_factory=lambda: count(1))


@dataclass(frozen=True)
class Evaluator:
    """Evaluates the expressions of one class; the functions give the C lvalue of a name.

    C does not define the order of operands, so if several operands can fault, all but the last of them are evaluated
    before the statement, in order. ``written`` gives a pointer to the flag whether a variable was written, or None if
    it always is before it is read.
    """

    types: CTypes
    parameter: Callable[[str], Code] = _unexpected
    signal: Callable[[str], Code] = _unexpected
    variable: Callable[[str], Code] = _unexpected
    written: Callable[[str], Code | None] = _always_written
    program: Callable[[str], Code] = _unexpected
    """A pointer to a parameter of the program, in an environment."""
    seconds: Callable[[str, bool], Code] | None = None
    """A parameter of type ``time`` in seconds, as a double or else as a float."""
    time: str | None = None
    constants: Mapping[str, str] = field(default_factory=dict)
    """The C names of constants besides those of the program."""
    constants_by_value: bool = False
    """For static initializers, which have to be constant expressions in C."""
    progress: _Progress = field(default_factory=_Progress)

    def evaluate(self, expression: Expression) -> Evaluation:
        """The C code of an expression that is part of a statement."""
        return self._evaluate(expression, self._print)

    def opposite(self, condition: Expression) -> Evaluation:
        """The negation of a condition."""
        return self._evaluate(condition, self._negated)

    def _evaluate(self, expression: Expression, made: Callable[[Expression], Code]) -> Evaluation:
        progress = self.progress
        progress.setup.clear()
        progress.has_inner_check = False
        code = made(expression)
        return Evaluation(tuple(progress.setup), code, progress.has_inner_check or may_fault(expression))

    def plain(self, expression: Expression) -> Code:
        """An expression that needs no statements before it."""
        evaluation = self.evaluate(expression)
        assert not evaluation.setup, "no statement is possible before it"
        return evaluation.code

    def arguments(self, expressions: Sequence[Expression]) -> tuple[list[Statement], list[Code]]:
        """Several expressions of one statement, and the statements before it."""
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
        """The negation of a condition."""
        raise NotImplementedError

    def _variable(self, channel: str) -> Code:
        flag = self.written(channel)
        if flag is not None:
            required, progress = call("csp_require_written", flag), self.progress
            if progress.inside is not None:
                progress.has_inner_check = True
                progress.inside.append(required)
            elif run(required) not in progress.setup:
                progress.setup.append(run(required))
        return self.variable(channel)

    def _in_order(self, expressions: Sequence[Expression]) -> list[Code]:
        """The operands; of those that can fault, all but the last are evaluated before the statement, in order."""
        faulting = [position for position, part in enumerate(expressions) if self.faults(part)]
        return [
            self._saved(part) if position in faulting[:-1] else self._print(part)
            for position, part in enumerate(expressions)
        ]

    def _saved(self, expression: Expression) -> Code:
        """The value of an operand, saved before the operands after it are evaluated."""
        code = self._print(expression)
        return code if isinstance(expression, VariableValue) else self._save(code, expression.type)

    def _save(self, code: Code, type_: Type) -> Code:
        progress = self.progress
        name, kind = f"csp_operand_{next(progress.numbers)}", self.types.type_name(type_)
        if progress.inside is None:
            progress.setup.append(define(f"const {kind}", name, code))
        else:
            progress.setup.append(define(kind, name))
            progress.inside.append(assign(name, code))
        return Atom(name)

    def _as_texts(self, *expressions: Expression) -> list[Code]:
        """How expressions would be written, without what has to be evaluated before them."""
        progress = self.progress
        setup, inside = [*progress.setup], progress.inside
        progress.inside = None if inside is None else [*inside]
        codes = [self._print(expression) for expression in expressions]
        progress.setup[:], progress.inside = setup, inside
        return codes

    def _conditionally_evaluated(self, expression: Expression) -> Code:
        """An operand that is not always evaluated, with everything that has to be evaluated before it inside."""
        progress = self.progress
        outer = progress.inside
        before: list[Code] = []
        progress.inside = before
        code = self._print(expression)
        progress.inside = outer
        return in_order((*before, code))
