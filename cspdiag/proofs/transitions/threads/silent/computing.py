"""What is known in a thread: the values of its expressions, which of them may fail, and how the thread ends."""

from __future__ import annotations

from itertools import product
from typing import assert_never

from cspdiag.base import Span
from cspdiag.model.types import (
    ArrayType,
    BoolType,
    EnumType,
    IntType,
    RealType,
    StructType,
    TextType,
    TimeType,
    Type,
    UnknownType,
)
from cspdiag.network.dump.action import target_text
from cspdiag.network.dump.delay import delay_text
from cspdiag.network.dump.expression import expression_text
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.expression_walk import walk
from cspdiag.network.ir.expressions import (
    Expression,
    FunctionCall,
    LiteralValue,
    ParameterValue,
    PresentTime,
    SignalValue,
    TunableValue,
    VariableValue,
)
from cspdiag.proofs.transitions.classes.built_in_exceptions import FAULT
from cspdiag.proofs.transitions.classes.program import Node
from cspdiag.proofs.transitions.occurrences import MediumFacts
from cspdiag.proofs.transitions.ranges import Range, bounds
from cspdiag.proofs.transitions.systems.labels import Time
from cspdiag.proofs.transitions.systems.references import Constant, Discard, Reference
from cspdiag.proofs.transitions.threads import frames
from cspdiag.proofs.transitions.threads.context import Context
from cspdiag.proofs.transitions.threads.frames import RISK, Risk
from cspdiag.proofs.transitions.threads.thread import Configuration, NeedsLoad, Restart, Thread
from cspdiag.proofs.transitions.values import (
    ANY,
    UNKNOWN,
    EvaluationFault,
    Known,
    is_exact,
    replaced_element,
    values_of_type,
    variables_in,
)


