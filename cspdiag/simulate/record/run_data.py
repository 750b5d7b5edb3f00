"""The data of a run, for everything that shows or writes it."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from heapq import merge
from operator import itemgetter
from typing import TYPE_CHECKING, NamedTuple

from cspdiag.model.types import Type
from cspdiag.network.ir.network import CoreNetwork, Environment, ExternalPort
from cspdiag.simulate.record.classes import in_classes
from cspdiag.simulate.record.history import NOTHING, History, Passed
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
        passed: Passed | None = None,
    ) -> None:
        self.network = network
        self.environment = environment
        self.outcome = outcome
        self.chosen_target = ""
        """What a run chose by itself to run on, and why, as it is shown; empty if it did not choose."""
        self._passed = recorder if passed is None else passed
        self.changes: Sequence[tuple[int, str, tuple[int, ...], object]] = recorder.changes
        """The changes of parameters that were made: nanoseconds, parameter, positions of the part, value."""
        self.refused_changes: Sequence[tuple[int, str, str]] = recorder.refused
        """Those that were not: nanoseconds, parameter, why."""
        self.releases: Sequence[tuple[int, str, object]] = recorder.releases
        self.activities: Sequence[Activity] = recorder.activities
        self.execution_times: Mapping[str, ExecutionTime] = recorder.execution_times
        self.variables: Mapping[str, Sequence[tuple[int, float]]] = recorder.variables

    @cached_property
    def communications(self) -> Sequence[Communication]:
        """All communications in order. Values of enums and structs are members of classes with their names."""
        converters = {path: in_classes(kind) for path, kind in self.types.items()}
        found = map(Communication._make, self._passed.communications)
        if not any(converters.values()):
            return list(found)
        return [
            each if (convert := converters.get(each.channel)) is None else each._replace(value=convert(each.value))
            for each in found
        ]

    @cached_property
    def types(self) -> Mapping[str, Type]:
        """Types of the channels by hierarchical name."""
        return {net.path: net.type for net in self.network.nets}

    @cached_property
    def _histories(self) -> Mapping[str, History]:
        external = {f"{self.network.top}.{port.name}": port.type for port in self.network.external_ports}
        found = dict(self._passed.histories({**self.types, **external}))
        for time, channel, value in self.releases:
            if channel in found:
                found[channel] = found[channel].with_safe_value(time, value, external[channel])
        return found

    @cached_property
    def signals(self) -> Mapping[str, Signal]:
        """Signals by name, in the order of the ports and then of the first communication."""
        external = {f"{self.network.top}.{port.name}": port for port in self.network.external_ports}
        signals = {port.name: signal_of(self, port) for port in self.network.external_ports}
        for path, history in self._histories.items():
            if path not in external and path in self.types:
                signals[path] = _signal(history, self.types[path])
        return signals

    def values_passed(self) -> Iterator[tuple[int, str, object]]:
        """Time, channel and value of every communication, and of every safe value that changed an output at the end.

        Of sampled inputs it is every sample, read or not: what was measured, not what the program knows of it.
        """
        last: dict[str, object] = {}
        sampled = {channel for channel, history in self._histories.items() if history.sampled}
        passed = (
            (time, channel, value)
            for time, channel, value, _, _ in self._passed.communications
            if channel not in sampled
        )
        for time, channel, value in merge(self._passed.samples, passed, key=itemgetter(0)):
            last[channel] = value
            yield time, channel, value
        for time, channel, value in self.releases:
            if channel in last and last[channel] != value:
                yield time, channel, value

    def unread(self, name: str) -> Sequence[bool]:
        """For each sample of a sampled input, whether it was left unread."""
        history = self._histories.get(f"{self.network.top}.{name}", NOTHING)
        if not history.sampled:
            return []
        ticks = history.time
        reads = {bisect_right(ticks, time) - 1 for time in history.read}
        return [position not in reads for position in range(len(ticks))]


def histories(run: RunData) -> Mapping[str, History]:
    """What passed each channel of a run, by hierarchical name; see ``RunData.values_passed``."""
    return run._histories


def signal_of(run: RunData, port: ExternalPort) -> Signal:
    """The signal of an external port."""
    return _signal(run._histories.get(f"{run.network.top}.{port.name}", NOTHING), port.type)


def _signal(history: History, type_: Type) -> Signal:
    import numpy

    return Signal(numpy.asarray(history.time).astype(float) / 1e9, history.array(type_), type_)
