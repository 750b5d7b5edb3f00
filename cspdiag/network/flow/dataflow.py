"""The dataflow solver: propagates states along the edges until a fixpoint is reached."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

from cspdiag.network.flow.code import Code, Instruction, Join

State = TypeVar("State")


def solve(
    code: Code,
    start: State,
    transfer: Callable[[int, Instruction, State], State | None],
    merge: Callable[[Instruction, list[State]], State],
) -> list[State | None]:
    """The state before each instruction; None if it is unreachable.

    ``transfer`` returns the state after the instruction with that index, None if it never ends; ``merge`` returns the
    state before an instruction that several paths reach (a ``Join``: all branches), with those of ``code.before``
    first, in their order. Both must be monotone on a lattice of finite height, otherwise the solver may not terminate.
    """
    count = len(code.instructions)
    entering: list[State | None] = [None] * count
    leaving: list[State | None] = [None] * count
    abandoning: dict[int, list[int]] = {}
    for index, target in enumerate(code.abandoned):
        if target is not None:
            abandoning.setdefault(target, []).append(index)

    def before(index: int) -> State | None:
        instruction = code.instructions[index]
        if index > 0 and len(code.before[index]) == 1 and index not in abandoning:
            return leaving[code.before[index][0]]
        ways = [leaving[earlier] for earlier in code.before[index]]
        if isinstance(instruction, Join) and None in ways:
            return None
        ways += [entering[earlier] for earlier in abandoning.get(index, ())]
        reached = [way for way in ways if way is not None]
        if index == 0:
            reached.append(start)
        return merge(instruction, reached) if len(reached) > 1 else reached[0] if reached else None

    # In the order of the text: each instruction after all that lead to it, except those of a loop, which is followed
    # again where that changes it.
    index = 0
    while index < count:
        state = entering[index] = before(index)
        leaving[index] = None if state is None else transfer(index, code.instructions[index], state)
        loop = code.back.get(index)
        index = loop if loop is not None and before(loop) != entering[loop] else index + 1
    return entering