class Computing:
    """Evaluates the expressions of one thread, and ends it."""

    def __init__(self, thread: Thread) -> None:
        self.thread = thread

    def finished(self, configuration: Configuration) -> Configuration | None:
        """The configuration of a thread that has ended."""
        return configuration._replace(stack=(frames.Ended(), None), doomed=False, fetched=None, loaded=())

    def abandoned(self, configuration: Configuration) -> Configuration:
        """The configuration of a cancelled thread that ends here."""
        stack = configuration.stack
        while stack is not None:
            frame, stack = stack
            if isinstance(frame, frames.Leave):
                configuration = self.thread.closed(configuration, frame.context)
        return configuration._replace(stack=(frames.Ended(), None), doomed=False, fetched=None, loaded=())

    def thrown(self, configuration: Configuration, exception: str) -> Configuration:
        """The configuration after an exception: in the handler of the ``catch`` that catches it, or at the end of the
        thread.
        """
        stack = configuration.stack
        while stack is not None:
            frame, stack = stack
            match frame:
                case frames.Catch(exception=caught) if caught == exception:
                    handled = (frames.Run(frame.handler, frame.context), stack)
                    return configuration._replace(stack=handled, fetched=None, loaded=())
                case frames.Leave():
                    configuration = self.thread.closed(configuration, frame.context)
                case frames.Interrupt() if self.may_be_chosen(configuration, frame):
                    closing = (frames.Closing(frame, exception), stack)
                    return configuration._replace(stack=closing, fetched=None, loaded=())
                case _:  # Any other frame is dropped.
                    pass
        end: frames.Frame = frames.Raised(exception)
        if exception == FAULT and not (self.thread.role.outermost or self.thread.role.caught):
            end = frames.Ended() if configuration.doomed else frames.Faulted()
        return configuration._replace(stack=(end, None), doomed=False, fetched=None, loaded=())

    def may_be_chosen(self, configuration: Configuration, interrupt: frames.Interrupt) -> bool:
        """Whether an alternative of another process may choose the guard of an interrupt although the body is about to
        end by itself.
        """
        assert isinstance(interrupt.node.action, ir.InterruptOn)
        event = interrupt.node.action.branch.event
        if configuration.doomed or not isinstance(event, ir.InputEvent | ir.OutputEvent | ir.ReadyEvent):
            return False
        reference = interrupt.context.reference(event.sink if isinstance(event, ir.OutputEvent) else event.source)
        return self.thread.medium(reference).kind in ("sync", "any", "broadcast")

    def passing(self, c: Configuration, following: frames.Stack, node: Node) -> Configuration:
        """Continues with ``following``. Inside an interrupt, its guard may be taken here, as at a point where the
        process waits.
        """
        stack = following
        while stack is not None:
            if isinstance(stack[0], frames.Interrupt):
                return c.at((frames.InterruptPoint(node), following))
            stack = stack[1]
        return c.at(following)

    def cannot_fuse(self, c: Configuration) -> None:
        """Raises Restart: the value that a ready guard has read cannot be passed on to the read that follows it. In the
        next round the guard is taken without reading.
        """
        assert c.fetched is not None
        self.thread.unfused.add(c.fetched[2])
        raise Restart

    def evaluate(self, configuration: Configuration, context: Context, expression: Expression) -> Known:
        """The value of an expression. Raises NeedsLoad, through ``risk``, if the evaluation may fail where faults are
        caught.
        """
        value = self.thread.evaluate(configuration, context, expression)
        if self._may_fail(context, expression) and not (
            is_exact(value) and self._is_computed_from_exact(configuration, context, expression)
        ):
            self._risk_computing(configuration, context, expression)
        return value

    def compute_risk(self, configuration: Configuration, context: Context, expression: Expression) -> None:
        """Computes an expression whose value does not matter."""
        if self._may_fail(context, expression):
            self._risk_computing(configuration, context, expression)

    def _may_fail(self, context: Context, expression: Expression) -> bool:
        """Whether a computation may end in a fault, in a program where that makes a difference."""
        facts = self.thread.facts
        matters = facts.catches_faults or facts.specification is not None
        return matters and facts.faults.of_expression(expression, context.definition.name)

    def _is_computed_from_exact(self, configuration: Configuration, context: Context, expression: Expression) -> bool:
        """Whether all operands of an expression are known exactly, so it certainly has its value: a comparison may also
        be decided for a whole range of which a part overflows before it is compared.
        """
        return all(
            is_exact(self.thread.evaluate(configuration, context, part))
            for part in walk(expression)
            if isinstance(part, VariableValue | ParameterValue | TunableValue | PresentTime | SignalValue)
        )

    def _risk_computing(self, configuration: Configuration, context: Context, expression: Expression) -> None:
        what = _computed(expression, context)
        self.risk(configuration, what, expression.span)
        if self.thread.facts.specification is not None:
            self.thread.abstracted(f"{what} may end in a fault or not", expression.span)

    def risk(self, configuration: Configuration, what: str, span: Span | None) -> None:
        """Raises NeedsLoad if faults are caught here, and it has not been decided whether ``what`` ends in one."""
        if not self.thread.facts.catches_faults or any(loaded == RISK for loaded, _ in configuration.loaded):
            return
        if self.faults_are_caught(configuration):
            raise NeedsLoad(Risk(span, what))

    def faults_are_caught(self, configuration: Configuration) -> bool:
        """Whether a ``catch Fault`` is around what the thread does."""
        if not self.thread.facts.catches_faults:
            return False
        stack = configuration.stack
        while stack is not None:
            frame, stack = stack
            if isinstance(frame, frames.Catch) and frame.exception == FAULT:
                return True
        return self.thread.role.caught

    def outcomes(
        self, configuration: Configuration, context: Context, condition: Expression
    ) -> list[tuple[bool, Configuration]]:
        """Whether a condition holds: one answer, or several if that is left open. A variable with few values then has
        the value that decides the condition.
        """
        value = self.evaluate(configuration, context, condition)
        if value is not UNKNOWN:
            return [(bool(value), configuration)]
        open_ = self._open_variables(configuration, context, condition)
        found: list[tuple[bool, Configuration]] = []
        for values in product(*(choices for _, choices in open_)):
            given = configuration
            for (reference, _), chosen in zip(open_, values, strict=True):
                given = self.thread.with_slot(given, reference, chosen)
            decided = self.thread.evaluate(given, context, condition) if open_ else UNKNOWN
            answers = (True, False) if decided is UNKNOWN else (bool(decided),)
            found += [(answer, given) for answer in answers]
        return found

    def _open_variables(
        self, configuration: Configuration, context: Context, condition: Expression
    ) -> list[tuple[Reference, tuple[Known, ...]]]:
        """The unknown variables in a condition that have few values and are followed here."""
        found: dict[Reference, tuple[Known, ...]] = {}
        number = 1
        for variable in variables_in(condition):
            reference = context.channel(variable.channel)
            values = values_of_type(variable.type)
            if values is None or reference in found or reference in self.thread.dropped:
                continue
            if self.thread.is_shared(reference) or self.thread.slot_value(configuration, reference) is not UNKNOWN:
                continue
            number *= len(values)
            if number > 16:
                break
            found[reference] = values
        return list(found.items())

    def assigned(
        self, configuration: Configuration, context: Context, target: ir.Target, value: Known
    ) -> Configuration:
        """The configuration after an assignment to a variable or an element of it."""
        if target.channel == "":
            return configuration
        faults = self.thread.facts.faults
        if target.indexes and faults.of_target(target, context.definition.name):
            self.risk(configuration, f"`{target_text(target)}` in `{context.definition.name}`", target.indexes[0].span)
        reference = context.channel(target.channel)
        if not self.thread.medium(reference).relevant:
            _check_indexes(target, self.thread.medium(reference).type)
            return configuration
        if target.indexes:
            whole = self.thread.value_of(configuration, reference)
            indexes = tuple(self.thread.evaluate(configuration, context, index) for index in target.indexes)
            value = replaced_element(whole, indexes, value)
        return self.stored(configuration, reference, value)

    def stored(self, configuration: Configuration, reference: Reference, value: Known) -> Configuration:
        """The configuration after a value is stored in a variable; for a shared one that is the next step."""
        if isinstance(reference, Constant | Discard) or not self.thread.medium(reference).relevant:
            return configuration
        parts = self.thread.pieces(reference, value)
        if len(parts) > 1:
            choices = tuple(frames.Storing(reference, part) for part in parts)
            return configuration.at((frames.Split(choices), configuration.stack))
        (value,) = parts
        if self.thread.is_shared(reference):
            value = UNKNOWN if value == ANY else value
            self.thread.wrote(reference, value)
            return configuration.at((frames.Store(reference, value), configuration.stack))
        return self.thread.with_slot(configuration, reference, value)

    def _shown(self, c: Configuration, context: Context, medium: MediumFacts, expression: Expression) -> Known:
        """The value that a specification, or a process that is compared with one, writes to an output. A value computed
        from numbers that are not distinguished is unknown.
        """
        value = UNKNOWN if isinstance(expression, PresentTime) else self.evaluate(c, context, expression)
        if value is not UNKNOWN and not (isinstance(value, Range) and not value.copied):
            return value
        if _has_real(expression.type):
            self.risk(c, _computed(expression, context), expression.span)  # NaN and infinity are no values of outputs.
        what = "of a control law" if isinstance(expression, PresentTime) else f"of `{_as_written(expression)}`"
        self.not_shown(context, medium, what, expression.span)
        return UNKNOWN

    def not_shown(self, context: Context, medium: MediumFacts, of: str, span: Span | None) -> None:
        """Notes that a value that a specification writes is not followed, so the specification allows no particular
        value.
        """
        if self.thread.facts.specification is not None:
            output = medium.name.rpartition(".")[2]
            where = context.definition.name
            self.thread.abstracted(f"the value {of} that `{where}` writes to `{output}` is not followed", span)

    def spent(self, c: Configuration) -> Configuration:
        """The configuration after a value that a specification chooses was written: variables that hold it become
        unknown, since writing it again would have to give the same value.
        """
        if ANY not in c.variables:
            return c
        return c._replace(variables=tuple(UNKNOWN if value == ANY else value for value in c.variables))

    def takes_time(self, c: Configuration, context: Context, delay: ir.WaitStep | ir.AfterEvent) -> bool:
        """Whether a delay that begins here certainly takes time."""
        durations, duration = self.thread.facts.durations, delay.duration
        name = context.definition.name
        if durations.surely_takes_time(name, duration):
            return True
        try:
            value = self.thread.evaluate(c, context, duration)
        except (NeedsLoad, EvaluationFault):
            value = UNKNOWN
        if isinstance(value, int | Range):
            return bounds(value)[0] > 0
        if self.thread.facts.specification is None and not durations.is_over_at_once(name, duration):
            self.thread.abstracted(f"`{delay_text(delay)}` in `{name}` may be no time at all", duration.span)
        return False

    def delay(self, words: str, takes_time: Known) -> Time:
        """The label of the end of a delay."""
        return Time(words, instant=takes_time is not True)

    def offered(self, c: Configuration, context: Context, branch: ir.Branch) -> Known:
        """The value that an output guard writes, or whether a time-out certainly takes time; evaluated when the
        alternative begins.
        """
        event = branch.event
        match event:
            case ir.AfterEvent():
                self.compute_risk(c, context, event.duration)
                return self.takes_time(c, context, event)
            case ir.OutputEvent():
                reference = context.reference(event.sink)
                value = self.communicated(c, context, reference, event.value)
                return value if len(self.thread.medium(reference).pieces(value)) == 1 else UNKNOWN
            case ir.ReadyEvent() | ir.InputEvent() | ir.SkipEvent():
                return UNKNOWN
            case _:
                assert_never(event)

    def communicated(self, c: Configuration, context: Context, reference: Reference, expression: Expression) -> Known:
        """The value of an expression that is written to a medium, if values of that medium are followed."""
        medium = self.thread.medium(reference)
        if medium.relevant and medium.kind == "output":
            return self._shown(c, context, medium, expression)
        if medium.relevant and not isinstance(expression, PresentTime):
            value = self.evaluate(c, context, expression)
            return UNKNOWN if value == ANY else value
        self.compute_risk(c, context, expression)
        if self.thread.medium(reference).kind != "output":
            return UNKNOWN
        if isinstance(expression, LiteralValue):
            return expression.value
        if _has_real(expression.type):
            self.risk(c, _computed(expression, context), expression.span)  # NaN and infinity are no values of outputs.
        return UNKNOWN


def _computed(expression: Expression, context: Context) -> str:
    """A computation in words."""
    return f"`{_as_written(expression)}` in `{context.definition.name}`"


def _as_written(expression: Expression) -> str:
    """The source text of an expression, without the check that a stored value is finite."""
    if isinstance(expression, FunctionCall) and expression.function == "finite":
        (expression,) = expression.arguments
    return expression_text(expression)


def _check_indexes(target: ir.Target, kind: Type | None) -> None:
    """Raises EvaluationFault if an index is certainly out of range."""
    for index in target.indexes:
        assert isinstance(kind, ArrayType)
        number = index.value if isinstance(index, LiteralValue) else 0
        if kind.size is not None and isinstance(number, int) and not 0 <= number < kind.size:
            raise EvaluationFault(f"there is no element {number}")
        kind = kind.element


def _has_real(kind: Type) -> bool:
    match kind:
        case StructType(fields=fields):
            return any(_has_real(field) for _, field in fields)
        case ArrayType(element=element):
            return _has_real(element)
        case RealType():
            return True
        case BoolType() | IntType() | TimeType() | TextType() | EnumType() | UnknownType():
            return False
        case _:
            assert_never(kind)
