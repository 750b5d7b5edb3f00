"""One solver for analyses of control flow: states go along the edges until nothing changes."""

from __future__ import annotations

from collections.abc import Callable
from heapq import heappop, heappush
from typing import TypeVar

from cspdiag.network.flow.code import Code, Instruction, Join

State = TypeVar("State")


def solve(
    code: Code,
    start: State,
    transfer: Callable[[int, Instruction, State], State | None],
    merge: Callable[[Instruction, list[State]], State],
) -> list[State | None]:
    """The state before each instruction; None where it is never reached.

    ``transfer`` gives the state after the instruction with that index, None if it never ends; ``merge`` gives the state before one that
    is reached in several ways (a ``Join``: by all branches), those of ``code.before`` in their order first. Both must be monotone on a lattice
    of finite height, or it never ends.
    """
    count = len(code.instructions)
    entering: list[State | None] = [None] * count
    leaving: list[State | None] = [None] * count
    abandoning: list[list[int]] = [[] for _ in range(count)]
    for index, target in enumerate(code.abandoned):
        if target is not None:
            abandoning[target].append(index)
    # In the order of the text: each instruction after all that lead to it but by way of a loop.
    pending, queued = [0], {0}
    while pending:
        index = heappop(pending)
        queued.discard(index)
        instruction = code.instructions[index]
        ways = [leaving[earlier] for earlier in code.before[index]]
        if isinstance(instruction, Join) and None in ways:
            continue
        ways += [entering[earlier] for earlier in abandoning[index]]
        reached = [way for way in ways if way is not None]
        if index == 0:
            reached.append(start)
        state = reached[0] if len(reached) == 1 else merge(instruction, reached)
        if state == entering[index]:
            continue
        entering[index] = state
        leaving[index] = transfer(index, instruction, state)
        target = code.abandoned[index]
        onwards = [] if leaving[index] is None else code.after[index]
        for later in onwards if target is None else [*onwards, target]:
            if later not in queued:
                queued.add(later)
                heappush(pending, later)
    return entering
