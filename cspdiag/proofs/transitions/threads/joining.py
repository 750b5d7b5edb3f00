"""A thread as the parent of a parallel composition: it starts the branches and waits for them, or cancels them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from cspdiag.base import Span
from cspdiag.model.types import DOUBLE
from cspdiag.network.ir.actions import Action, ParallelSteps, ReadValue, Target, WriteValue
from cspdiag.network.ir.expressions import PresentTime
from cspdiag.proofs.transitions.facts import FAULT
from cspdiag.proofs.transitions.program import Node
from cspdiag.proofs.transitions.systems.template import Label, Parallel
from cspdiag.proofs.transitions.threads.thread import Configuration, Context, Frame, Stack, Thread

if TYPE_CHECKING:
    from cspdiag.proofs.transitions.threads.follow import Follower


def fork_edges(
    thread: Thread, follower: Follower, c: Configuration, node: Node, context: Context, rest: Stack
) -> list[tuple[Label, Configuration]]:
    """The start of all branches."""
    key = (context.path, node)
    parallel = thread.template.parallels.setdefault(key, Parallel(context.path, node))
    caught = follower.faults_are_caught(c)
    raising = any(escaping(thread, child, context, caught=caught) for child in node.children)
    parallel.caught = parallel.caught or caught
    parallel.cancellable = parallel.cancellable or thread.role.cancellable or _is_interruptible(c.stack) or raising
    return [(("fork", key), c._replace(stack=(("join", node, context, "wait"), rest)))]


def _is_interruptible(stack: Stack) -> bool:
    while stack is not None:
        frame, stack = stack
        if frame[0] == "interrupt":
            return True
    return False


def escaping(thread: Thread, branch: Node, context: Context, *, caught: bool) -> list[str]:
    """The exceptions that a branch may raise; faults only where they are caught."""
    found = thread.facts.escaping(branch, context.definition)
    return sorted(found if caught else found - {FAULT})


def join_edges(
    thread: Thread, follower: Follower, c: Configuration, frame: Frame, rest: Stack
) -> list[tuple[Label, Configuration]]:
    """What the parent waits for. The last part of the frame is where it is.

    ``wait``: for the end of all branches, or an exception of one; ``cancelling``, with the exception: the branches are told; ``failing``: it waits for
    their end, and raises it; ``abandon`` and ``abandoned``: the same after an interrupt or its own cancellation. Of several exceptions the first counts, also
    that of a branch that is cancelled and raises it before its next communication.
    """
    _, node, context, stage, *exception = frame
    parallel = (context.path, node)

    def at(stage: str, *more: str) -> Configuration:
        return c._replace(stack=(("join", node, context, stage, *more), rest))

    caught = follower.faults_are_caught(c)
    thrown = [
        (("thrown", parallel, branch, name), name)
        for branch, child in enumerate(node.children)
        for name in escaping(thread, child, context, caught=caught)
    ]
    done = c._replace(stack=rest)
    match stage:
        case "wait":
            return [(("join", parallel), done), *((label, at("cancelling", name)) for label, name in thrown)]
        case "cancelling":
            return [(("cancel", parallel), at("failing", *exception))]
        case "failing":
            several = len({label[2] for label, _ in thrown}) > 1
            ignored = [(label, c) for label, _ in thrown if several]
            return [(("join", parallel), follower.thrown(done, exception[0])), *ignored]
        case "abandon":
            return [
                (("cancel", parallel), at("abandoned")),
                *((label, at("cancelling", name)) for label, name in thrown),
            ]
        case _:
            return [(("join", parallel), done), *((label, at("failing", name)) for label, name in thrown)]


class LawParallels:
    """Control laws with many communications at once: each of them is a branch of a parallel."""

    def __init__(self, thread: Thread, follower: Follower) -> None:
        self.thread = thread
        self.follower = follower

    def fork(
        self, c: Configuration, frame: Frame, rest: Stack, connections: list[Any]
    ) -> list[tuple[Label, Configuration]]:
        """Starts the communications of a law that remain."""
        kind, context, instance, node, remaining = frame
        if c.fetched is not None:
            self.follower.cannot_fuse(c)
        known = context.definition.laws.get((instance, kind, remaining))
        if known is None:
            ends = [connections[position][0].attachment for position in remaining]
            steps = tuple(_step(kind, end, node.span) for end in ends)
            known = Node(ParallelSteps(span=node.span, steps=steps, prioritized=False))
            context.definition.laws[instance, kind, remaining] = known
        return fork_edges(self.thread, self.follower, c, known, context, rest)


def _step(kind: str, end: Any, span: Span) -> Action:
    if kind == "reading":
        return ReadValue(span=span, source=end, target=Target(""))
    return WriteValue(span=span, sink=end, value=PresentTime(type=DOUBLE))
