"""The data of a run, for everything that shows or writes it."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from heapq import merge
from operator import itemgetter
from typing import TYPE_CHECKING, NamedTuple

from cspdiag.model.types import Type
from cspdiag.network.ir.network import CoreNetwork, Environment
from cspdiag.simulate.record.leaves import column
from cspdiag.simulate.record.recorder import Activity, Communication, ExecutionTime, Recorder

if TYPE_CHECKING:
    import numpy

    from cspdiag.runtime import Outcome


class Signal(NamedTuple):
    """The values at a port: instants in seconds (shape ``(n,)``), values, and the type of the port.

    Values have shape ``(n,)``, those of arrays ``(n, size)``; structs are numpy structures with the same fields
    (``value["x"]``).
    """

    time: numpy.ndarray
    value: numpy.ndarray
    type: Type


class RunData:
    """Why a run ended, what was communicated and when, which process ran when.

    ``signals`` has the external ports under their names and the internal channels under their hierarchical names
    (``Jiwy.horizontal.status``).
    """

    def __init__(
        self,
        network: CoreNetwork,
        environment: Environment | None,
        outcome: Outcome,
        recorder: Recorder,
    ) -> None:
        self.network = network
        self.environment = environment
        self.outcome = outcome
        self._recorder = recorder
        self.releases: Sequence[tuple[int, str, object]] = recorder.releases
        self.activities: Sequence[Activity] = recorder.activities
        self.execution_times: Mapping[str, ExecutionTime] = recorder.execution_times
        self.variables: Mapping[str, Sequence[tuple[int, float]]] = recorder.variables

    @cached_property
    def communications(self) -> Sequence[Communication]:
        """All communications in order."""
        return [Communication._make(passed) for passed in self._recorder.communications]

    @cached_property
    def types(self) -> Mapping[str, Type]:
        """Types of the channels by hierarchical name."""
        return {net.path: net.type for net in self.network.nets}

    @cached_property
    def signals(self) -> Mapping[str, Signal]:
        """Signals by name, in the order of the ports and then of the first communication."""
        import numpy

        prefix = f"{self.network.top}."
        external = {f"{prefix}{port.name}": port for port in self.network.external_ports}
        found: dict[str, tuple[list[int], list[object]]] = {path: ([], []) for path in external}
        for time, channel, value in self.values_passed():
            times, values = found.setdefault(channel, ([], []))
            times.append(time)
            values.append(value)
        signals = {}
        for path, (times, values) in found.items():
            kind = external[path].type if path in external else self.types.get(path)
            if kind is None:
                continue
            name = path.removeprefix(prefix) if path in external else path
            signals[name] = Signal(numpy.array(times, dtype=float) * 1e-9, column(values, kind), kind)
        return signals

    def values_passed(self) -> Iterator[tuple[int, str, object]]:
        """Time, channel and value of every communication, and of every safe value that changed an output at the end.

        Of sampled inputs it is every sample, read or not: what was measured, not what the program knows of it.
        """
        last: dict[str, object] = {}
        log = self._recorder.sample_log
        sampled = set(log[1::3])
        passed = (
            (time, channel, value)
            for time, channel, value, _, _ in self._recorder.communications
            if channel not in sampled
        )
        for time, channel, value in merge(self._recorder.samples, passed, key=itemgetter(0)) if log else passed:
            last[channel] = value
            yield time, channel, value
        for time, channel, value in self.releases:
            if channel in last and last[channel] != value:
                yield time, channel, value

    def unread(self, name: str) -> Sequence[bool]:
        """For each sample of a sampled input, whether it was left unread."""
        path = f"{self.network.top}.{name}"
        ticks = [time for time, port, _ in self._recorder.samples if port == path]
        reads = {
            bisect_right(ticks, time) - 1 for time, channel, *_ in self._recorder.communications if channel == path
        }
        return [position not in reads for position in range(len(ticks))]
