"""Finds that nothing can happen in any place any more, although each place sees only itself, in real time.

A place is idle when all its processes wait for others: no timer, driver, or message can make one ready. Once idle, only
a message of another place ends that, or a lost link. An idle place reports how many messages it has sent to each other
one, and how many it has taken over from each. When all places are idle and all of these numbers agree, no message is on
its way: had one been received after the report of its reader, the first such message would have been sent before the
report of its writer, and counted there only. So it is a deadlock, however old the reports are. It has to last for a
while nevertheless, so that a link which is being lost is noticed before.
"""

from __future__ import annotations

import time
from typing import Any, Final, TypeAlias

from cspdiag.simulate.hosts.division import Division
from cspdiag.simulate.hosts.links import LONGEST_SILENCE, Links

_SETTLED: Final = 0.3
"""Seconds for which a place is idle before it reports that."""

Counts: TypeAlias = tuple[dict[str, int], dict[str, int]]
"""The numbers of messages that a place has sent to each other one, and taken over from each."""


class Standstill:
    """What a place knows about it; the first place gets the reports of all others."""

    def __init__(self, division: Division, links: Links) -> None:
        self._division = division
        self._links = links
        self._sent = dict.fromkeys(division.others, 0)
        self._received = dict.fromkeys(division.others, 0)
        self._since: float | None = None
        """Since when this place is idle, in seconds of the clock of the machine."""
        self.instant = 0
        """The instant of the run since which it is."""
        self._agreed: float | None = None
        """Since when all places are known to be idle."""
        self._is_reported = False
        self._reports: dict[str, Counts | None] = dict.fromkeys(division.others)

    def sent(self, place: str) -> None:
        """A message was sent to a place, other than a report."""
        self._sent[place] += 1
        self._begin_again()

    def received(self, place: str) -> None:
        """A message of a place was taken over."""
        self._received[place] += 1
        self._begin_again()

    def disturbed(self) -> None:
        """Something else than a message has happened, or can: a report is no longer true."""
        if self._is_reported:
            self._links.send(self._division.first, ("idle", None))
        self._begin_again()

    def report(self, place: str, counts: Counts | None) -> None:
        """A place has reported that it is idle, or is not."""
        self._reports[place] = counts
        self._agreed = None

    def is_everywhere(self, instant: int) -> bool:
        """Whether nothing can happen any more; this place is idle at an instant of the run, in nanoseconds. Always
        false in places that are not the first.
        """
        now = time.monotonic()
        if self._since is None:
            self._since, self.instant = now, instant
        if now - self._since < _SETTLED:
            return False
        if not self._division.is_first:
            if not self._is_reported:
                self._is_reported = True
                self._links.send(self._division.first, ("idle", (dict(self._sent), dict(self._received))))
            return False
        if not self._all_agree():
            self._agreed = None
            return False
        if self._agreed is None:
            self._agreed = now
        return now - self._agreed >= LONGEST_SILENCE

    def _begin_again(self) -> None:
        self._since = self._agreed = None
        self._is_reported = False

    def _all_agree(self) -> bool:
        counts: dict[str, Any] = {**self._reports, self._division.place: (self._sent, self._received)}
        if any(each is None for each in counts.values()):
            return False
        return all(sent[reader] == counts[reader][1][writer] for writer, (sent, _) in counts.items() for reader in sent)
