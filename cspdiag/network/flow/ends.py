"""Whether a composition may reach its end, and each of its steps."""

from __future__ import annotations

from collections.abc import Collection

from cspdiag.network.flow.build import flow_of
from cspdiag.network.flow.code import Call, Code, Instruction
from cspdiag.network.flow.dataflow import solve
from cspdiag.network.ir.actions import Action


def may_end(body: Action, endless: Collection[str] = ()) -> bool:
    """Whether some path leads to the end of a composition; conditions may hold or not, and every communication happens.

    ``endless`` are the names of the instances that never end.
    """
    return _reached(flow_of(body), endless)[-1]


def every_step_is_reached(body: Action) -> bool:
    """Whether some path leads to each step of each sequence."""
    code = flow_of(body)
    reached = _reached(code)
    return all(reached[start] for _, starts in code.sequences for start in starts)


def _reached(code: Code, endless: Collection[str] = ()) -> list[bool]:
    def transfer(index: int, instruction: Instruction, state: bool) -> bool | None:
        return None if isinstance(instruction, Call) and instruction.step.instance in endless else state

    return [state is not None for state in solve(code, True, transfer, lambda _, states: True)]
