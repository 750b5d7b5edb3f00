"""What to call a part of a composition that has no name in the text."""

from __future__ import annotations

from cspdiag.network.ir.actions import (
    Action,
    Choice,
    End,
    PortEnd,
    ReadValue,
    Repeat,
    RunLaw,
    SequentialSteps,
    WaitStep,
    WriteValue,
)
from cspdiag.network.ir.walk import instances_run, parts


def branch_name(action: Action) -> str:
    """A name after what it does: ``repeat_prefix``, ``read_input``."""
    runs = list(dict.fromkeys(instances_run(action)))
    if len(runs) == 1:
        return f"repeat_{runs[0]}" if isinstance(action, Repeat) else f"run_{runs[0]}"
    joined = "_then_".join(runs)
    if runs and isinstance(action, SequentialSteps) and len(joined) <= 40:
        return joined
    for part in parts(action):
        match part:
            case ReadValue(source=end):
                return f"read_{_name_of(end)}"
            case WriteValue(sink=end):
                return f"write_{_name_of(end)}"
            case Choice():
                return "choose"
            case WaitStep():
                return "wait"
            case RunLaw(law=law):
                return f"run_{law.rpartition('.')[2]}"
            case _:
                pass  # The next part may say more.
    return "branch"


def _name_of(end: End) -> str:
    return end.port if isinstance(end, PortEnd) else end.channel
