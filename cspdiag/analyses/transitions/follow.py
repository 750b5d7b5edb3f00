"""The silent steps of a thread: what it does on its own, without a choice, until it comes to something that others take part in or may see."""

from __future__ import annotations

from collections.abc import Callable
from itertools import product

from cspdiag.analyses.transitions.facts import FAULT
from cspdiag.analyses.transitions.occurrences import PATIENT
from cspdiag.analyses.transitions.program import Node
from cspdiag.analyses.transitions.template import Reference
from cspdiag.analyses.transitions.thread import Configuration, Context, NeedsLoad, Restart, Stack, Thread
from cspdiag.analyses.transitions.values import (
    UNKNOWN,
    EvaluationFault,
    Known,
    replaced_element,
    values_of_type,
    variables_in,
)
from cspdiag.diagnostics import Span
from cspdiag.model.types import ArrayType, RealType, StructType, Type
from cspdiag.network.actions import (
    AfterEvent,
    AssignValue,
    Branch,
    CatchException,
    Choice,
    Group,
    IfElse,
    InputEvent,
    InterruptOn,
    OutputEvent,
    ParallelSteps,
    RaiseException,
    ReadValue,
    ReadyEvent,
    Repeat,
    ResetInstance,
    RunInstance,
    SequentialSteps,
    SkipStep,
    StopStep,
    Target,
    WaitStep,
    WhileLoop,
    WriteValue,
)
from cspdiag.network.expressions import Expression, LiteralValue, PresentTime
from cspdiag.network.ir import Connection, ExternalCall, SubmodelClass

_MANY_STEPS = 5_000
"""After so many silent steps the variables that change are not followed any longer."""
RISK = ("risk",)
"""Stands for a shared variable that is loaded: the fault that a step may end in, which it does not."""


POINTS = frozenset({"run", "put", "delivering", "choice", "reading", "writing", "foreign", "foreign port"})
"""What may be first on the stack where a cancelled or interrupted process ends."""


