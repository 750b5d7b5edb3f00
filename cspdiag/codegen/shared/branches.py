"""Branches of a composition: names for those that have none in the text, and which only run instances."""

from __future__ import annotations

from collections.abc import Sequence

from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.walk import instances_run, parts


def branch_name(action: ir.Action) -> str:
    """A name for what an action does: ``repeat_prefix``, ``read_input``."""
    runs = list(dict.fromkeys(instances_run(action)))
    if len(runs) == 1:
        return f"repeat_{runs[0]}" if isinstance(action, ir.Repeat) else f"run_{runs[0]}"
    joined = "_then_".join(runs)
    if runs and isinstance(action, ir.SequentialSteps) and len(joined) <= 40:
        return joined
    for part in parts(action):
        match part:
            case ir.ReadValue(source=end):
                return f"read_{_name_of(end)}"
            case ir.WriteValue(sink=end):
                return f"write_{_name_of(end)}"
            case ir.Choice():
                return "choose"
            case ir.WaitStep():
                return "wait"
            case ir.RunLaw(law=law):
                return f"run_{law.rpartition('.')[2]}"
            case _:
                pass  # The next part may say more.
    return "branch"


def _name_of(end: ir.End) -> str:
    return end.port if isinstance(end, ir.PortEnd) else end.channel


def runs_instances(action: ir.Action) -> bool:
    """Whether it is a parallel of instances and of nothing else."""
    return isinstance(action, ir.ParallelSteps) and all(isinstance(step, ir.RunInstance) for step in action.steps)


def runs_in_order(steps: Sequence[ir.Action], start: int, instances: Sequence[str]) -> bool:
    """Whether the steps from ``start`` on run these instances, one after the other."""
    if start + len(instances) > len(steps):
        return False
    return all(
        isinstance(step := steps[position], ir.RunInstance) and step.instance == name
        for position, name in enumerate(instances, start)
    )
