"""The silent steps of conditions and guards: their evaluation, before one of them is chosen."""

from __future__ import annotations

from cspdiag.network.ir.actions import Choice, InputEvent, InterruptOn, OutputEvent, ReadyEvent
from cspdiag.network.ir.expressions import Expression
from cspdiag.proofs.transitions.classes.program import Node
from cspdiag.proofs.transitions.threads import frames
from cspdiag.proofs.transitions.threads.context import Context
from cspdiag.proofs.transitions.threads.frames import Stack
from cspdiag.proofs.transitions.threads.silent.law_steps import LawSteps
from cspdiag.proofs.transitions.threads.thread import Configuration, reading_end
from cspdiag.proofs.transitions.values import ANY, UNKNOWN


class GuardSteps(LawSteps):
    """Evaluates the conditions and guards of one thread."""

    def _decided(
        self, c: Configuration, context: Context, condition: Expression, then: Stack, otherwise: Stack
    ) -> Configuration | None:
        found = self.outcomes(c, context, condition)
        if len(found) > 1:
            return c.at((frames.Open(context, condition, then, otherwise), None))
        ((holds, given),) = found
        return given._replace(stack=then if holds else otherwise, loaded=())

    def _choice(self, c: Configuration, node: Node, context: Context, rest: Stack) -> Configuration | None:
        if c.doomed:
            return self.abandoned(c)
        assert isinstance(node.action, Choice)
        if c.fetched is not None and not all(
            isinstance(branch.event, ReadyEvent | InputEvent) and context.reference(branch.event.source) == c.fetched[0]
            for branch in node.action.branches
        ):
            self.cannot_fuse(c)
        return c.at((frames.Deciding(node, context, ()), rest))

    def _deciding(self, c: Configuration, frame: frames.Deciding, rest: Stack) -> Configuration | None:
        """Evaluates the next condition: adds None to what is decided if it does not hold."""
        node, context, decided = frame.node, frame.context, frame.decided
        assert isinstance(node.action, Choice)
        branches = node.action.branches
        if len(decided) == len(branches):
            is_open = any(entry is not None and entry[1] for entry in decided)
            waits = (frames.Picking if is_open else frames.Choosing)(node, context, decided)
            return c.at((waits, rest))
        branch = branches[len(decided)]
        held, is_open = c.at(rest), False
        if branch.condition is not None:
            found = self.outcomes(c, context, branch.condition)
            no = (frames.Deciding(node, context, (*decided, None)), rest)
            is_open = len(found) > 1 and all(given is c for _, given in found)
            if len(found) > 1 and not is_open:
                yes = (frames.Offering(node, context, decided, False), rest)
                return c.at((frames.Open(context, branch.condition, yes, no), None))
            holds, held = found[0]
            if not holds:
                return held._replace(stack=no, loaded=())
        return held._replace(stack=(frames.Offering(node, context, decided, is_open), rest), loaded=c.loaded)

    def _offering(self, c: Configuration, frame: frames.Offering, rest: Stack) -> Configuration | None:
        node, context, decided = frame.node, frame.context, frame.decided
        assert isinstance(node.action, Choice)
        value = self.offered(c, context, node.action.branches[len(decided)])
        return c._replace(stack=(frames.Deciding(node, context, (*decided, (value, frame.is_open))), rest), loaded=())

    def _interrupt(self, c: Configuration, node: Node, context: Context, rest: Stack) -> Configuration | None:
        if c.doomed:
            return self.abandoned(c)
        return self.passing(c, (frames.Interrupting(node, context), rest), node)

    def _interrupting(self, c: Configuration, frame: frames.Interrupting, rest: Stack) -> Configuration | None:
        node, context = frame.node, frame.context
        assert isinstance(node.action, InterruptOn)
        branch = node.action.branch
        body = frames.Run(node.children[0], context)
        if branch.condition is not None:
            yes = (frames.Interruptible(node, context), rest)
            return self._decided(c, context, branch.condition, yes, (body, rest))
        return c.at((frames.Interruptible(node, context), rest))

    def _interruptible(self, c: Configuration, frame: frames.Interruptible, rest: Stack) -> Configuration | None:
        node, context = frame.node, frame.context
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
        guard = frames.Interrupt(node, context, value)
        return c._replace(stack=(frames.Run(node.children[0], context), (guard, rest)), loaded=())
