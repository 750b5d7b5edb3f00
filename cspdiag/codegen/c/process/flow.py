"""Whether control can reach the end of an action, as a C compiler determines it."""

from __future__ import annotations

from typing import assert_never

from cspdiag.network.ir import actions as ir


def can_complete(action: ir.Action) -> bool:
    """Whether the action can complete, so what follows it is reachable."""
    match action:
        case ir.RaiseException() | ir.StopStep() | ir.Repeat(until=None):
            return False
        case ir.SequentialSteps(steps=steps):
            return all(can_complete(step) for step in steps)
        case ir.IfElse():
            return can_complete(action.then) or can_complete(action.otherwise)
        case ir.Choice(branches=branches):
            return any(can_complete(branch.body) for branch in branches)
        case ir.CatchException():
            return can_complete(action.body) or can_complete(action.handler)
        case ir.CountedLoop(body=body) | ir.Group(body=body) | ir.ProcessScope(body=body):
            return can_complete(body)
        case (
            ir.RunInstance() | ir.ReadValue() | ir.WriteValue() | ir.AssignValue() | ir.SkipStep() | ir.WaitStep()
            | ir.ResetInstance() | ir.ParallelSteps() | ir.Repeat() | ir.WhileLoop() | ir.InterruptOn()
            | ir.ReadInputs() | ir.WriteOutputs() | ir.RunLaw() | ir.ResetStates() | ir.ReportCommunication()
        ):  # fmt: skip
            return True
        case _:
            assert_never(action)
