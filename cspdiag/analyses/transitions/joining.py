"""A thread as the parent of a parallel composition: it starts the branches and waits for them, or cancels them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from cspdiag.analyses.transitions.program import Node
from cspdiag.analyses.transitions.template import Label, Parallel, ParallelId
from cspdiag.analyses.transitions.thread import Configuration, Context, Frame, Stack, Thread
from cspdiag.diagnostics import Span
from cspdiag.model.types import DOUBLE
from cspdiag.network.actions import Action, ParallelSteps, ReadValue, Target, WriteValue
from cspdiag.network.expressions import PresentTime

if TYPE_CHECKING:
    from cspdiag.analyses.transitions.follow import Follower


def fork_edges(
    thread: Thread, c: Configuration, node: Node, context: Context, rest: Stack
) -> list[tuple[Label, Configuration]]:
    """The start of all branches."""
    parallel = _parallel(thread, c, node, context)
    return [(("fork", parallel), c._replace(stack=(("join", node, context, "wait"), rest)))]


def _parallel(thread: Thread, c: Configuration, node: Node, context: Context) -> ParallelId:
    key = (context.path, node)
    parallel = thread.template.parallels.setdefault(key, Parallel(context.path, node))
    stack, interrupted = c.stack, False
    while stack is not None:
        interrupted = interrupted or stack[0][0] == "interrupt"
        stack = stack[1]
    raising = any(thread.facts.escaping(child, context.definition) for child in node.children)
    parallel.cancellable = parallel.cancellable or thread.role.cancellable or interrupted or raising
    return key


def join_edges(
    thread: Thread, follower: Follower, c: Configuration, frame: Frame, rest: Stack
) -> list[tuple[Label, Configuration]]:
    """What the parent waits for. The last part of the frame is where it is.

    ``wait``: for the end of all branches, or an exception of one; ``cancelling``, with the exception: the branches are told; ``failing``: it waits for
    their end, and raises it; ``abandon`` and ``abandoned``: the same after an interrupt or its own cancellation.
    """
    _, node, context, stage, *exception = frame
    parallel = (context.path, node)

    def at(stage: str, *more: str) -> Configuration:
        return c._replace(stack=(("join", node, context, stage, *more), rest))

    done = c._replace(stack=rest)
    match stage:
        case "wait":
            found: list[tuple[Label, Configuration]] = [(("join", parallel), done)]
            for branch, child in enumerate(node.children):
                for name in sorted(thread.facts.escaping(child, context.definition)):
                    found.append((("thrown", parallel, branch, name), at("cancelling", name)))
            return found
        case "cancelling":
            return [(("cancel", parallel), at("failing", *exception))]
        case "failing":
            return [(("join", parallel), follower.thrown(done, exception[0]))]
        case "abandon":
            return [(("cancel", parallel), at("abandoned"))]
        case _:
            return [(("join", parallel), done)]


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
        return fork_edges(self.thread, c, known, context, rest)


def _step(kind: str, end: Any, span: Span) -> Action:
    if kind == "reading":
        return ReadValue(span=span, source=end, target=Target(""))
    return WriteValue(span=span, sink=end, value=PresentTime(type=DOUBLE))
