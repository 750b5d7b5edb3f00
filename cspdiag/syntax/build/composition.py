"""Compositions of the tree."""

from __future__ import annotations

from typing import Any, cast

from cspdiag.base.record import replaced
from cspdiag.base.span import Span
from cspdiag.syntax import ast
from cspdiag.syntax.build.common import chain, node
from cspdiag.syntax.build.expressions import ExpressionBuilder
from cspdiag.syntax.parse.lexer import Token


class CompositionBuilder(ExpressionBuilder):
    """The rules of the composition diagram."""

    def composition_block(self, span: Span, composition: ast.Composition) -> tuple[Span, ast.Composition]:
        """``composition { ... }``: its place and its contents."""
        return span, composition

    sequence = chain(ast.Sequence, "processes")  # P ; Q
    parallel = chain(ast.Parallel, "processes", prioritized=False)  # P || Q
    prioritized_parallel = chain(ast.Parallel, "processes", prioritized=True)  # P ||> Q
    alternative = chain(ast.Alternative, "branches", prioritized=False)  # P [] Q
    prioritized_alternative = chain(ast.Alternative, "branches", prioritized=True)  # P []> Q
    mu = node(ast.Mu, "process", "until")  # mu P until e
    if_then = node(ast.If, "condition", "then", otherwise=None)  # if e then P
    if_else = node(ast.If, "condition", "then", "otherwise")  # if e then P else Q
    while_do = node(ast.While, "condition", "process")  # while e do P
    labelled = node(ast.Labelled, "label", "process")  # label: P

    def replicated(
        self, span: Span, operator: Token, replicator: ast.Replicator, process: ast.Composition
    ) -> ast.Replicated:
        """``par i < N : P``."""
        return ast.Replicated(span=span, operator=cast("Any", operator.text), replicator=replicator, process=process)

    guarded = node(ast.Guarded, "guard", "process")  # guard -> P
    catch = node(ast.Catch, "process", "exception", "handler")  # P catch Timeout -> Q
    interrupt = node(ast.Interrupt, "process", "guard", "handler")  # P interrupt g -> Q
    run = node(ast.Run, "instance")  # The name of an instance
    read = node(ast.Read, "channel", "target")  # port ? x
    write = node(ast.Write, "channel", "value")  # port ! e
    assign = node(ast.Assign, "target", "value")  # x := e
    skip = node(ast.Skip)
    stop = node(ast.Stop)
    wait = node(ast.Wait, "time", until=False)  # wait 5 ms
    wait_until = node(ast.Wait, "time", until=True)  # wait until last + 10 ms
    reset = node(ast.Reset, "instance")  # reset name
    raise_exception = node(ast.Raise, "exception")  # raise Name

    def group(self, span: Span, process: ast.Composition) -> ast.Composition:
        """``(P)``; the span of the process then includes the parentheses."""
        return replaced(process, span=span, inner_span=process.place)

    guard = node(ast.Guard, "condition", "event")  # [when e &] event
    ready_guard = node(ast.ReadyGuard, "channel")  # port
    input_guard = node(ast.InputGuard, "channel", "target")  # port ? x
    output_guard = node(ast.OutputGuard, "channel", "value")  # port ! e
    after_guard = node(ast.TimeGuard, "time", at=False)  # after 5 ms
    at_guard = node(ast.TimeGuard, "time", at=True)  # at last + 200 ms
    skip_guard = node(ast.SkipGuard)
