"""The composition of a shape: names are resolved and replicators unrolled; every reading end is still 0."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import TypeAlias, assert_never

from cspdiag.base import Span
from cspdiag.model.program import EndLabelSymbol, PortSymbol, Value
from cspdiag.model.types import TIME, UNKNOWN
from cspdiag.network.diagnostics.channels import LabelOfPortRead
from cspdiag.network.diagnostics.composition.alternatives import MixedAlternative, UnguardedBranch
from cspdiag.network.elaborate.array_sizes import check_sizes
from cspdiag.network.elaborate.counted_loops import Indexes, IndexUse, counted_loop
from cspdiag.network.elaborate.expression import LoweringContext, lower_expression
from cspdiag.network.elaborate.finite import assured
from cspdiag.network.elaborate.places import ChannelPlace, Places, ProcessPort
from cspdiag.network.elaborate.sizes import Sizes
from cspdiag.network.ir.actions import (
    AfterEvent,
    AssignValue,
    Branch,
    CatchException,
    ChannelEnd,
    Choice,
    CoreAction,
    CountedLoop,
    End,
    Event,
    Group,
    IfElse,
    InputEvent,
    InterruptOn,
    OutputEvent,
    ParallelSteps,
    PortEnd,
    RaiseException,
    ReadValue,
    ReadyEvent,
    Repeat,
    ResetInstance,
    RunInstance,
    SequentialSteps,
    SkipEvent,
    SkipStep,
    StopStep,
    Target,
    WaitStep,
    WhileLoop,
    WriteValue,
)
from cspdiag.network.ir.expressions import Expression, FunctionCall, LiteralValue, PresentTime, VariableValue
from cspdiag.network.relations import end_key
from cspdiag.network.shapes import Shape
from cspdiag.syntax import ast
from cspdiag.syntax.walk import names

Values: TypeAlias = Mapping[ast.Node, Value]


def compose(sizes: Sizes, shape: Shape, places: Places, composition: ast.Composition) -> CoreAction:
    """The composition as actions; a part that could not be resolved was reported, and becomes a step that
    does nothing.
    """
    return _Composer(sizes, shape, places).action(composition, shape.values)


def _until(instant: Expression) -> Expression:
    """The duration from the present instant until ``instant``."""
    arguments = (instant, PresentTime(type=TIME, span=instant.span))
    return FunctionCall(type=TIME, span=instant.span, function="until", arguments=arguments)


class _Composer:
    def __init__(self, sizes: Sizes, shape: Shape, places: Places) -> None:
        self.sizes = sizes
        self.program = sizes.program
        self.report = sizes.report
        self.shape = shape
        self.places = places
        self.indexes = Indexes(self.program, shape, places.loops)

    def action(self, part: ast.Composition, values: Values) -> CoreAction:
        span = part.place
        match part:
            case ast.Run():
                instance = self.places.instance(part.instance, values)
                return RunInstance(span=span, instance=instance.name) if instance else self._broken(span)
            case ast.Reset():
                instance = self.places.instance(part.instance, values)
                return ResetInstance(span=span, instance=instance.name) if instance else self._broken(span)
            case ast.Read():
                source, target = self._end(part.channel, values), self._variable(part.target, values)
                if source is None or target is None:
                    return self._broken(span)
                self._check_sizes(source, target, part.target)
                return ReadValue(span=span, source=source, target=target)
            case ast.Write():
                sink, value = self._end(part.channel, values), self._expression(part.value, values)
                return WriteValue(span=span, sink=sink, value=value) if sink else self._broken(span)
            case ast.Assign():
                target, value = self._variable(part.target, values), self._expression(part.value, values)
                return AssignValue(span=span, target=target, value=value) if target else self._broken(span)
            case ast.Skip():
                return SkipStep(span=span)
            case ast.Stop():
                return StopStep(span=span)
            case ast.Wait():
                time = self._expression(part.time, values)
                return WaitStep(span=span, duration=_until(time) if part.until else time)
            case ast.Raise():
                return RaiseException(span=span, exception=part.exception.text)
            case ast.Sequence():
                return SequentialSteps(span=span, steps=tuple(self.action(p, values) for p in part.processes))
            case ast.Parallel():
                steps = tuple(self.action(p, values) for p in part.processes)
                return ParallelSteps(span=span, steps=steps, prioritized=part.prioritized)
            case ast.Alternative():
                branches = tuple(self._branches(part.branches, values, part.prioritized))
                return Choice(span=span, branches=branches, prioritized=part.prioritized)
            case ast.Guarded():
                branches = tuple(self._branches((part,), values, False))
                return Choice(span=span, branches=branches, prioritized=False)
            case ast.Mu():
                until = None if part.until is None else self._expression(part.until, values)
                return Repeat(span=span, body=self.action(part.process, values), until=until)
            case ast.While():
                condition = self._expression(part.condition, values)
                return WhileLoop(span=span, condition=condition, body=self.action(part.process, values))
            case ast.If():
                return self._if(part, values)
            case ast.Catch():
                return CatchException(
                    span=span,
                    body=self.action(part.process, values),
                    exception=part.exception.text,
                    handler=self.action(part.handler, values),
                )
            case ast.Interrupt():
                return self._interrupt(part, values)
            case ast.Replicated():
                return self._replicated(part, values)
            case ast.Labelled():
                return Group(span=span, label=part.label.text, body=self.action(part.process, values))
            case _:
                assert_never(part)

    def _if(self, part: ast.If, values: Values) -> CoreAction:
        condition = self._expression(part.condition, values)
        holds = self._decided(part.condition, condition)
        if holds is not None:
            chosen = part.then if holds else part.otherwise
            return SkipStep(span=part.place) if chosen is None else self.action(chosen, values)
        return IfElse(
            span=part.place,
            condition=condition,
            then=self.action(part.then, values),
            otherwise=self.action(part.otherwise, values) if part.otherwise else SkipStep(span=part.place),
        )

    def _decided(self, condition: ast.Expression, lowered: Expression) -> bool | None:
        """The value of a condition on the index of a replicator, which selects parts of the diagram before the program
        runs; None for other conditions.
        """
        if not any(isinstance(self.program.bindings.get(name), ast.Replicator) for name in names((condition,))):
            return None
        return self.indexes.in_every_iteration(lowered)

    def _interrupt(self, part: ast.Interrupt, values: Values) -> CoreAction:
        body = self.action(part.process, values)
        branch = self._branch(part.guard, part.handler, values, part.place)
        return body if branch is None else InterruptOn(span=part.place, body=body, branch=branch)

    def _replicated(self, part: ast.Replicated, values: Values) -> CoreAction:
        if part.operator in ("alt", "prialt"):
            prioritized = part.operator == "prialt"
            branches = tuple(self._branches((part,), values, prioritized))
            if not branches:
                return StopStep(span=part.place)
            return Choice(span=part.place, branches=branches, prioritized=prioritized)
        repetitions = self._repeated(part.replicator, values)
        match self.indexes.use_in_loop(part, len(repetitions)):
            case IndexUse.NOTHING:
                body = self.action(part.process, repetitions[0])
                return CountedLoop(span=part.place, body=body, iterations=len(repetitions))
            case IndexUse.VALUES:
                with self.indexes.counting(part.replicator, len(repetitions)) as counter:
                    return counted_loop(part, counter, self.action(part.process, values))
            case IndexUse.STRUCTURE | None:
                pass
        steps = tuple(self.action(part.process, inner) for inner in repetitions)
        if not steps:
            return SkipStep(span=part.place)
        if part.operator == "seq":
            return SequentialSteps(span=part.place, steps=steps)
        return ParallelSteps(span=part.place, steps=steps, prioritized=part.operator == "pripar")

    def _repeated(self, replicator: ast.Replicator, values: Values) -> list[dict[ast.Node, Value]]:
        what = f"the replicator `{replicator.name.text}`"
        repetitions = self.sizes.repeated(replicator, what, values, self.indexes.iterations_around())
        self.shape.incomplete = self.shape.incomplete or repetitions is None
        return repetitions or []

    def _branches(
        self, parts: tuple[ast.Composition, ...], values: Values, prioritized: bool
    ) -> Iterator[Branch[CoreAction]]:
        """The branches of an alternative, with replicated ones unrolled."""
        for part in parts:
            yield from self._branch_of(part, values, prioritized, lambda body: body)

    def _branch_of(
        self, part: ast.Composition, values: Values, prioritized: bool, wrap: Callable[[CoreAction], CoreAction]
    ) -> Iterator[Branch[CoreAction]]:
        match part:
            case ast.Guarded():
                branch = self._branch(part.guard, part.process, values, part.place, wrap)
                if branch is not None:
                    yield branch
            case ast.Replicated(operator="alt" | "prialt"):
                if (part.operator == "prialt") != prioritized:
                    self.report.add(MixedAlternative(span=part.span, prioritized=prioritized))
                for inner in self._repeated(part.replicator, values):
                    yield from self._branch_of(part.process, inner, prioritized, wrap)
            case ast.Labelled():
                label, span = part.label.text, part.place
                yield from self._branch_of(
                    part.process, values, prioritized, lambda body: Group(span=span, label=label, body=wrap(body))
                )
            case (
                ast.Run() | ast.Read() | ast.Write() | ast.Assign() | ast.Skip() | ast.Stop() | ast.Wait()
                | ast.Reset() | ast.Raise() | ast.Sequence() | ast.Parallel() | ast.Alternative() | ast.Mu()
                | ast.While() | ast.If() | ast.Catch() | ast.Interrupt() | ast.Replicated()
            ):  # fmt: skip
                communicates = isinstance(part, ast.Read | ast.Write)
                self.report.add(UnguardedBranch(span=part.span, communicates=communicates))
                self.action(part, values)
                self.shape.incomplete = True
            case _:
                assert_never(part)

    def _branch(
        self,
        guard: ast.Guard,
        process: ast.Composition,
        values: Values,
        span: Span,
        wrap: Callable[[CoreAction], CoreAction] = lambda body: body,
    ) -> Branch[CoreAction] | None:
        condition: Expression | None = None
        if guard.condition is not None:
            condition = self._expression(guard.condition, values)
            holds = self._decided(guard.condition, condition)
            if holds is False:
                return None
            condition = None if holds else condition
        event = self._event(guard.event, values)
        body = self.action(process, values)
        return None if event is None else Branch(span=span, condition=condition, event=event, body=wrap(body))

    def _event(self, event: ast.Event, values: Values) -> Event | None:
        span = event.span
        match event:
            case ast.ReadyGuard():
                source = self._end(event.channel, values)
                return ReadyEvent(span=span, source=source) if source else None
            case ast.InputGuard():
                source, target = self._end(event.channel, values), self._variable(event.target, values)
                return InputEvent(span=span, source=source, target=target) if source and target else None
            case ast.OutputGuard():
                sink, value = self._end(event.channel, values), self._expression(event.value, values)
                return OutputEvent(span=span, sink=sink, value=value) if sink else None
            case ast.TimeGuard():
                time = self._expression(event.time, values)
                return AfterEvent(span=span, duration=_until(time) if event.at else time)
            case ast.SkipGuard():
                return SkipEvent(span=span)
            case _:
                assert_never(event)

    def _end(self, reference: ast.Reference, values: Values) -> End | None:
        if reference in self.program.poisoned:
            return None
        match self.places.single(reference, values):
            case ProcessPort() as place:
                self.shape.port_spans.setdefault(place.key, place.span)
                index = None
                if place.port.size is not None:
                    index = int(place.key[place.key.rindex("[") + 1 : -1])
                return PortEnd(place.port.name, index)
            case ChannelPlace() as place:
                return ChannelEnd(place.channel.name)
            case None:
                return None

    def _check_sizes(self, source: End, target: Target, written: ast.Reference) -> None:
        known = self.shape.port_or_channel_type(end_key(source))
        wanted = self.shape.channels[target.channel].type
        if not target.indexes and written.member is None:
            check_sizes(known, wanted, written.span, end_key(source), target.channel, self.report)

    def _variable(self, reference: ast.Reference, values: Values) -> Target | None:
        symbol = self.program.bindings.get(reference)
        if reference in self.program.poisoned or not isinstance(symbol, ast.Variable | EndLabelSymbol):
            return None
        place = self.places.channel(reference, symbol, values)
        if not isinstance(place, ChannelPlace):
            return None
        indexes = self.places.indexes_beyond_loops(reference, values)
        return Target(place.channel.name, tuple(self._expression(index, values) for index in indexes))

    def _expression(self, expression: ast.Expression, values: Values) -> Expression:
        def lower_name(node: ast.Name | ast.Member | ast.Reference) -> Expression | None:
            return None if isinstance(node, ast.Member) else self.indexes.value(node) or self._value_of(node, values)

        known: dict[ast.Node, Value] = {key: value for key, value in values.items() if isinstance(key, ast.Replicator)}
        return assured(lower_expression(self.program, expression, LoweringContext(values=known, lower_name=lower_name)))

    def _value_of(self, name: ast.Name | ast.Reference, values: Values) -> Expression | None:
        symbol = self.program.bindings.get(name)
        if isinstance(symbol, PortSymbol) or not isinstance(symbol, ast.Variable | EndLabelSymbol):
            return None
        place = self.places.channel(name, symbol, values)
        match place:
            case ChannelPlace():
                return VariableValue(type=place.channel.type, channel=place.channel.name, span=name.span)
            case ProcessPort():
                label = name.name if isinstance(name, ast.Name) else name.name.text
                self.report.add(LabelOfPortRead(span=name.span, name=label, port=place.key, declared=place.span))
            case None:
                pass
            case _:
                assert_never(place)
        return LiteralValue(type=UNKNOWN, value=0, span=name.span)

    def _broken(self, span: Span) -> CoreAction:
        """A step in place of a part that was reported; turns off checks that would report its absence again."""
        self.shape.incomplete = True
        return SkipStep(span=span)