class Follower:
    """Takes the silent steps of one thread."""

    def __init__(self, thread: Thread) -> None:
        self.thread = thread

    def settled(self, start: Configuration) -> Configuration:
        """Where the thread is once it can do nothing more on its own. A circle of silent steps ends in a frame ``diverges``."""
        configuration = start
        seen: dict[Configuration, None] = {}
        steps = 0
        while True:
            following = self._step(configuration)
            if following is None:
                stack = configuration.stack
                if not configuration.doomed or stack is None or stack[0][0] not in POINTS:
                    return configuration
                following = self.abandoned(configuration)
            configuration = following
            steps += 1
            if steps > 32:
                if configuration in seen:
                    return configuration._replace(stack=(("diverges",), configuration.stack))
                seen[configuration] = None
            if steps > _MANY_STEPS:
                if not self.thread.give_up(seen):
                    return configuration._replace(stack=(("diverges",), configuration.stack))
                raise Restart

    def _step(self, configuration: Configuration) -> Configuration | None:
        """One silent step, None if there is none."""
        stack = configuration.stack
        if stack is None:
            return self.finished(configuration)
        frame, rest = stack
        try:
            if frame[0] == "run":
                step = _STEPS[type(frame[1].action)]
                return step(self, configuration, frame[1], frame[2], rest)
            pop = _FRAMES.get(frame[0])
            return None if pop is None else pop(self, configuration, frame, rest)
        except NeedsLoad as needed:
            return configuration._replace(stack=(("load", needed.reference), stack))
        except EvaluationFault:
            return self.thrown(configuration, FAULT)

    # -- ends

    def finished(self, configuration: Configuration) -> Configuration | None:
        """The thread has come to its end."""
        return configuration._replace(stack=(("ended",), None), doomed=False, fetched=None, loaded=())

    def abandoned(self, configuration: Configuration) -> Configuration:
        """A cancelled thread ends at this point of its composition."""
        stack = configuration.stack
        while stack is not None:
            frame, stack = stack
            if frame[0] == "leave":
                configuration = self.thread.closed(configuration, frame[1])
        return configuration._replace(stack=(("ended",), None), doomed=False, fetched=None, loaded=())

    def thrown(self, configuration: Configuration, exception: str) -> Configuration:
        """An exception goes up to who catches it, or ends the thread."""
        stack = configuration.stack
        while stack is not None:
            frame, stack = stack
            if frame[0] == "catch" and frame[1] == exception:
                handler = ("run", frame[2], frame[3])
                return configuration._replace(stack=(handler, stack), fetched=None, loaded=())
            if frame[0] == "leave":
                configuration = self.thread.closed(configuration, frame[1])
        end = ("ended",) if configuration.doomed else ("raised", exception)
        if exception == FAULT and not (self.thread.role.outermost or self.thread.role.caught):
            end = ("faulted",)
        return configuration._replace(stack=(end, None), doomed=False, fetched=None, loaded=())

    # -- values

    def evaluate(self, configuration: Configuration, context: Context, expression: Expression) -> Known:
        """A value; where faults are caught, an evaluation that may fail is first seen to ``risk`` it."""
        value = self.thread.evaluate(configuration, context, expression)
        if value is UNKNOWN:
            self._compute_risk(configuration, context, expression)
        return value

    def _compute_risk(self, configuration: Configuration, context: Context, expression: Expression) -> None:
        """Computes an expression whose value does not matter."""
        if self.thread.facts.catches_faults and self.thread.facts.faults.of_expression(
            expression, context.definition.name
        ):
            self._risk(configuration, expression.span)

    def _risk(self, configuration: Configuration, span: Span | None) -> None:
        """A step that may end in a fault, where faults are caught."""
        if any(loaded == RISK for loaded, _ in configuration.loaded):
            return
        if self.faults_are_caught(configuration):
            raise NeedsLoad((*RISK, span))

    def faults_are_caught(self, configuration: Configuration) -> bool:
        """Whether a ``catch Fault`` is around what the thread does."""
        if not self.thread.facts.catches_faults:
            return False
        stack = configuration.stack
        while stack is not None:
            frame, stack = stack
            if frame[0] == "catch" and frame[1] == FAULT:
                return True
        return self.thread.role.caught

    def outcomes(
        self, configuration: Configuration, context: Context, condition: Expression
    ) -> list[tuple[bool, Configuration]]:
        """Whether a condition holds: one answer, or several where that is left open; a variable of few values is then given the one that decides."""
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
            reference = ("channel", context.path, variable.channel)
            values = values_of_type(variable.type)
            if values is None or reference in found or reference in self.thread.widened:
                continue
            if self.thread.is_shared(reference) or self.thread.slot_value(configuration, reference) is not UNKNOWN:
                continue
            number *= len(values)
            if number > 16:
                break
            found[reference] = values
        return list(found.items())

    def assigned(self, configuration: Configuration, context: Context, target: Target, value: Known) -> Configuration:
        """A variable, or an element of it, is given a value."""
        if target.channel == "":
            return configuration
        reference = ("channel", context.path, target.channel)
        if not self.thread.medium(reference).relevant:
            return configuration
        if target.indexes:
            whole = self.thread.value_of(configuration, reference)
            indexes = tuple(self.thread.evaluate(configuration, context, index) for index in target.indexes)
            value = replaced_element(whole, indexes, value)
        return self.stored(configuration, reference, value)

    def _assigning(self, c: Configuration, frame: tuple[object, ...], rest: Stack) -> Configuration | None:
        """What was read goes into its variable."""
        _, context, target, value = frame
        assert isinstance(context, Context)
        assert isinstance(target, Target)
        return self.assigned(c._replace(stack=rest), context, target, value)._replace(loaded=())  # type: ignore[arg-type]

    def stored(self, configuration: Configuration, reference: Reference, value: Known) -> Configuration:
        """A variable is given a value; a shared one at the next step."""
        if reference[0] in ("constant", "discard") or not self.thread.medium(reference).relevant:
            return configuration
        if self.thread.is_shared(reference):
            self.thread.wrote(reference, value)
            return configuration._replace(stack=(("store", reference, value), configuration.stack))
        return self.thread.with_slot(configuration, reference, value)

    # -- actions; each is given the stack below it

    def _sequence(self, c: Configuration, node: Node, context: Context, rest: Stack) -> Configuration | None:
        for child in reversed(node.children):
            rest = (("run", child, context), rest)
        return c._replace(stack=rest)

    def _nothing(self, c: Configuration, node: Node, context: Context, rest: Stack) -> Configuration | None:
        return c._replace(stack=rest)

    def _assign(self, c: Configuration, node: Node, context: Context, rest: Stack) -> Configuration | None:
        action = node.action
        assert isinstance(action, AssignValue)
        if not self.thread.medium(("channel", context.path, action.target.channel)).relevant:
            self._compute_risk(c, context, action.value)
            return c._replace(stack=rest, loaded=())
        value = self.evaluate(c, context, action.value)
        return self.assigned(c._replace(stack=rest), context, action.target, value)._replace(loaded=())

    def _read(self, c: Configuration, node: Node, context: Context, rest: Stack) -> Configuration | None:
        action = node.action
        assert isinstance(action, ReadValue)
        reference = context.reference(action.source)
        if self.thread.medium(reference).kind in PATIENT:
            if c.fetched is not None:
                if c.fetched[0] != reference:
                    self.cannot_fuse(c)
                value = c.fetched[1]
                return self.assigned(c._replace(stack=rest, fetched=None), context, action.target, value)
            return self.abandoned(c) if c.doomed else None
        value = UNKNOWN
        if self._target_relevant(context, action.target):
            value = self.thread.value_of(c, reference)
        faults = self.thread.facts.faults
        if value is UNKNOWN and faults.of_read(action.source, context.definition.name):
            self._risk(c, action.span)
        return self.assigned(c._replace(stack=rest), context, action.target, value)._replace(loaded=())

    def _target_relevant(self, context: Context, target: Target) -> bool:
        return bool(target.channel) and self.thread.medium(("channel", context.path, target.channel)).relevant

    def _write(self, c: Configuration, node: Node, context: Context, rest: Stack) -> Configuration | None:
        action = node.action
        assert isinstance(action, WriteValue)
        reference = context.reference(action.sink)
        kind = self.thread.medium(reference).kind
        if kind not in ("var", "discard"):
            if c.fetched is not None and kind != "output":
                self.cannot_fuse(c)
            if c.doomed:
                return self.abandoned(c)
            value = self.communicated(c, context, reference, action.value)
            return c._replace(stack=(("put", reference, value, node), rest), loaded=())
        if kind == "var" and self.thread.medium(reference).relevant:
            value = self.evaluate(c, context, action.value)
            return self.stored(c._replace(stack=rest), reference, value)._replace(loaded=())
        return c._replace(stack=rest, loaded=())

    def _wait(self, c: Configuration, node: Node, context: Context, rest: Stack) -> Configuration | None:
        if not c.doomed:
            assert isinstance(node.action, WaitStep)
            self._compute_risk(c, context, node.action.duration)
        return self._point(c, node, context, rest)

    def _point(self, c: Configuration, node: Node, context: Context, rest: Stack) -> Configuration | None:
        """What waits: a cancelled process ends there."""
        if c.fetched is not None:
            self.cannot_fuse(c)
        return self.abandoned(c) if c.doomed else None

    def _raise(self, c: Configuration, node: Node, context: Context, rest: Stack) -> Configuration | None:
        action = node.action
        assert isinstance(action, RaiseException)
        return self.thrown(c, action.exception)

    def _repeat(self, c: Configuration, node: Node, context: Context, rest: Stack) -> Configuration | None:
        return c._replace(stack=(("run", node.children[0], context), (("again", node, context), rest)))

    def _again(self, c: Configuration, frame: tuple[object, ...], rest: Stack) -> Configuration | None:
        _, node, context = frame
        assert isinstance(node, Node)
        assert isinstance(context, Context)
        assert isinstance(node.action, Repeat)
        until = node.action.until
        if until is None:
            return c._replace(stack=(("run", node, context), rest))
        return self._decided(c, context, until, rest, (("run", node, context), rest))

    def _while(self, c: Configuration, node: Node, context: Context, rest: Stack) -> Configuration | None:
        assert isinstance(node.action, WhileLoop)
        again = (("run", node.children[0], context), (("run", node, context), rest))
        return self._decided(c, context, node.action.condition, again, rest)

    def _if(self, c: Configuration, node: Node, context: Context, rest: Stack) -> Configuration | None:
        assert isinstance(node.action, IfElse)
        then, otherwise = ((("run", child, context), rest) for child in node.children)
        return self._decided(c, context, node.action.condition, then, otherwise)

    def _decided(
        self, c: Configuration, context: Context, condition: Expression, then: Stack, otherwise: Stack
    ) -> Configuration | None:
        found = self.outcomes(c, context, condition)
        if len(found) > 1:
            return c._replace(stack=(("open", context, condition, then, otherwise), None))
        ((holds, given),) = found
        return given._replace(stack=then if holds else otherwise, loaded=())

    def _catch(self, c: Configuration, node: Node, context: Context, rest: Stack) -> Configuration | None:
        assert isinstance(node.action, CatchException)
        body, handler = node.children
        return c._replace(stack=(("run", body, context), (("catch", node.action.exception, handler, context), rest)))

    def _choice(self, c: Configuration, node: Node, context: Context, rest: Stack) -> Configuration | None:
        if c.doomed:
            return self.abandoned(c)
        assert isinstance(node.action, Choice)
        if c.fetched is not None and not all(
            isinstance(branch.event, ReadyEvent | InputEvent) and context.reference(branch.event.source) == c.fetched[0]
            for branch in node.action.branches
        ):
            self.cannot_fuse(c)
        return c._replace(stack=(("deciding", node, context, ()), rest))

    def _deciding(self, c: Configuration, frame: tuple[object, ...], rest: Stack) -> Configuration | None:
        """The conditions of the guards one after the other: None, or a pair with what the guard will write."""
        _, node, context, decided = frame
        assert isinstance(node, Node)
        assert isinstance(context, Context)
        assert isinstance(node.action, Choice)
        assert isinstance(decided, tuple)
        branches = node.action.branches
        if len(decided) == len(branches):
            return c._replace(stack=(("choice", node, context, decided), rest))
        branch = branches[len(decided)]
        held = c._replace(stack=rest)
        if branch.condition is not None:
            found = self.outcomes(c, context, branch.condition)
            no = (("deciding", node, context, (*decided, None)), rest)
            if len(found) > 1:
                yes = (("offering", node, context, decided), rest)
                return c._replace(stack=(("open", context, branch.condition, yes, no), None))
            ((holds, held),) = found
            if not holds:
                return held._replace(stack=no, loaded=())
        return held._replace(stack=(("offering", node, context, decided), rest), loaded=c.loaded)

    def _offering(self, c: Configuration, frame: tuple[object, ...], rest: Stack) -> Configuration | None:
        _, node, context, decided = frame
        assert isinstance(node, Node)
        assert isinstance(context, Context)
        assert isinstance(node.action, Choice)
        assert isinstance(decided, tuple)
        value = self.offered(c, context, node.action.branches[len(decided)])
        return c._replace(stack=(("deciding", node, context, (*decided, (value,))), rest), loaded=())

    def offered(self, c: Configuration, context: Context, branch: Branch) -> Known:
        """What an output guard writes; it is evaluated when the alternative begins."""
        if isinstance(branch.event, AfterEvent):
            self._compute_risk(c, context, branch.event.duration)
        if not isinstance(branch.event, OutputEvent):
            return UNKNOWN
        return self.communicated(c, context, context.reference(branch.event.sink), branch.event.value)

    def communicated(self, c: Configuration, context: Context, reference: Reference, expression: Expression) -> Known:
        """The value of an expression that is written to a medium, if values of that medium are followed."""
        if self.thread.medium(reference).relevant and not isinstance(expression, PresentTime):
            return self.evaluate(c, context, expression)
        self._compute_risk(c, context, expression)
        if self.thread.medium(reference).kind != "output":
            return UNKNOWN
        if isinstance(expression, LiteralValue):
            return expression.value
        if _has_real(expression.type):
            self._risk(c, expression.span)  # NaN and infinity are no values of outputs.
        return UNKNOWN

    def _interrupt(self, c: Configuration, node: Node, context: Context, rest: Stack) -> Configuration | None:
        if c.doomed:
            return self.abandoned(c)
        assert isinstance(node.action, InterruptOn)
        branch = node.action.branch
        body = ("run", node.children[0], context)
        if branch.condition is not None:
            yes = (("interruptible", node, context), rest)
            return self._decided(c, context, branch.condition, yes, (body, rest))
        return c._replace(stack=(("interruptible", node, context), rest))

    def _interruptible(self, c: Configuration, frame: tuple[object, ...], rest: Stack) -> Configuration | None:
        _, node, context = frame
        assert isinstance(node, Node)
        assert isinstance(context, Context)
        assert isinstance(node.action, InterruptOn)
        value = self.offered(c, context, node.action.branch)
        guard = ("interrupt", node, context, value)
        return c._replace(stack=(("run", node.children[0], context), (guard, rest)), loaded=())

    def _group(self, c: Configuration, node: Node, context: Context, rest: Stack) -> Configuration | None:
        return c._replace(stack=(("run", node.children[0], context), rest))

    def _instance(self, c: Configuration, node: Node, context: Context, rest: Stack) -> Configuration | None:
        action = node.action
        assert isinstance(action, RunInstance)
        if self.thread.law(context, action.instance) is not None:
            if c.doomed:
                return self.abandoned(c)
            then = ("compute", context, action.instance, node)
            return c._replace(stack=(("reading", context, action.instance, node, None), (then, rest)))
        inner = self.thread.context(context, action.instance)
        below = (("leave", inner), rest)
        if inner.definition.body is None:
            return c._replace(stack=(("foreign", inner, node), below))
        return c._replace(stack=(("run", inner.definition.body, inner), below))

    def _leave(self, c: Configuration, frame: tuple[object, ...], rest: Stack) -> Configuration | None:
        assert isinstance(frame[1], Context)
        return self.thread.closed(c, frame[1])._replace(stack=rest)

    def _pop(self, c: Configuration, frame: tuple[object, ...], rest: Stack) -> Configuration | None:
        return c._replace(stack=rest)

    def cannot_fuse(self, c: Configuration) -> None:
        """What a ready guard has read cannot be handed to who reads it: the guard is taken without reading instead."""
        assert c.fetched is not None
        self.thread.unfused.add(id(c.fetched[2]))
        raise Restart

    # -- control laws

    def connections(self, context: Context, instance: str, direction: str) -> list[tuple[Connection, Reference]]:
        """The connections of a submodel on one side, in the order of its ports, with their media."""
        law = self.thread.law(context, instance)
        assert law is not None
        names = {port.name for port in law.ports if port.direction == direction}
        connections = context.definition.instances[instance].connections
        return [(c, context.reference(c.attachment)) for c in connections if c.port in names]

    def _reading(self, c: Configuration, frame: tuple[object, ...], rest: Stack) -> Configuration | None:
        """The inputs that are still to be read: all at first."""
        _, context, instance, node, remaining = frame
        assert isinstance(context, Context)
        assert isinstance(instance, str)
        if remaining is None:
            instance_of = context.definition.instances[instance]
            if self.thread.facts.faults.of_inputs(instance_of, context.definition.name):
                self._risk(c, instance_of.span)
            inputs = self.connections(context, instance, "in")
            waiting = [i for i, (_, reference) in enumerate(inputs) if self.thread.medium(reference).kind in PATIENT]
            if c.fetched is not None:
                fetched = c.fetched[0]
                kept = [i for i in waiting if inputs[i][1] != fetched]
                if len(kept) == len(waiting) and waiting:
                    self.cannot_fuse(c)
                c = c if len(kept) == len(waiting) else c._replace(fetched=None)
                waiting = kept
            return c._replace(stack=(("reading", context, instance, node, tuple(waiting)), rest), loaded=())
        return None if remaining else c._replace(stack=rest)

    def _compute(self, c: Configuration, frame: tuple[object, ...], rest: Stack) -> Configuration | None:
        _, context, instance, node = frame
        assert isinstance(context, Context)
        assert isinstance(instance, str)
        law = self.thread.law(context, instance)
        assert law is not None
        outputs = self.connections(context, instance, "out")
        shown = any(self.thread.medium(reference).kind == "output" for _, reference in outputs)
        if shown or self.thread.facts.faults.of_law(law):
            self._risk(c, context.definition.instances[instance].span)
        c = c._replace(stack=(("writing", context, instance, node, None), rest), loaded=())
        for connection, reference in outputs:
            if self.thread.medium(reference).kind == "var":
                c = self.stored(c, reference, constant_output(law, connection.port))
        return c

    def _writing(self, c: Configuration, frame: tuple[object, ...], rest: Stack) -> Configuration | None:
        """The outputs that are still to be written: all at first."""
        _, context, instance, node, remaining = frame
        assert isinstance(context, Context)
        assert isinstance(instance, str)
        if remaining is None:
            if c.doomed:
                return self.abandoned(c)
            outputs = self.connections(context, instance, "out")
            kinds = [self.thread.medium(reference).kind for _, reference in outputs]
            left = tuple(i for i, kind in enumerate(kinds) if kind not in ("var", "discard"))
            return c._replace(stack=(("writing", context, instance, node, left), rest))
        return None if remaining else c._replace(stack=rest)


