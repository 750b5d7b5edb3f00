"""The layout of compositions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import assert_never

from cspdiag.syntax import ast
from cspdiag.syntax.format.expressions import ExpressionFormatter
from cspdiag.syntax.format.layout import SPACE, Mark, Separator


class CompositionFormatter(ExpressionFormatter):
    """Writes compositions.

    A chain of operators stays broken where its author broke it. In a broken chain, ``;`` is at the end of a line and
    every other operator has a line of its own.
    """

    def composition(self, node: ast.Composition, before: Separator = "") -> None:
        """A composition with its parentheses."""
        if not node.parenthesized:
            self._bare_composition(node, before)
            return
        match node:
            case ast.Sequence(processes=(first, *_)) | ast.Parallel(processes=(first, *_)):
                end = first.span.start
            case ast.Alternative(branches=(first, *_)):
                end = first.span.start
            case ast.Catch(process=first) | ast.Interrupt(process=first):
                end = first.span.start
            case (
                ast.Run() | ast.Read() | ast.Write() | ast.Assign() | ast.Skip() | ast.Stop() | ast.Wait()
                | ast.Reset() | ast.Raise() | ast.Sequence() | ast.Parallel() | ast.Alternative() | ast.Guarded()
                | ast.Mu() | ast.While() | ast.If() | ast.Replicated() | ast.Labelled()
            ):  # fmt: skip
                end = node.span.end
            case _:
                assert_never(node)
        pairs = self.writer.parentheses_before(end)
        self.enclosed(pairs, lambda separator: self._bare_composition(node, separator), before)

    def _bare_composition(self, node: ast.Composition, before: Separator) -> None:
        match node:
            case ast.Run(instance=instance):
                self.reference(instance, before)
            case ast.Read(channel=channel, target=target):
                self.reference(channel, before)
                self.token(" ")
                self.reference(target, " ")
            case ast.Write(channel=channel, value=value):
                self.reference(channel, before)
                self.token(" ")
                self.expression(value, " ")
            case ast.Assign(target=target, value=value):
                self.reference(target, before)
                self.token(" ")
                self.expression(value, " ")
            case ast.Skip() | ast.Stop():
                self.token(before)
            case ast.Wait(time=time, until=until):
                self.token(before)
                if until:
                    self.token(" ")
                self.expression(time, " ")
            case ast.Reset(instance=instance):
                self.token(before)
                self.reference(instance, " ")
            case ast.Raise():
                self.token(before)
                self.token(" ")
            case ast.Sequence(processes=processes) | ast.Parallel(processes=processes):
                self._chain(processes, before)
            case ast.Alternative(branches=branches):
                self._chain(branches, before)
            case (
                ast.Guarded() | ast.Mu() | ast.While() | ast.If() | ast.Catch() | ast.Interrupt() | ast.Replicated()
                | ast.Labelled()
            ):  # fmt: skip
                self._form(node, before)
            case _:
                assert_never(node)

    def _form(
        self,
        node: ast.Guarded | ast.Mu | ast.While | ast.If | ast.Catch | ast.Interrupt | ast.Replicated | ast.Labelled,
        before: Separator,
    ) -> None:
        match node:
            case ast.Guarded(guard=guard, process=process):
                with self.writer.group(before):
                    self._guard(guard)
                    self.token(" ")
                    self._body(process)
            case ast.Mu(process=process, until=until):
                self.token(before)
                self.composition(process, " ")
                if until is not None:
                    self.token(" ")
                    self.expression(until, " ")
            case ast.While(condition=condition, process=process):
                with self.writer.group(before):
                    self.token()
                    self.expression(condition, " ")
                    self.token(" ")
                    self._body(process)
            case ast.If():
                with self.writer.group(before):
                    self._if(node)
            case ast.Catch(process=process, handler=handler):
                with self.writer.group(before):
                    self.composition(process)
                    self.token(SPACE)
                    self.token(" ")
                    self.token(" ")
                    self.composition(handler, " ")
            case ast.Interrupt(process=process, guard=guard, handler=handler):
                with self.writer.group(before):
                    self.composition(process)
                    self.token(SPACE)
                    self._guard(guard, " ")
                    self.token(" ")
                    self.composition(handler, " ")
            case ast.Replicated(replicator=replicator, process=process):
                with self.writer.group(before):
                    self.token()
                    self.replicator(replicator, " ")
                    self.token(" ")
                    self._body(process)
            case ast.Labelled(process=process):
                self.token(before)
                self.token()
                self.composition(process, " ")
            case _:
                assert_never(node)

    def _if(self, node: ast.If) -> None:
        self.token()
        self.expression(node.condition, " ")
        self.token(" ")
        self._body(node.then)
        if node.otherwise is not None:
            self.token(" " if node.then.parenthesized else SPACE)
            if isinstance(node.otherwise, ast.If) and not node.otherwise.parenthesized:
                self.writer.separate(" ")
                self._if(node.otherwise)
            else:
                self._body(node.otherwise)

    def _body(self, node: ast.Composition) -> None:
        """The body of a form: in parentheses it begins on the same line, otherwise a broken form indents it."""
        if node.parenthesized:
            self.composition(node, " ")
            return
        with self.writer.indented():
            self.composition(node, SPACE)

    def _chain(self, processes: Sequence[ast.Composition], before: Separator) -> None:
        with self.writer.group(before):
            for position, process in enumerate(processes):
                if position == 0:
                    self.composition(process)
                    continue
                broken = position == 1 and self.writer.new_line_before_next()
                operator = self.writer.next
                self.token(" " if operator == ";" else SPACE)
                if position == 1 and (broken or self.writer.new_line_before_next()):
                    self.writer.pieces.append(Mark.BROKEN)
                self.composition(process, SPACE)

    def _guard(self, node: ast.Guard, before: Separator = "") -> None:
        if node.condition is not None:
            self.token(before)
            self.expression(node.condition, " ")
            self.token(" ")
            before = " "
        match node.event:
            case ast.ReadyGuard(channel=channel):
                self.reference(channel, before)
            case ast.InputGuard(channel=channel, target=target):
                self.reference(channel, before)
                self.token(" ")
                self.reference(target, " ")
            case ast.OutputGuard(channel=channel, value=value):
                self.reference(channel, before)
                self.token(" ")
                self.expression(value, " ")
            case ast.TimeGuard(time=time):
                self.token(before)
                self.expression(time, " ")
            case ast.SkipGuard():
                self.token(before)
            case _:
                assert_never(node.event)
