"""The environment of a guided run, and its time: it offers what the script needs, and gives samples at their ticks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import lcm
from typing import Any, Literal

from cspdiag.runtime.advance.stepwise import StepwiseRun
from cspdiag.runtime.kernel.durations import END_OF_TIME
from cspdiag.runtime.outside.event_inputs import EventInput
from cspdiag.runtime.outside.external import Port
from cspdiag.runtime.outside.sampled_inputs import SampledInput
from cspdiag.verify.guided.script import Passed, Script

MOST_TICKS = 40
"""The number of instants at which one thing may arrive."""


class _Line:
    """A port's side of the environment."""

    def __init__(self) -> None:
        self.value: Any = None

    def read(self) -> Any:
        return self.value

    def write(self, value: Any) -> None:
        """Takes everything."""


class Lines(dict[str, _Line]):
    """The environment, by port."""

    def __missing__(self, name: str) -> _Line:
        line = self[name] = _Line()
        return line


class World:
    """The environment of a program. ``defaults`` are the values, by channel, of inputs for which the script needs none;
    ``met`` counts the instants.
    """

    def __init__(
        self,
        ports: Sequence[Port],
        lines: Lines,
        script: Script,
        defaults: Mapping[str, Any],
        on_miss: Literal["timeout", "count"],
    ) -> None:
        self._lines = lines
        self._script = script
        self._present = dict(defaults)
        self._sampled = [port for port in ports if isinstance(port, SampledInput)]
        self._events = {port.name: port for port in ports if isinstance(port, EventInput)}
        self.met = 0
        for port in self._sampled:
            port.on_miss = on_miss

    def begin(self, run: StepwiseRun) -> None:
        """From now on it is the environment of a run."""
        self._run = run

    @property
    def inputs(self) -> frozenset[str]:
        """The channels at which it offers values."""
        return frozenset({*self._events, *(port.name for port in self._sampled)})

    def can_offer(self, entry: Passed) -> bool:
        """Whether an entry needs a value that was not offered yet."""
        if entry.action != "read" or entry.channel not in self._events:
            return False
        return not self._events[entry.channel].end_of(entry.path).fresh

    def offer(self, entry: Passed) -> None:
        """Offers what the entry needs, now."""
        self._events[entry.channel].occur(entry.value)

    @property
    def time_can_pass(self) -> bool:
        """Whether a process waits for a delay, or for a sample."""
        return self._run.next_timer() is not None or any(port.can_have_effect for port in self._sampled)

    def next_instant(self) -> int | None:
        """The next instant at which a delay ends, or at which a sample arrives at an end that listens; None after the
        end of time.
        """
        instants = [port.ticks.after(self._run.now) for port in self._sampled if _listens(port)]
        timer = self._run.next_timer()
        found = min([*instants, *([] if timer is None else [timer])], default=END_OF_TIME + 1)
        return found if found <= END_OF_TIME else None

    @property
    def ticks(self) -> Sequence[int]:
        """The present instant, and those up to one round of all periods later at which any port is sampled."""
        now = self._run.now
        last = min(now + lcm(*(port.ticks.period for port in self._sampled)), END_OF_TIME)
        found = {now}
        for port in self._sampled:
            instant = port.ticks.after(now)
            while instant < last and len(found) < MOST_TICKS:
                found.add(instant)
                instant = port.ticks.after(instant)
        return sorted(found)

    @property
    def situation(self) -> tuple[int, ...]:
        """The remaining time of each delay, and the time since all ports were sampled at once: all future instants
        depend on these.
        """
        periods = lcm(*(port.ticks.period for port in self._sampled if _listens(port)))
        return self._run.now % periods, *sorted(instant - self._run.now for instant in self._run.instants_of_timers())

    def meet(self, instant: int) -> None:
        """Advances time to an instant: samples arrive, in the order of the ports, and delays end."""
        self.met += 1
        self._run.now = instant
        for port in self._sampled:
            if port.ticks.at(instant):
                wanted = self._script.next_read(port.name)
                if wanted is not None and wanted.action == "read":
                    self._present[port.name] = wanted.value
                self._lines[port.name.partition(".")[2]].value = self._present[port.name]
                port.sample()
        self._run.timers_fall_due()

    def wait_until(self, instant: int) -> None:
        """Advances time where no process waits for anything but what is offered at this instant."""
        self._run.now = instant

    def pass_until(self, until: int) -> None:
        """Advances time while a process computes."""
        while (instant := self.next_instant()) is not None and instant <= until:
            self.meet(instant)
        self._run.now = until

    @property
    def computing(self) -> Sequence[int]:
        """The instants until which the current task may compute, the most promising first: until a sample is missed if
        one has to be, or no time at all.
        """
        following = self.next_instant()
        if following is None:
            return (self._run.now,)
        missed = [port for port in self._sampled if self._is_to_miss(port)]
        twice = max([port.ticks.after(self._run.now) + port.ticks.period for port in missed], default=self._run.now)
        return tuple(dict.fromkeys((twice, self._run.now, following)))

    def _is_to_miss(self, port: SampledInput[Any]) -> bool:
        wanted = self._script.next_read(port.name)
        return wanted is not None and wanted.action == "miss"


def _listens(port: SampledInput[Any]) -> bool:
    return any(end.listens for end in port.ends)
