"""Frames: what happened in a live run since the last one."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

from cspdiag.network.ir.network import CoreNetwork
from cspdiag.simulate.record.held import Column, columns_of
from cspdiag.simulate.record.modes import mode_groups
from cspdiag.studio.engine.data import Data
from cspdiag.studio.engine.values import shown_values, value_data

if TYPE_CHECKING:
    from cspdiag.model.types import Type
    from cspdiag.simulate.run.live import LiveRecorder, LiveRun
    from cspdiag.simulate.steered.run import SteeredRun

MOST_COMMUNICATIONS = 200
"""The last of them are shown."""
MOST_WAITING = 200


class Frames:
    """Makes the frames of a run, and says what is in them."""

    def __init__(self, run: LiveRun | SteeredRun) -> None:
        self._run = run
        network = run.network
        self._columns = columns(network)
        self._ports = {f"{network.top}.{port.name}" for port in network.external_ports}
        self._types: dict[str, Type] = {net.path: net.type for net in network.nets}
        self._types |= {f"{network.top}.{port.name}": port.type for port in network.external_ports}
        self.groups = mode_groups(network)
        self._modes = {path: (group.name, mode) for group in self.groups for path, mode in group.modes.items()}
        self._entered: set[str] = set()
        self._last = 0

    def next(self, *, with_waiting: bool = True) -> Callable[[], Data]:
        """What happened since the last frame; the run forgets it. The result makes the frame, in any thread."""
        recorder = self._run.recorder.taken()
        now = max(self._last, self._run.now)
        about = {
            "from": self._last,
            "to": now,
            "waiting": waiting(self._run) if with_waiting else [],
            "missed": self._run.missed,
            "modes": self._mode_changes(recorder.begun, recorder.ended),
        }
        self._last = now
        return lambda: {**about, **self._happened(recorder)}

    def _happened(self, recorder: LiveRecorder) -> Data:
        return {
            "signals": self._signals(recorder),
            "communications": self._communications(recorder),
            "omitted": max(0, recorder.count - MOST_COMMUNICATIONS),
            "started": [path for _, path in recorder.begun],
            "ended": [path for _, path in recorder.ended],
            "running": list(recorder.running),
            "changes": [
                {"t": time, "parameter": name, "path": list(path), "value": value_data(value, None)}
                for time, name, path, value in recorder.changes
            ],
            "refused": [{"t": time, "parameter": name, "text": why} for time, name, why in recorder.refused],
        }

    def _signals(self, recorder: LiveRecorder) -> dict[str, Data]:
        found = recorder.port_histories(self._ports)
        return {
            column.name: {
                "t": found[column.channel].time.tolist(),
                "v": shown_values(
                    found[column.channel].leaf(column.path, 0, len(found[column.channel].time)), column.type
                ),
            }
            for column in self._columns
            if column.channel in found
        }

    def _communications(self, recorder: LiveRecorder) -> list[Data]:
        return [
            {"t": time, "channel": channel, "writer": writer or None, "reader": reader or None,
             "value": value_data(value, self._types.get(channel))}
            for time, channel, value, writer, reader in recorder.last_communications(MOST_COMMUNICATIONS)
        ]  # fmt: skip

    def _mode_changes(self, begun: Iterable[tuple[int, str]], ended: Iterable[tuple[int, str]]) -> list[Data]:
        """Which modes were entered and left when; of a process that has ended the mode is null."""
        times: dict[str, tuple[deque[int], deque[int]]] = {}
        for which, happened in enumerate((begun, ended)):
            for time, path in happened:
                if path in self._modes:
                    times.setdefault(path, (deque(), deque()))[which].append(time)
        changes: list[Data] = []
        for path, (entered, left) in times.items():
            group, mode = self._modes[path]
            while left if path in self._entered else entered:
                begins = path not in self._entered
                time = (entered if begins else left).popleft()
                changes.append({"t": time, "group": group, "path": path, "mode": mode if begins else None})
                self._entered ^= {path}
        return sorted(changes, key=lambda change: int(change["t"]))


def columns(network: CoreNetwork) -> list[Column[Any]]:
    """The numbers of the external ports, in the order of the text."""
    return [
        column
        for port in network.external_ports
        for column in columns_of(f"{network.top}.{port.name}", port.name, port.type, lambda values, _: values)
    ]


def waiting(run: LiveRun | SteeredRun) -> list[Data]:
    """Which process waits for what, in text order."""
    return [
        {"process": path, "channels": list(channels), "for": words, "place": place}
        for path, words, channels, place in run.waiting(MOST_WAITING)
    ]
