"""Branches of an alternative that differ only in numbers that count: they share their code in C.

``alt i < n : request[i] ? question -> reply[i] ! i`` has ``n`` branches in the network, and one in C, which computes
with the number of the guard that was chosen in place of ``i``. That number outlasts what the branch waits for: only the
next selection among the same guards changes it, and the branch contains no alternative.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, assert_never

from cspdiag.base.record import record, replaced
from cspdiag.codegen.c.process.steps.counting import Counter, can_count_from, counting
from cspdiag.codegen.c.process.steps.turns import TurnFinder, in_any_steps
from cspdiag.codegen.c.process.struct.members import Members
from cspdiag.codegen.c.text.code import Code
from cspdiag.codegen.shared.trees import LEAST, Outline, outline, repetitions_from
from cspdiag.network.ir import actions as ir


@record
class Run:
    """The branches from ``start`` to before ``end``, which share their code, and that code as one ``branch``; or a
    single branch as it is.
    """

    start: int
    end: int
    branch: ir.Branch

    @property
    def is_shared(self) -> bool:
        """Whether it is more than one branch."""
        return self.end - self.start > 1


def runs(members: Members, finder: TurnFinder, branches: Sequence[ir.Branch], chosen: Code) -> Iterator[Run]:
    """All branches in order; ``chosen`` is the number of the guard that was chosen."""
    trees: list[tuple[Any, ...]] = [_tree(members, finder, branch) for branch in branches]
    outlines = [outline(tree) if tree else Outline(object(), ()) for tree in trees]
    start = 0
    while start < len(branches):
        times, changes = repetitions_from(outlines, start, 1, in_any_steps)
        if times < LEAST or not can_count_from(start, outlines[start], changes):
            yield Run(start, start + 1, branches[start])
            start += 1
            continue
        counter = Counter(str(chosen), times, start, is_turn=False)
        read, _, body = finder.filled(counting(trees[start], iter(changes)), counter)
        yield Run(start, start + times, _shared(branches[start], read, body))
        start += times


def _tree(members: Members, finder: TurnFinder, branch: ir.Branch) -> tuple[Any, ...]:
    """What a branch does once its guard is chosen, as a tree: the read at its beginning, what else the beginning
    depends on, and the body. None of them if that cannot be shared.
    """
    event = branch.event
    about: list[object] = [type(event), event.span]
    read = None
    match event:
        case ir.InputEvent(source=source, target=target):
            end = members.source(source)
            about += [end.never_waits, end.type]
            if end.never_waits or target.indexes:
                read = finder.tree(ir.ReadValue(span=event.span, source=source, target=target))
                if read is None:
                    return ()
            elif members.written(target.channel) is not None:
                about.append(target.channel)
        case ir.OutputEvent(sink=sink):
            if members.sink(sink).never_waits:  # The guards have a value each.
                return ()
        case ir.ReadyEvent() | ir.AfterEvent() | ir.SkipEvent():
            pass
        case _:
            assert_never(event)
    body = finder.tree(branch.body)
    return () if body is None else (read, tuple(about), body)


def _shared(first: ir.Branch, read: ir.ReadValue | None, body: ir.Action) -> ir.Branch:
    """The first of several branches, with what all of them share."""
    if read is None:
        return replaced(first, body=body)
    return replaced(first, body=body, event=replaced(first.event, source=read.source, target=read.target))
