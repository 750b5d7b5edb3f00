"""Whether control comes to the end of an action, as a C compiler sees it."""

from __future__ import annotations

from cspdiag.network.ir.actions import (
    Action,
    CatchException,
    Choice,
    CountedLoop,
    Group,
    IfElse,
    ProcessScope,
    RaiseException,
    Repeat,
    SequentialSteps,
    StopStep,
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
        case _:
            return True
