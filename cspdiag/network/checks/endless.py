"""Whether a program surely never comes to its end by itself."""

from __future__ import annotations

from typing import assert_never

from cspdiag.network.infer.ends import all_actions
from cspdiag.network.ir.actions import (
    Action,
    AssignValue,
    CatchException,
    Choice,
    CountedLoop,
    Group,
    IfElse,
    InterruptOn,
    OptimizedStep,
    ParallelSteps,
    RaiseException,
    ReadValue,
    Repeat,
    ResetInstance,
    RunInstance,
    SequentialSteps,
    SkipStep,
    StopStep,
    WaitStep,
    WhileLoop,
    WriteValue,
)
from cspdiag.network.ir.network import Network, ProcessClass, SubmodelClass


def never_ends(network: Network) -> bool:
    """Whether no way leads to the end of the outermost process: some part always stands before it that goes on for ever.

    Missed samples and faults are not thought of, nor is anything said of a program that raises exceptions of its own.
    """
    bodies = {made.name: None if isinstance(made, SubmodelClass) else made.body for made in network.classes}
    # After a `raise` parts end that would not.
    if any(
        isinstance(part, RaiseException) for body in bodies.values() if body is not None for part in all_actions(body)
    ):
        return False
    ends: dict[str, bool] = {}
    for made in network.classes:
        body = bodies[made.name]
        ends[made.name] = isinstance(made, SubmodelClass) or body is None or _Ends(made, ends).of(body)
    return not ends[network.top]


class _Ends:
    """Whether actions of a process may come to their end; ``known`` says it of the classes of its instances."""

    def __init__(self, process: ProcessClass, known: dict[str, bool]) -> None:
        self.classes = {instance.name: instance.class_name for instance in process.instances}
        self.known = known

    def of(self, action: Action) -> bool:
        match action:
            case RunInstance():
                return self.known[self.classes[action.instance]]
            case ReadValue() | WriteValue() | AssignValue() | SkipStep() | WaitStep() | ResetInstance():
                return True
            case StopStep() | RaiseException():
                return False
            case SequentialSteps() | ParallelSteps():
                return all(self.of(step) for step in action.steps)
            case Choice():
                return any(self.of(branch.body) for branch in action.branches)
            case Repeat():
                return self.of(action.body) and action.until is not None
            case WhileLoop():
                return True
            case CountedLoop():
                return self.of(action.body)
            case IfElse():
                return self.of(action.then) or self.of(action.otherwise)
            case CatchException():
                return self.of(action.body) or self.of(action.handler)
            case InterruptOn():
                return self.of(action.body) or self.of(action.branch.body)
            case Group():
                return self.of(action.body)
            case OptimizedStep():
                return True
            case _:
                assert_never(action)
