"""An order of priorities under which every deadline is met, if there is one.

Audsley, "On priority assignment in fixed priority scheduling" (2001): level by level from the least urgent; a task that
meets its deadline at a level may have it, whatever the order of the more urgent ones.
"""

from __future__ import annotations

from collections.abc import Sequence

from cspdiag.analyses.timing.task import Task
from cspdiag.analyses.timing.tasks.response import response_time
from cspdiag.base.record import replaced


def feasible_order(tasks: Sequence[Task]) -> list[int] | None:
    """Indexes of the tasks from the most to the least urgent, or None if no order meets every deadline.

    If several tasks may have a level, the one with the longest deadline gets it: that is the usual order.
    """
    unassigned = list(range(len(tasks)))
    order: list[int] = []
    while unassigned:
        candidates = sorted(unassigned, key=lambda k: (-tasks[k].deadline, -k))
        chosen = next((k for k in candidates if _fits_lowest(tasks, k, unassigned, order)), None)
        if chosen is None:
            return None
        unassigned.remove(chosen)
        order.insert(0, chosen)
    return order


def _fits_lowest(tasks: Sequence[Task], candidate: int, above: Sequence[int], below: Sequence[int]) -> bool:
    others = [replaced(tasks[k], priority=0) for k in above if k != candidate]
    others += [replaced(tasks[k], priority=2) for k in below]
    worst = response_time(replaced(tasks[candidate], priority=1), others).worst
    return worst is not None and worst <= tasks[candidate].deadline
