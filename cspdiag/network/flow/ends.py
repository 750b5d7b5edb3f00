"""Whether a composition may come to its end."""

from __future__ import annotations

from collections.abc import Collection

from cspdiag.network.flow.build import flow_of
from cspdiag.network.flow.code import Call, Instruction
from cspdiag.network.flow.dataflow import solve
from cspdiag.network.ir.actions import Action


def may_end(body: Action, endless: Collection[str] = ()) -> bool:
    """Whether some way leads to the end of a composition; conditions may hold or not, and every communication happens.

    ``endless`` are the names of the instances that never end.
    """

    def transfer(index: int, instruction: Instruction, state: bool) -> bool | None:
        return None if isinstance(instruction, Call) and instruction.step.instance in endless else state

    return solve(flow_of(body), True, transfer, lambda _, states: True)[-1] is not None
