"""Takes the silent steps of a thread until it reaches something that others take part in or may see."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import TypeAlias, assert_never

from cspdiag.network.ir import actions as ir
from cspdiag.proofs.transitions.classes.built_in_exceptions import FAULT
from cspdiag.proofs.transitions.classes.program import Node
from cspdiag.proofs.transitions.occurrences import BLOCKING
from cspdiag.proofs.transitions.threads import frames
from cspdiag.proofs.transitions.threads.context import Context
from cspdiag.proofs.transitions.threads.frames import Stack
from cspdiag.proofs.transitions.threads.silent.guard_steps import GuardSteps
from cspdiag.proofs.transitions.threads.thread import Configuration, NeedsLoad, Restart
from cspdiag.proofs.transitions.values import ANY, UNKNOWN, EvaluationFault, Known

_MANY_STEPS = 5_000
"""The number of silent steps after which the variables that change are followed less closely."""


Step: TypeAlias = Callable[[Configuration, Node, Context, Stack], Configuration | None]


class Follower(GuardSteps):
    """Takes the silent steps of one thread."""

    @cached_property
    def _steps(self) -> dict[Node, Step]:
        """The step that begins each action reached so far."""
        return {}

    @cached_property
    def _settled(self) -> dict[Configuration, Configuration]:
        """The settled configuration after each alternative reached so far: an alternative with many guards is reached
        again from each of them.
        """
        return {}

    def settled(self, start: Configuration) -> Configuration:
        """The configuration that silent steps lead to. A cycle of silent steps ends in a ``Diverges`` frame."""
        choices: list[Configuration] = []
        end = self._end_of(start, choices)
        self._settled.update(dict.fromkeys(choices, end))
        return end

    def _end_of(self, start: Configuration, choices: list[Configuration]) -> Configuration:
        configuration = start
        seen: dict[Configuration, None] = {}
        steps = 0
        while True:
            frame = configuration.stack[0] if configuration.stack is not None else None
            if isinstance(frame, frames.Run) and isinstance(frame.node.action, ir.Choice):
                known = self._settled.get(configuration)
                if known is not None:
                    return known
                choices.append(configuration)
            if isinstance(frame, frames.Iterations):
                begins, after = _iteration(configuration, frame)
                if begins in seen:
                    configuration = after
                    continue
                seen[begins] = None
            following = self._step(configuration)
            if following is None:
                stack = configuration.stack
                if not configuration.doomed or stack is None or type(stack[0]) not in frames.CANCELLATION_POINTS:
                    return configuration
                following = self.abandoned(configuration)
            configuration = following
            steps += 1
            if steps > 32:
                if configuration in seen:
                    return configuration.at((frames.Diverges(), configuration.stack))
                seen[configuration] = None
            if steps > _MANY_STEPS:
                if not self.thread.give_up(seen):
                    return configuration.at((frames.Diverges(), configuration.stack))
                raise Restart

    def _step(self, configuration: Configuration) -> Configuration | None:
        """The configuration after one silent step; None if the thread cannot take one."""
        stack = configuration.stack
        if stack is None:
            return self.finished(configuration)
        frame, rest = stack
        try:
            if isinstance(frame, frames.Run):
                step = self._steps.get(frame.node)
                if step is None:
                    step = self._steps[frame.node] = self._step_of(frame.node.action)
                return step(configuration, frame.node, frame.context, rest)
            return self._frame(configuration, frame, rest)
        except NeedsLoad as needed:
            return configuration.at((frames.Load(needed.what), stack))
        except EvaluationFault:
            return self.thrown(configuration, FAULT)

    def _step_of(self, action: ir.CoreAction) -> Step:
        match action:
            case ir.SequentialSteps():
                return self._sequence
            case ir.SkipStep() | ir.ResetInstance():
                return self._nothing
            case ir.AssignValue():
                return self._assign
            case ir.ReadValue():
                return self._read
            case ir.WriteValue():
                return self._write
            case ir.WaitStep():
                return self._wait
            case ir.StopStep() | ir.ParallelSteps():
                return self._cancellation_point
            case ir.RaiseException():
                return self._raise
            case ir.Repeat():
                return self._repeat
            case ir.WhileLoop():
                return self._while
            case ir.CountedLoop():
                return self._counted_loop
            case ir.IfElse():
                return self._if
            case ir.CatchException():
                return self._catch
            case ir.Choice():
                return self._choice
            case ir.InterruptOn():
                return self._interrupt
            case ir.Group():
                return self._group
            case ir.RunInstance():
                return self._instance
            case _:
                assert_never(action)

    def _frame(
        self, c: Configuration, frame: frames.Silent | frames.Reading | frames.Writing | frames.Waiting, rest: Stack
    ) -> Configuration | None:
        match frame:
            case frames.Iterations():
                return self._next_iteration(c, frame, rest)
            case frames.LoopEnd():
                return self._loop_end(c, frame, rest)
            case frames.Leave():
                return self.thread.closed(c, frame.context).at(rest)
            case frames.Deciding():
                return self._deciding(c, frame, rest)
            case frames.Offering():
                return self._offering(c, frame, rest)
            case frames.Assign():
                return self._assigning(c, frame, rest)
            case frames.Interrupting():
                return self._interrupting(c, frame, rest)
            case frames.Interruptible():
                return self._interruptible(c, frame, rest)
            case frames.Interrupt():
                return c.at((frames.Closing(frame, None), rest) if self.may_be_chosen(c, frame) else rest)
            case frames.Reading():
                return self._reading(c, frame, rest)
            case frames.Compute():
                return self._compute(c, frame, rest)
            case frames.Writing():
                return self._writing(c, frame, rest)
            case frames.Storing():
                return self.stored(c.at(rest), frame.reference, frame.value)
            case frames.Catch():
                return c.at(rest)
            case (
                frames.Put() | frames.Delivering() | frames.Withdrawing() | frames.Picking() | frames.Choosing()
                | frames.Join() | frames.GuardOnly() | frames.Closing() | frames.InterruptPoint() | frames.MayEnd()
                | frames.Open() | frames.Split() | frames.Load() | frames.Store() | frames.Foreign()
                | frames.ForeignPort() | frames.Diverges() | frames.Idle() | frames.Ended() | frames.Over()
                | frames.Faulted() | frames.Raised()
            ):  # fmt: skip
                return None
            case _:
                assert_never(frame)

    def _nothing(self, c: Configuration, node: Node, context: Context, rest: Stack) -> Configuration | None:
        return c.at(rest)

    def _sequence(self, c: Configuration, node: Node, context: Context, rest: Stack) -> Configuration | None:
        for child in reversed(node.children):
            rest = (frames.Run(child, context), rest)
        return c.at(rest)

    def _assign(self, c: Configuration, node: Node, context: Context, rest: Stack) -> Configuration | None:
        action = node.action
        assert isinstance(action, ir.AssignValue)
        if not self.thread.medium(context.channel(action.target.channel)).relevant:
            self.compute_risk(c, context, action.value)
            return self.assigned(c.at(rest), context, action.target, UNKNOWN)._replace(loaded=())
        value = self.evaluate(c, context, action.value)
        return self.assigned(c.at(rest), context, action.target, value)._replace(loaded=())

    def _read(self, c: Configuration, node: Node, context: Context, rest: Stack) -> Configuration | None:
        action = node.action
        assert isinstance(action, ir.ReadValue)
        reference = context.reference(action.source)
        if self.thread.medium(reference).kind in BLOCKING:
            if c.fetched is not None:
                if c.fetched[0] != reference:
                    self.cannot_fuse(c)
                return self.assigned(c._replace(stack=rest, fetched=None), context, action.target, c.fetched[1])
            return self.abandoned(c) if c.doomed else None
        value: Known = UNKNOWN
        if self._target_relevant(context, action.target):
            value = self.thread.value_of(c, reference)
        faults = self.thread.facts.faults
        if value is UNKNOWN and faults.of_read(action.source, context.definition.name):
            self.risk(c, f"the read in `{context.definition.name}`", action.span)
        return self.assigned(c.at(rest), context, action.target, value)._replace(loaded=())

    def _target_relevant(self, context: Context, target: ir.Target) -> bool:
        return bool(target.channel) and self.thread.medium(context.channel(target.channel)).relevant

    def _write(self, c: Configuration, node: Node, context: Context, rest: Stack) -> Configuration | None:
        action = node.action
        assert isinstance(action, ir.WriteValue)
        reference = context.reference(action.sink)
        kind = self.thread.medium(reference).kind
        if kind not in ("var", "discard"):
            if c.fetched is not None and kind != "output":
                self.cannot_fuse(c)
            if c.doomed:
                return self.abandoned(c)
            value = self.communicated(c, context, reference, action.value)
            puts = tuple(frames.Put(reference, part, node) for part in self.thread.pieces(reference, value))
            put = puts[0] if len(puts) == 1 else frames.Split(puts)
            c = self.spent(c) if value == ANY else c
            return c._replace(stack=(put, rest), loaded=())
        if kind == "var" and self.thread.medium(reference).relevant:
            value = self.evaluate(c, context, action.value)
            return self.stored(c.at(rest), reference, value)._replace(loaded=())
        return c._replace(stack=rest, loaded=())

    def _raise(self, c: Configuration, node: Node, context: Context, rest: Stack) -> Configuration | None:
        action = node.action
        assert isinstance(action, ir.RaiseException)
        return self.thrown(c, action.exception)

    def _wait(self, c: Configuration, node: Node, context: Context, rest: Stack) -> Configuration | None:
        if not c.doomed:
            assert isinstance(node.action, ir.WaitStep)
            self.compute_risk(c, context, node.action.duration)
        return self._cancellation_point(c, node, context, rest)

    def _cancellation_point(self, c: Configuration, node: Node, context: Context, rest: Stack) -> Configuration | None:
        """A cancellation point: a cancelled process ends here, any other one waits."""
        if c.fetched is not None:
            self.cannot_fuse(c)
        return self.abandoned(c) if c.doomed else None

    def _repeat(self, c: Configuration, node: Node, context: Context, rest: Stack) -> Configuration | None:
        return c.at((frames.Run(node.children[0], context), (frames.LoopEnd(node, context), rest)))

    def _loop_end(self, c: Configuration, frame: frames.LoopEnd, rest: Stack) -> Configuration | None:
        node, context = frame.node, frame.context
        assert isinstance(node.action, ir.Repeat)
        until = node.action.until
        if until is None:
            return c.at((frames.Run(node, context), rest))
        return self._decided(c, context, until, rest, (frames.Run(node, context), rest))

    def _while(self, c: Configuration, node: Node, context: Context, rest: Stack) -> Configuration | None:
        assert isinstance(node.action, ir.WhileLoop)
        again = (frames.Run(node.children[0], context), (frames.Run(node, context), rest))
        return self._decided(c, context, node.action.condition, again, rest)

    def _counted_loop(self, c: Configuration, node: Node, context: Context, rest: Stack) -> Configuration | None:
        assert isinstance(node.action, ir.CountedLoop)
        return c.at((frames.Iterations(node, context, node.action.iterations), rest))

    def _next_iteration(self, c: Configuration, frame: frames.Iterations, rest: Stack) -> Configuration | None:
        """The next iteration of a counted loop; the last one is followed by what comes after the loop."""
        node, context = frame.node, frame.context
        below = rest if frame.left == 1 else (frames.Iterations(node, context, frame.left - 1), rest)
        return c.at((frames.Run(node.children[0], context), below))

    def _if(self, c: Configuration, node: Node, context: Context, rest: Stack) -> Configuration | None:
        assert isinstance(node.action, ir.IfElse)
        then, otherwise = ((frames.Run(child, context), rest) for child in node.children)
        return self._decided(c, context, node.action.condition, then, otherwise)

    def _catch(self, c: Configuration, node: Node, context: Context, rest: Stack) -> Configuration | None:
        assert isinstance(node.action, ir.CatchException)
        body, handler = node.children
        return c._replace(
            stack=(frames.Run(body, context), (frames.Catch(node.action.exception, handler, context), rest))
        )

    def _assigning(self, c: Configuration, frame: frames.Assign, rest: Stack) -> Configuration | None:
        """Assigns a value that was read."""
        after = c.at(rest)
        return self.assigned(after, frame.context, frame.target, frame.value)._replace(loaded=())

    def _group(self, c: Configuration, node: Node, context: Context, rest: Stack) -> Configuration | None:
        return c.at((frames.Run(node.children[0], context), rest))

    def _instance(self, c: Configuration, node: Node, context: Context, rest: Stack) -> Configuration | None:
        action = node.action
        assert isinstance(action, ir.RunInstance)
        if self.thread.law(context, action.instance) is not None:
            if c.doomed:
                return self.abandoned(c)
            then = frames.Compute(context, action.instance, node)
            return c.at((frames.Reading(context, action.instance, node, None), (then, rest)))
        inner = self.thread.context(context, action.instance)
        below = (frames.Leave(inner), rest)
        if inner.definition.body is None:
            return c.at((frames.Foreign(inner, node), below))
        return c.at((frames.Run(inner.definition.body, inner), below))


def _iteration(configuration: Configuration, iterations: frames.Iterations) -> tuple[Configuration, Configuration]:
    """The beginning of an iteration of a counted loop, whatever its number, and the configuration after the loop.

    If an iteration silently reaches the next one and has changed nothing, the remaining iterations do the same.
    """
    assert configuration.stack is not None
    rest = configuration.stack[1]
    begins = configuration.at((frames.Iterations(iterations.node, iterations.context, 0), rest))
    return begins, configuration.at(rest)
