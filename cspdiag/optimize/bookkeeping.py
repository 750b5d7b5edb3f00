"""Removes the state that fair alternatives and priorities need, where it makes no difference.

A fair alternative (``[]``) chooses, of the guards that are ready, the first after the one that it chose last; the first
time it chooses the first in text order. If it chooses at most once, or has only one branch, it behaves like an
alternative that always takes the first ready guard (``[]>``), which needs no memory.

A prioritized parallel (``||>``) differs from a plain one only if processes of different priority are ready together.
Branches enter the ready queue in text order, which is the order of their priorities. If at most one of them can ever
wait, and nothing else runs in parallel, the others run once, in that order, and afterwards no other branch is left.
"""

from __future__ import annotations

from typing import assert_never

from cspdiag.base.record import replaced
from cspdiag.network.flow.repetition import repeated_choices, repeated_classes
from cspdiag.network.flow.waiting import only_computes
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.network import Network, ProcessClass
from cspdiag.optimize.changes import changed, mapped, rebuilt, with_inner_actions


def drop_bookkeeping(network: Network) -> Network:
    """The network with alternatives marked that need no memory, and parallels that need no priorities."""
    again = repeated_classes(network)
    classes = []
    for entry in network.classes:
        if isinstance(entry, ProcessClass) and entry.body is not None:
            body = _without_memory(entry.body, entry.name not in again)
            if entry.name == network.top:
                body = _without_priorities(body)
            entry = changed(entry, body=rebuilt(body, _without_single_branch_priority))
        classes.append(entry)
    return replaced(network, classes=tuple(classes))


def _without_memory(body: ir.Action, runs_once: bool) -> ir.Action:
    again = repeated_choices(body)

    def change(action: ir.Action) -> ir.Action:
        if isinstance(action, ir.Choice) and not action.prioritized:
            chooses_once = runs_once and action.name not in again
            if chooses_once or len(action.branches) == 1:
                action = replaced(action, prioritized=True)
        return with_inner_actions(action, change)

    return change(body)


def _without_single_branch_priority(action: ir.Action) -> ir.Action:
    if isinstance(action, ir.ParallelSteps) and len(action.steps) == 1:
        return changed(action, prioritized=False)
    return action


def _without_priorities(action: ir.Action) -> ir.Action:
    """The composition with its outermost parallels marked as plain where they need no priorities."""
    match action:
        case ir.ParallelSteps(prioritized=True, steps=steps) if sum(map(only_computes, steps)) >= len(steps) - 1:
            return replaced(action, prioritized=False)
        case ir.SequentialSteps():
            return changed(action, steps=mapped(action.steps, _without_priorities))
        case ir.Repeat() | ir.WhileLoop() | ir.CountedLoop() | ir.Group():
            return changed(action, body=_without_priorities(action.body))
        case ir.CatchException():
            return changed(action, body=_without_priorities(action.body), handler=_without_priorities(action.handler))
        case (
            ir.RunInstance() | ir.ReadValue() | ir.WriteValue() | ir.AssignValue() | ir.SkipStep() | ir.StopStep()
            | ir.WaitStep() | ir.ResetInstance() | ir.RaiseException() | ir.ParallelSteps() | ir.Choice() | ir.IfElse()
            | ir.InterruptOn() | ir.ReadInputs() | ir.WriteOutputs() | ir.RunLaw() | ir.ResetStates()
            | ir.ProcessScope() | ir.ReportCommunication()
        ):  # fmt: skip
            return action
        case _:
            assert_never(action)
