"""A thread as the parent of a parallel composition: it starts the branches and waits for them, or cancels them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, TypeAlias, assert_never

from cspdiag.base import Span
from cspdiag.model.types import DOUBLE
from cspdiag.network.ir.actions import CoreAction, ParallelSteps, ReadValue, Target, WriteValue
from cspdiag.network.ir.expressions import PresentTime
from cspdiag.proofs.transitions.classes.built_in_exceptions import FAULT
from cspdiag.proofs.transitions.classes.program import Node
from cspdiag.proofs.transitions.systems.labels import Cancel, Fork, Join, Label, Thrown
from cspdiag.proofs.transitions.systems.template import Parallel
from cspdiag.proofs.transitions.threads import frames
from cspdiag.proofs.transitions.threads.context import Context
from cspdiag.proofs.transitions.threads.thread import Configuration, Thread

if TYPE_CHECKING:
    from cspdiag.proofs.transitions.threads.silent.follow import Follower


Side: TypeAlias = Literal["reading", "writing"]


def fork_edges(
    thread: Thread, follower: Follower, c: Configuration, node: Node, context: Context, rest: frames.Stack
) -> list[tuple[Label, Configuration]]:
    """The edge that starts all branches."""
    key = (context.path, node)
    parallel = thread.template.parallels.setdefault(key, Parallel(context.path, node))
    caught = follower.faults_are_caught(c)
    raising = any(escaping(thread, child, context, caught=caught) for child in node.children)
    parallel.caught = parallel.caught or caught
    parallel.cancellable = (
        parallel.cancellable or thread.role.cancellable or frames.is_interruptible(c.stack) or raising
    )
    return [(Fork(key), c.at((frames.Join(node, context, "wait"), rest)))]


def escaping(thread: Thread, branch: Node, context: Context, *, caught: bool) -> list[str]:
    """The exceptions that a branch may raise; faults only if they are ``caught``."""
    found = thread.facts.escaping(branch, context.definition)
    return sorted(found if caught else found - {FAULT})


def join_edges(
    thread: Thread, follower: Follower, c: Configuration, frame: frames.Join, rest: frames.Stack
) -> list[tuple[Label, Configuration]]:
    """The edges of a parent that waits for its branches; ``frame.stage`` says for what.

    ``wait``: for the end of all branches, or an exception of one; ``cancelling``, with the exception: the branches are
    cancelled; ``failing``: it waits until they have ended, and raises the exception; ``abandon`` and ``abandoned``: the
    same after an interrupt or its own cancellation. Of several exceptions the first counts, even if the branch that
    raises it has been cancelled and raises it before its next communication.
    """
    node, context = frame.node, frame.context
    parallel = (context.path, node)

    def at(stage: frames.Stage, exception: str | None = None) -> Configuration:
        return c.at((frames.Join(node, context, stage, exception), rest))

    caught = follower.faults_are_caught(c)
    thrown = [
        (Thrown(parallel, branch, name), name)
        for branch, child in enumerate(node.children)
        for name in escaping(thread, child, context, caught=caught)
    ]
    done = c.at(rest)
    match frame.stage:
        case "wait":
            return [(Join(parallel), done), *((label, at("cancelling", name)) for label, name in thrown)]
        case "cancelling":
            return [(Cancel(parallel), at("failing", frame.exception))]
        case "failing":
            several = len({label.branch for label, _ in thrown}) > 1
            ignored = [(label, c) for label, _ in thrown if several]
            assert frame.exception is not None
            return [(Join(parallel), follower.thrown(done, frame.exception)), *ignored]
        case "abandon":
            return [
                (Cancel(parallel), at("abandoned")),
                *((label, at("cancelling", name)) for label, name in thrown),
            ]
        case "abandoned":
            return [(Join(parallel), done), *((label, at("failing", name)) for label, name in thrown)]
        case _:
            assert_never(frame.stage)


class LawParallels:
    """Control laws with many communications at once: each communication becomes a branch of a parallel."""

    def __init__(self, thread: Thread, follower: Follower) -> None:
        self.thread = thread
        self.follower = follower

    def fork(
        self, c: Configuration, frame: frames.Reading | frames.Writing, rest: frames.Stack, connections: list[Any]
    ) -> list[tuple[Label, Configuration]]:
        """The edge that starts the remaining communications of a control law."""
        context, node, remaining = frame.context, frame.node, frame.remaining
        assert remaining is not None
        side: Side = "reading" if isinstance(frame, frames.Reading) else "writing"
        if c.fetched is not None:
            self.follower.cannot_fuse(c)
        known = context.definition.laws.get((frame.instance, side, remaining))
        if known is None:
            ends = [connections[position][0].attachment for position in remaining]
            steps = tuple(_step(side, end, node.span) for end in ends)
            known = Node(ParallelSteps(span=node.span, steps=steps, prioritized=False))
            context.definition.laws[frame.instance, side, remaining] = known
        return fork_edges(self.thread, self.follower, c, known, context, rest)


def _step(side: Side, end: Any, span: Span) -> CoreAction:
    match side:
        case "reading":
            return ReadValue(span=span, source=end, target=Target(""))
        case "writing":
            return WriteValue(span=span, sink=end, value=PresentTime(type=DOUBLE))
        case _:
            assert_never(side)
