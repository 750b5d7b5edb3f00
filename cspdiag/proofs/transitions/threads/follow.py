"""The silent steps of a thread: what it does on its own, without a choice, until it comes to something that others take part in or may see."""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property

from cspdiag.network.ir.actions import (
    AssignValue,
    CatchException,
    Choice,
    CountedLoop,
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
from cspdiag.network.ir.expressions import Expression
from cspdiag.proofs.transitions.facts import FAULT
from cspdiag.proofs.transitions.occurrences import PATIENT
from cspdiag.proofs.transitions.program import Node
from cspdiag.proofs.transitions.threads.law_steps import LawSteps
from cspdiag.proofs.transitions.threads.thread import Configuration, Context, NeedsLoad, Restart, Stack, reading_end
from cspdiag.proofs.transitions.values import ANY, UNKNOWN, EvaluationFault

_MANY_STEPS = 5_000
"""After so many silent steps the variables that change are not followed any longer."""

POINTS = frozenset(
    {"run", "put", "delivering", "choice", "reading", "writing", "foreign", "foreign port", "pass", "guard only"}
)
"""What may be first on the stack where a cancelled or interrupted process ends."""


class Follower(LawSteps):
    """Takes the silent steps of one thread."""

    @cached_property
    def _settled(self) -> dict[Configuration, Configuration]:
        """Where the thread is after the choices that it came to: to one with many guards it comes back from each of them."""
        return {}

    def settled(self, start: Configuration) -> Configuration:
        """Where the thread is once it can do nothing more on its own. A circle of silent steps ends in a frame ``diverges``."""
        choices: list[Configuration] = []
        end = self._end_of(start, choices)
        self._settled.update(dict.fromkeys(choices, end))
        return end

    def _end_of(self, start: Configuration, choices: list[Configuration]) -> Configuration:
        configuration = start
        seen: dict[Configuration, None] = {}
        steps = 0
        while True:
            if _is_choice(configuration):
                known = self._settled.get(configuration)
                if known is not None:
                    return known
                choices.append(configuration)
            turn = _turn(configuration)
            if turn is not None:
                begins, after = turn
                if begins in seen:
                    configuration = after
                    continue
                seen[begins] = None
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
            self.compute_risk(c, context, action.value)
            return self.assigned(c._replace(stack=rest), context, action.target, UNKNOWN)._replace(loaded=())
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
            self.risk(c, action.span)
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
            puts = tuple(("put", reference, part, node) for part in self.thread.pieces(reference, value))
            put = puts[0] if len(puts) == 1 else ("split", puts)
            c = self.spent(c) if value == ANY else c
            return c._replace(stack=(put, rest), loaded=())
        if kind == "var" and self.thread.medium(reference).relevant:
            value = self.evaluate(c, context, action.value)
            return self.stored(c._replace(stack=rest), reference, value)._replace(loaded=())
        return c._replace(stack=rest, loaded=())

    def _wait(self, c: Configuration, node: Node, context: Context, rest: Stack) -> Configuration | None:
        if not c.doomed:
            assert isinstance(node.action, WaitStep)
            self.compute_risk(c, context, node.action.duration)
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

    def _turns(self, c: Configuration, node: Node, context: Context, rest: Stack) -> Configuration | None:
        assert isinstance(node.action, CountedLoop)
        return c._replace(stack=(("turns", node, context, node.action.turns), rest))

    def _next_turn(self, c: Configuration, frame: tuple[object, ...], rest: Stack) -> Configuration | None:
        """The turns that are left: the last one is followed by what comes after the loop."""
        _, node, context, left = frame
        assert isinstance(node, Node)
        assert isinstance(left, int)
        below = rest if left == 1 else (("turns", node, context, left - 1), rest)
        return c._replace(stack=(("run", node.children[0], context), below))

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
        """The conditions of the guards one after the other: None where one does not hold, else what the guard will write, and whether that is left open."""
        _, node, context, decided = frame
        assert isinstance(node, Node)
        assert isinstance(context, Context)
        assert isinstance(node.action, Choice)
        assert isinstance(decided, tuple)
        branches = node.action.branches
        if len(decided) == len(branches):
            kind = "picking" if any(entry is not None and entry[1] for entry in decided) else "choice"
            return c._replace(stack=((kind, node, context, decided), rest))
        branch = branches[len(decided)]
        held, is_open = c._replace(stack=rest), False
        if branch.condition is not None:
            found = self.outcomes(c, context, branch.condition)
            no = (("deciding", node, context, (*decided, None)), rest)
            is_open = len(found) > 1 and all(given is c for _, given in found)
            if len(found) > 1 and not is_open:
                yes = (("offering", node, context, decided, False), rest)
                return c._replace(stack=(("open", context, branch.condition, yes, no), None))
            holds, held = found[0]
            if not holds:
                return held._replace(stack=no, loaded=())
        return held._replace(stack=(("offering", node, context, decided, is_open), rest), loaded=c.loaded)

    def _offering(self, c: Configuration, frame: tuple[object, ...], rest: Stack) -> Configuration | None:
        _, node, context, decided, is_open = frame
        assert isinstance(node, Node)
        assert isinstance(context, Context)
        assert isinstance(node.action, Choice)
        assert isinstance(decided, tuple)
        value = self.offered(c, context, node.action.branches[len(decided)])
        return c._replace(stack=(("deciding", node, context, (*decided, (value, is_open))), rest), loaded=())

    def _assigning(self, c: Configuration, frame: tuple[object, ...], rest: Stack) -> Configuration | None:
        """What was read goes into its variable."""
        _, context, target, value = frame
        assert isinstance(context, Context)
        assert isinstance(target, Target)
        return self.assigned(c._replace(stack=rest), context, target, value)._replace(loaded=())  # type: ignore[arg-type]

    def _storing(self, c: Configuration, frame: tuple[object, ...], rest: Stack) -> Configuration | None:
        _, reference, value = frame
        return self.stored(c._replace(stack=rest), reference, value)  # type: ignore[arg-type]

    def _interrupt(self, c: Configuration, node: Node, context: Context, rest: Stack) -> Configuration | None:
        if c.doomed:
            return self.abandoned(c)
        return self.passing(c, (("interrupting", node, context), rest), node)

    def _interrupting(self, c: Configuration, frame: tuple[object, ...], rest: Stack) -> Configuration | None:
        _, node, context = frame
        assert isinstance(node, Node)
        assert isinstance(context, Context)
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
        event = node.action.branch.event
        if value == ANY and isinstance(event, OutputEvent):
            value = UNKNOWN
            self.not_shown(context, self.thread.medium(context.reference(event.sink)), "that is chosen", event.span)
        if isinstance(event, ReadyEvent | InputEvent):
            reference = context.reference(event.source)
            if self.thread.medium(reference).kind == "sampled":
                c = self.thread.beginning(c, context, reading_end(context, event.source))
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

    def _body_ends(self, c: Configuration, frame: tuple[object, ...], rest: Stack) -> Configuration | None:
        return c._replace(stack=(("closing", frame, None), rest) if self.may_be_chosen(c, frame) else rest)

    def _pop(self, c: Configuration, frame: tuple[object, ...], rest: Stack) -> Configuration | None:
        return c._replace(stack=rest)


def _turn(configuration: Configuration) -> tuple[Configuration, Configuration] | None:
    """What a turn of a counted loop begins with, whichever it is, and what comes after all turns.

    A turn that came silently to the next one and changed nothing is as those that are left.
    """
    stack = configuration.stack
    if stack is None or stack[0][0] != "turns":
        return None
    (kind, node, context, _), rest = stack
    begins = configuration._replace(stack=((kind, node, context, 0), rest))
    return begins, configuration._replace(stack=rest)


def _is_choice(configuration: Configuration) -> bool:
    stack = configuration.stack
    return stack is not None and stack[0][0] == "run" and isinstance(stack[0][1].action, Choice)


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
    CountedLoop: Follower._turns,
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
    "interrupt": Follower._body_ends,
    "interruptible": Follower._interruptible,
    "interrupting": Follower._interrupting,
    "leave": Follower._leave,
    "deciding": Follower._deciding,
    "offering": Follower._offering,
    "reading": Follower._reading,
    "compute": Follower._compute,
    "turns": Follower._next_turn,
    "storing": Follower._storing,
    "writing": Follower._writing,
}
