"""The values that a native program reports, on their way to a recording while it runs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from time import monotonic
from typing import TYPE_CHECKING

from cspdiag.model.types import Type
from cspdiag.network.ir.network import CoreNetwork
from cspdiag.simulate.native.rows import PassedRows
from cspdiag.simulate.record.history import History

if TYPE_CHECKING:
    from cspdiag.simulate.record.streamed.recording import Recording

_AT_ONCE = 1 << 21
"""The most bytes of rows that wait to be recorded: with half as many each takes a tenth more time."""
_INTERVAL = 0.25
"""Seconds after which they are recorded, however few they are."""


class RecordedRows:
    """Gives rows to a recording, and to ``kept``, which keeps them if they are needed after the run."""

    def __init__(self, network: CoreNetwork, recording: Recording, kept: PassedRows | None) -> None:
        self._recording = recording
        self._kept = kept
        self._recent = PassedRows(network, keeps_order=False)
        if kept is not None:
            self._recent.channels = kept.channels
        self.channels = self._recent.channels
        self.processes = self._recent.processes if kept is None else kept.processes
        self._size = 0
        self._due = monotonic() + _INTERVAL

    def add(self, data: bytes) -> None:
        """Take whole records."""
        if self._kept is not None:
            self._kept.add(data)
        self._recent.add(data)
        self._size += len(data)
        if self._size >= _AT_ONCE or monotonic() >= self._due:
            self.hand_over()

    def hand_over(self) -> None:
        """Give everything that was taken to the recording. What happened at the last instant waits, as there may be
        more of it.
        """
        recording = self._recording
        last = 0
        for channel, history in self._recent.take_histories().items():
            position = recording.positions.get(channel)
            # Reads of a sampled input are no samples.
            if position is None or (recording.head.ports[position].is_sampled_input and not history.sampled):
                continue
            recording.add(channel, history.time, history.value)  # type: ignore[arg-type]
            last = max(last, int(history.time[-1]))
        recording.pass_time(last)
        self._size = 0
        self._due = monotonic() + _INTERVAL

    @property
    def communications(self) -> Iterator[tuple[int, str, object, str, str]]:
        """See ``Passed.communications``: those that are kept."""
        return iter(()) if self._kept is None else self._kept.communications

    @property
    def samples(self) -> Iterator[tuple[int, str, object]]:
        """See ``Passed.samples``: those that are kept."""
        return iter(()) if self._kept is None else self._kept.samples

    def histories(self, types: Mapping[str, Type]) -> Mapping[str, History]:
        """See ``Passed.histories``: those that are kept."""
        return {} if self._kept is None else self._kept.histories(types)