def _has_real(kind: Type) -> bool:
    match kind:
        case StructType(fields=fields):
            return any(_has_real(field) for _, field in fields)
        case ArrayType(element=element):
            return _has_real(element)
    return isinstance(kind, RealType)


def constant_output(law: SubmodelClass, port: str) -> Known:
    """The value of an output that is always the same."""
    for equation in law.equations:
        if (
            not isinstance(equation, ExternalCall)
            and equation.name == port
            and isinstance(equation.value, LiteralValue)
        ):
            return equation.value.value
    return UNKNOWN


_STEPS: dict[type, Callable[[Follower, Configuration, Node, Context, Stack], Configuration | None]] = {
    SequentialSteps: Follower._sequence,
    SkipStep: Follower._nothing,
    ResetInstance: Follower._nothing,
    AssignValue: Follower._assign,
    ReadValue: Follower._read,
    WriteValue: Follower._write,
    WaitStep: Follower._wait,
    StopStep: Follower._point,
    ParallelSteps: Follower._point,
    RaiseException: Follower._raise,
    Repeat: Follower._repeat,
    WhileLoop: Follower._while,
    IfElse: Follower._if,
    CatchException: Follower._catch,
    Choice: Follower._choice,
    InterruptOn: Follower._interrupt,
    Group: Follower._group,
    RunInstance: Follower._instance,
}

_FRAMES: dict[str, Callable[[Follower, Configuration, tuple[object, ...], Stack], Configuration | None]] = {
    "again": Follower._again,
    "assign": Follower._assigning,
    "catch": Follower._pop,
    "interrupt": Follower._pop,
    "interruptible": Follower._interruptible,
    "leave": Follower._leave,
    "deciding": Follower._deciding,
    "offering": Follower._offering,
    "reading": Follower._reading,
    "compute": Follower._compute,
    "writing": Follower._writing,
}
