"""What the kernel does at instants, as tasks that are more urgent than all processes."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import gcd
from typing import TypeAlias

from cspdiag.analyses.timing.refusal import Refusal
from cspdiag.analyses.timing.task import Task, last_in_time
from cspdiag.base.record import record
from cspdiag.network.ir.actions import AfterEvent, WaitStep
from cspdiag.network.ir.expressions import Expression
from cspdiag.network.ir.network import CoreNetwork, ProcessClass
from cspdiag.network.ir.walk import parts

_ADVICE = "remove `kernelTime` from the measured times; what the kernel does at instants then counts as zero"
_MOST_URGENT = -2
"""Above the levels of threads, and above what a thread does beside its own loop."""


Constant: TypeAlias = Callable[[str, Expression], object]
"""The value of an expression in the process of this path, if it is constant, else None."""


@record
class KernelTasks:
    """The work of the kernel at ``ticks`` of ports, steps and polls, and where delays and time-outs end."""

    ticks: tuple[Task, ...] = ()
    ends: tuple[Task, ...] = ()

    @property
    def all(self) -> tuple[Task, ...]:
        """All tasks."""
        return (*self.ticks, *self.ends)


def kernel_tasks(network: CoreNetwork, longest: int, constant: Constant, refusals: list[Refusal]) -> KernelTasks:
    """The work of the kernel, at most ``longest`` nanoseconds at each instant: the ticks of ports; and, if there are
    event inputs, the steps of environments, where events come, and the instants at which devices are polled for them;
    and the ends of delays and time-outs, which at one place are at least as far apart as they last. Other instants are
    refused.
    """
    if not longest:
        return KernelTasks()
    if _has_events(network) and not network.environments:
        port = next(port for port in network.external_ports if port.medium == "event")
        reason = "no environment says how often its events come, so the kernel's time for them is not bounded"
        refusals.append(Refusal(f"{network.top}.{port.name}", reason, port.span, _ADVICE))
    ticks = {
        (port.sampling.period, port.sampling.offset) for port in network.external_ports if port.sampling is not None
    }
    if _has_events(network):
        ticks |= {(environment.step, 0) for environment in network.environments}
        ticks |= {(gcd(*(period for period, _ in ticks)), 0)} if ticks else set()
    periods = [
        period
        for period, offset in sorted(ticks)
        if not any(_is_among((period, offset), other) for other in ticks - {(period, offset)})
    ]
    return KernelTasks(
        tuple(_task(period, longest) for period in periods),
        tuple(_task(period, longest) for period in _durations(network, constant, refusals)),
    )


def _task(period: int, longest: int) -> Task:
    return Task("kernel", period, longest, last_in_time(period), _MOST_URGENT)


def _is_among(ticks: tuple[int, int], others: tuple[int, int]) -> bool:
    """Whether these ticks, given by a period and an offset, are instants of the others."""
    return ticks[0] % others[0] == 0 and (ticks[1] - others[1]) % others[0] == 0


def _has_events(network: CoreNetwork) -> bool:
    return any(port.medium == "event" for port in network.external_ports)


def _durations(network: CoreNetwork, constant: Constant, refusals: list[Refusal]) -> Iterator[int]:
    """The duration of each delay and time-out of the program; those that may be short are refused."""
    for instance in network.instances:
        entry = network.class_named(instance.class_name)
        for part in parts(entry.body) if isinstance(entry, ProcessClass) else ():
            if isinstance(part, WaitStep | AfterEvent):
                duration = constant(instance.path, part.duration)
                if not isinstance(duration, int):
                    reason = "it waits for a time that is not constant, so the kernel's time at its ends is not bounded"
                    refusals.append(Refusal(instance.path, reason, part.span, _ADVICE))
                elif duration > 0:
                    yield duration
