"""Chrome trace events: a track for each process, flow arrows for rendezvous, counters for signals.

Format: "Trace Event Format" of the Chromium project; shown by Perfetto and ``chrome://tracing``. Times are
microseconds.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import TYPE_CHECKING

from cspdiag.model.types import BoolType, EnumType, IntType, RealType
from cspdiag.simulate.record.files import readable

if TYPE_CHECKING:
    from cspdiag.simulate.record.run_data import RunData

_MOMENT = 0.5
"""Length in microseconds of the slices that carry the ends of a flow arrow: arrows need slices to start and end in."""


def chrome_trace_text(run: RunData) -> str:
    """The whole trace as one JSON object, with one event on a line."""
    events = ",\n".join(json.dumps(event) for event in _events(run))
    measured = _execution_times(run)
    return f'{{"displayTimeUnit": "ms", {measured}"traceEvents": [\n{events}\n]}}\n'


def _execution_times(run: RunData) -> str:
    """The longest steps that were measured, in seconds, for ``cspdiag verify --wcet-from``; viewers ignore them."""
    if not run.execution_times:
        return ""
    times = {
        path: {"longest": time.longest / 1e9, "steps": time.steps, "what": time.what}
        for path, time in run.execution_times.items()
    }
    return f'"executionTimes": {json.dumps(times)},\n'


def _events(run: RunData) -> Iterator[dict[str, object]]:
    tracks = _tracks(run)
    yield {"ph": "M", "pid": 1, "name": "process_name", "args": {"name": run.network.top}}
    for path, track in tracks.items():
        yield {"ph": "M", "pid": 1, "tid": track, "name": "thread_name", "args": {"name": path}}
        yield {"ph": "M", "pid": 1, "tid": track, "name": "thread_sort_index", "args": {"sort_index": track}}
    for activity in run.activities:
        end = run.outcome.time if activity.end is None else activity.end
        if end > activity.start:
            name = activity.path.rpartition(".")[2]
            yield {
                "ph": "X", "pid": 1, "tid": tracks[activity.path], "name": name, "cat": activity.kind or "group",
                "ts": activity.start / 1e3, "dur": (end - activity.start) / 1e3,
            }  # fmt: skip
    yield from _communication_events(run, tracks)


def _tracks(run: RunData) -> dict[str, int]:
    paths = {activity.path for activity in run.activities}
    for _, _, _, writer, reader in run.communications:
        paths.update((writer, reader))
    paths.discard("")
    return {path: number for number, path in enumerate(sorted(paths), start=1)}


def _communication_events(run: RunData, tracks: dict[str, int]) -> Iterator[dict[str, object]]:
    types = run.types
    external = {f"{run.network.top}.{port.name}" for port in run.network.external_ports}
    for number, (time, channel, value, writer, reader) in enumerate(run.communications, start=1):
        kind = types.get(channel)
        label = channel.rpartition(".")[2]
        shown = readable(value, kind)
        if channel in external and isinstance(kind, BoolType | IntType | RealType | EnumType):
            yield {"ph": "C", "pid": 1, "name": label, "ts": time / 1e3, "args": {"value": float(value)}}  # type: ignore[arg-type]
        for path, direction in ((writer, "!"), (reader, "?")):
            if path in tracks:
                yield {
                    "ph": "X", "pid": 1, "tid": tracks[path], "name": f"{label} {direction} {shown}",
                    "cat": "communication",
                    "ts": time / 1e3, "dur": _MOMENT, "args": {"channel": channel, "value": shown},
                }  # fmt: skip
        if writer in tracks and reader in tracks and writer != reader:
            common = {"pid": 1, "name": label, "cat": "rendezvous", "id": number, "ts": time / 1e3}
            yield {"ph": "s", "tid": tracks[writer], **common}
            yield {"ph": "f", "bp": "e", "tid": tracks[reader], **common}
