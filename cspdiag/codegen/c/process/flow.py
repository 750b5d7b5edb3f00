"""Whether control reaches the end of an action, as a C compiler sees it."""

from __future__ import annotations

from typing import assert_never

from cspdiag.network.ir.actions import (
    Action,
    AssignValue,
    CatchException,
    Choice,
    CountedLoop,
    Group,
    IfElse,
    InterruptOn,
    ParallelSteps,
    ProcessScope,
    RaiseException,
    ReadInputs,
    ReadValue,
    Repeat,
    ReportCommunication,
    ResetInstance,
    ResetStates,
    RunInstance,
    RunLaw,
    SequentialSteps,
    SkipStep,
    StopStep,
    WaitStep,
    WhileLoop,
    WriteOutputs,
    WriteValue,
)


def ends(action: Action) -> bool:
    """Whether something may follow the action."""
    match action:
        case RaiseException() | StopStep() | Repeat(until=None):
            return False
        case SequentialSteps(steps=steps):
            return all(ends(step) for step in steps)
        case IfElse():
            return ends(action.then) or ends(action.otherwise)
        case Choice(branches=branches):
            return any(ends(branch.body) for branch in branches)
        case CatchException():
            return ends(action.body) or ends(action.handler)
        case CountedLoop(body=body) | Group(body=body) | ProcessScope(body=body):
            return ends(body)
        case (
            RunInstance() | ReadValue() | WriteValue() | AssignValue() | SkipStep() | WaitStep() | ResetInstance()
            | ParallelSteps() | Repeat() | WhileLoop() | InterruptOn() | ReadInputs() | WriteOutputs() | RunLaw()
            | ResetStates() | ReportCommunication()
        ):  # fmt: skip
            return True
        case _:
            assert_never(action)
