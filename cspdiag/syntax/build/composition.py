"""Compositions of the tree."""

from __future__ import annotations

from typing import Any, cast

from cspdiag.base.record import replaced
from cspdiag.base.span import Span
from cspdiag.syntax import ast
from cspdiag.syntax.build.expressions import ExpressionBuilder
from cspdiag.syntax.parse.lexer import Token


class CompositionBuilder(ExpressionBuilder):
    """The rules of the composition diagram."""

    def composition_block(self, span: Span, composition: ast.Composition) -> tuple[Span, ast.Composition]:
        """``composition { ... }``: its place and what is in it."""
        return span, composition

    def sequence(self, span: Span, *processes: ast.Composition) -> ast.Sequence:
        """``P ; Q``."""
        return ast.Sequence(span=span, processes=processes)

    def parallel(self, span: Span, *processes: ast.Composition) -> ast.Parallel:
        """``P || Q``."""
        return ast.Parallel(span=span, prioritized=False, processes=processes)

    def prioritized_parallel(self, span: Span, *processes: ast.Composition) -> ast.Parallel:
        """``P ||> Q``."""
        return ast.Parallel(span=span, prioritized=True, processes=processes)

    def alternative(self, span: Span, *branches: ast.Composition) -> ast.Alternative:
        """``P [] Q``."""
        return ast.Alternative(span=span, prioritized=False, branches=branches)

    def prioritized_alternative(self, span: Span, *branches: ast.Composition) -> ast.Alternative:
        """``P []> Q``."""
        return ast.Alternative(span=span, prioritized=True, branches=branches)

    def mu(self, span: Span, process: ast.Composition, until: ast.Expression | None) -> ast.Mu:
        """``mu P until e``."""
        return ast.Mu(span=span, process=process, until=until)

    def if_then(self, span: Span, condition: ast.Expression, then: ast.Composition) -> ast.If:
        """``if e then P``."""
        return ast.If(span=span, condition=condition, then=then, otherwise=None)

    def if_else(
        self, span: Span, condition: ast.Expression, then: ast.Composition, otherwise: ast.Composition
    ) -> ast.If:
        """``if e then P else Q``."""
        return ast.If(span=span, condition=condition, then=then, otherwise=otherwise)

    def while_do(self, span: Span, condition: ast.Expression, process: ast.Composition) -> ast.While:
        """``while e do P``."""
        return ast.While(span=span, condition=condition, process=process)

    def labelled(self, span: Span, label: ast.Identifier, process: ast.Composition) -> ast.Labelled:
        """``label: P``."""
        return ast.Labelled(span=span, label=label, process=process)

    def replicated(
        self, span: Span, operator: Token, replicator: ast.Replicator, process: ast.Composition
    ) -> ast.Replicated:
        """``par i < N : P``."""
        return ast.Replicated(span=span, operator=cast("Any", operator.text), replicator=replicator, process=process)

    def guarded(self, span: Span, guard: ast.Guard, process: ast.Composition) -> ast.Guarded:
        """``guard -> P``."""
        return ast.Guarded(span=span, guard=guard, process=process)

    def catch(
        self, span: Span, process: ast.Composition, exception: ast.Identifier, handler: ast.Composition
    ) -> ast.Catch:
        """``P catch Timeout -> Q``."""
        return ast.Catch(span=span, process=process, exception=exception, handler=handler)

    def interrupt(
        self, span: Span, process: ast.Composition, guard: ast.Guard, handler: ast.Composition
    ) -> ast.Interrupt:
        """``P interrupt g -> Q``."""
        return ast.Interrupt(span=span, process=process, guard=guard, handler=handler)

    def run(self, span: Span, instance: ast.Reference) -> ast.Run:
        """The name of an instance."""
        return ast.Run(span=span, instance=instance)

    def read(self, span: Span, channel: ast.Reference, target: ast.Reference) -> ast.Read:
        """``port ? x``."""
        return ast.Read(span=span, channel=channel, target=target)

    def write(self, span: Span, channel: ast.Reference, value: ast.Expression) -> ast.Write:
        """``port ! e``."""
        return ast.Write(span=span, channel=channel, value=value)

    def assign(self, span: Span, target: ast.Reference, value: ast.Expression) -> ast.Assign:
        """``x := e``."""
        return ast.Assign(span=span, target=target, value=value)

    def skip(self, span: Span) -> ast.Skip:
        """``skip``."""
        return ast.Skip(span=span)

    def stop(self, span: Span) -> ast.Stop:
        """``stop``."""
        return ast.Stop(span=span)

    def wait(self, span: Span, time: ast.Expression) -> ast.Wait:
        """``wait 5 ms``."""
        return ast.Wait(span=span, time=time, until=False)

    def wait_until(self, span: Span, time: ast.Expression) -> ast.Wait:
        """``wait until last + 10 ms``."""
        return ast.Wait(span=span, time=time, until=True)

    def reset(self, span: Span, instance: ast.Reference) -> ast.Reset:
        """``reset name``."""
        return ast.Reset(span=span, instance=instance)

    def raise_exception(self, span: Span, exception: ast.Identifier) -> ast.Raise:
        """``raise Name``."""
        return ast.Raise(span=span, exception=exception)

    def group(self, span: Span, process: ast.Composition) -> ast.Composition:
        """``(P)``; the span of the process then includes the parentheses."""
        return replaced(process, span=span, parenthesized=True)

    def guard(self, span: Span, condition: ast.Expression | None, event: ast.Event) -> ast.Guard:
        """``[when e &] event``."""
        return ast.Guard(span=span, condition=condition, event=event)

    def ready_guard(self, span: Span, channel: ast.Reference) -> ast.ReadyGuard:
        """``port``."""
        return ast.ReadyGuard(span=span, channel=channel)

    def input_guard(self, span: Span, channel: ast.Reference, target: ast.Reference) -> ast.InputGuard:
        """``port ? x``."""
        return ast.InputGuard(span=span, channel=channel, target=target)

    def output_guard(self, span: Span, channel: ast.Reference, value: ast.Expression) -> ast.OutputGuard:
        """``port ! e``."""
        return ast.OutputGuard(span=span, channel=channel, value=value)

    def after_guard(self, span: Span, time: ast.Expression) -> ast.TimeGuard:
        """``after 5 ms``."""
        return ast.TimeGuard(span=span, time=time, at=False)

    def at_guard(self, span: Span, time: ast.Expression) -> ast.TimeGuard:
        """``at last + 200 ms``."""
        return ast.TimeGuard(span=span, time=time, at=True)

    def skip_guard(self, span: Span) -> ast.SkipGuard:
        """``skip``."""
        return ast.SkipGuard(span=span)

    def reference_named_stop(self, span: Span) -> ast.Reference:
        """A port or variable whose name is ``stop``."""
        return ast.Reference(span=span, name=ast.Identifier(span=span, text="stop"))
