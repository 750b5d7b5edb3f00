"""Whether control reaches the end of an action, as a C compiler sees it."""

from __future__ import annotations

from typing import assert_never

from cspdiag.network.ir import actions as ir


def ends(action: ir.Action) -> bool:
    """Whether something may follow the action."""
    match action:
        case ir.RaiseException() | ir.StopStep() | ir.Repeat(until=None):
            return False
        case ir.SequentialSteps(steps=steps):
            return all(ends(step) for step in steps)
        case ir.IfElse():
            return ends(action.then) or ends(action.otherwise)
        case ir.Choice(branches=branches):
            return any(ends(branch.body) for branch in branches)
        case ir.CatchException():
            return ends(action.body) or ends(action.handler)
        case ir.CountedLoop(body=body) | ir.Group(body=body) | ir.ProcessScope(body=body):
            return ends(body)
        case (
            ir.RunInstance() | ir.ReadValue() | ir.WriteValue() | ir.AssignValue() | ir.SkipStep() | ir.WaitStep()
            | ir.ResetInstance() | ir.ParallelSteps() | ir.Repeat() | ir.WhileLoop() | ir.InterruptOn()
            | ir.ReadInputs() | ir.WriteOutputs() | ir.RunLaw() | ir.ResetStates() | ir.ReportCommunication()
        ):  # fmt: skip
            return True
        case _:
            assert_never(action)
