"""Virtual time of one run: it passes as soon as no process is ready, up to an instant, and from there on again."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

from ..kernel.durations import END_OF_TIME
from ..kernel.scheduler import Scheduler, Task
from ..kernel.stopping import stopping
from ..outside.instants import Instants

_NEVER = END_OF_TIME + 1

Ending = Literal["terminated", "deadlock", "time limit"]


class Paused(Exception):  # noqa: N818 - it says what is the case
    """What makes ready processes run wants a pause; the run continues where it was."""


class VirtualTime:
    """``change`` makes the changes of parameters at an instant; ``last_before`` gives the last instant before the next
    of them, or up to an instant.
    """

    def __init__(
        self,
        scheduler: Scheduler,
        instants: Instants,
        root: Task,
        change: Callable[[int], None],
        last_before: Callable[[int], int],
    ) -> None:
        self._scheduler = scheduler
        self._instants = instants
        self._root = root
        self._change = change
        self._last_before = last_before

    def advance(self, until: int, run_ready: Callable[[], bool], *, step_by_step: bool = False) -> Ending:
        """Passes all instants up to ``until``, at most the end of time, or to the end of the program or a deadlock.

        ``run_ready`` runs parties that are ready; False if none is left. It may raise Paused, if all is done
        ``step_by_step``: then it alone runs parties. It may be called again after that, and at the time limit.
        """
        scheduler = self._scheduler
        timers, heap = scheduler.timers, scheduler.timers.heap
        instants = self._instants
        # The last instant before the next change of a parameter, or before the end of the run.
        last = self._last_before(until)
        root = self._root
        tick = instants.after(scheduler.now) or _NEVER
        ends_delays = scheduler.policy is None and not step_by_step
        while True:
            while run_ready():
                stopping.check()
            if heap and heap[0] < tick and ends_delays:
                scheduler.end_delays(min(tick, last + 1), root)
            if stopping.signal:
                stopping.check()
            if root.ended:
                return "terminated"
            timer = timers.next_instant() if heap else None
            if timer is None:
                awaited_end = instants.awaited_end
                if (awaited_end is None or awaited_end.waiter is None) and not instants.port_can_have_effect():
                    return "deadlock"
            instant = tick if timer is None or tick < timer else timer
            if instant > last:
                if instant > until:
                    return "time limit"
                self._change(instant)
                last = self._last_before(until)
            scheduler.now = instant
            if instant == tick:
                tick = instants.pass_in_virtual_time(tick, last + 1, scheduler, run_ready, root)
            if instant == timer:
                timers.fall_due(instant)

    def next_instant(self) -> int | None:
        """The next instant at which something may happen."""
        timer, tick = self._scheduler.timers.next_instant(), self._instants.after(self._scheduler.now)
        return timer if tick is None or (timer is not None and timer < tick) else tick
