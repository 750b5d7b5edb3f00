"""What happened in a steered run since it was last looked at, kept as the rows that the program has sent."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from typing import TYPE_CHECKING, Any

from cspdiag.simulate.native.parties import Parties
from cspdiag.simulate.native.rows import SIZE, Kind, PassedRows, kinds_of
from cspdiag.simulate.run.live import LiveRecorder

if TYPE_CHECKING:
    from cspdiag.network.ir.network import CoreNetwork
    from cspdiag.simulate.record.history import History


class SteeredRecorder(LiveRecorder):
    """Has communications and samples in ``rows``, most of which are only looked at as arrays."""

    def __init__(
        self, network: CoreNetwork, parties: Parties | None = None, found: dict[str, None] | None = None
    ) -> None:
        super().__init__()
        self._network = network
        self.rows = PassedRows(network, keeps_order=True)
        self._before: dict[str, int] = {}
        """The processes that ran when these rows began."""
        self._found = {} if found is None else found
        """Those that are found running while rows are decoded."""
        self._parties = Parties(network, self._found) if parties is None else parties

    @property
    def communications(self) -> Iterator[tuple[int, str, object, str, str]]:
        """See ``Recorder``."""
        return self.last_communications(self.count)

    @property
    def samples(self) -> Iterator[tuple[int, str, object]]:
        """See ``Recorder``."""
        return self.rows.samples

    @property
    def count(self) -> int:
        """See ``LiveRecorder``."""
        return sum(int((kinds_of(data) == Kind.COMMUNICATION).sum()) for data in self.rows.parts)

    def last_communications(self, most: int) -> Iterator[Any]:
        """See ``LiveRecorder``."""
        import numpy

        data = b"".join(self.rows.parts)
        kinds = kinds_of(data)
        communications = numpy.flatnonzero(kinds == Kind.COMMUNICATION)
        shown = communications[max(0, len(communications) - most) :]
        running = numpy.flatnonzero((kinds == Kind.BEGIN) | (kinds == Kind.END))
        self._found.clear()
        self._found.update(dict.fromkeys(self._before))
        positions = numpy.sort(numpy.concatenate([shown, running])) * SIZE
        return self.rows.decoded(data, positions.tolist(), self._parties, self._found)

    def port_histories(self, ports: Collection[str]) -> Mapping[str, History]:
        """See ``LiveRecorder``."""
        # Safe values are written once, at the end.
        return super().port_histories(ports) if self.releases else self.rows.histories({})

    def taken(self) -> SteeredRecorder:
        """See ``LiveRecorder``."""
        found = SteeredRecorder(self._network, self._parties, self._found)
        self.hand_to(found)
        found._before = self._before
        found.rows, self.rows = self.rows, found.rows
        self.rows.channels, self.rows.processes = found.rows.channels, found.rows.processes
        # The program may still name channels, while another thread looks at the rows.
        found.rows.channels = dict(found.rows.channels)
        self._before = dict(self.running)
        return found
