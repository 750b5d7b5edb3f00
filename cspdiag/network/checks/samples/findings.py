"""Reports missed samples, each only once, where the reads of parts are joined."""

from __future__ import annotations

from cspdiag.base import Report, Span
from cspdiag.network.checks.samples.first import Late
from cspdiag.network.checks.samples.gaps import NOTHING, Gap, then
from cspdiag.network.checks.samples.reads import MANY, Part, Reads, Session
from cspdiag.network.diagnostics.samples.rates import Extent, SamplesMissed
from cspdiag.network.infer.contexts import Placed
from cspdiag.network.infer.waiting import sample_period
from cspdiag.network.shapes import Key

NEVER = 1 << 63
"""A moment after all others."""


class Findings:
    """The findings in one process."""

    def __init__(self, placed: Placed, report: Report) -> None:
        self.placed = placed
        self.report = report
        self.tolerated = False
        """Whether the parts that are joined now are not reported: a missed sample is caught there, or the parts may not
        be reached.
        """
        self.limit = NEVER
        """The number of nanoseconds after which the parts that are joined now are certainly cut off."""
        self.reported: set[tuple[Key, Span]] = set()

    def add_first(self, late: Late) -> None:
        """Report a sample that every run misses."""
        between = Gap(late.waits, None, late.cause)
        self._report(late.port, between, late.earlier, late.read, 1, is_certain=True, slower=late.slower)

    def check(
        self, session: Session, between: Gap | None, one: Reads, other: Reads, extent: Extent = "two reads"
    ) -> bool:
        """Report a gap in which a sample is certainly overwritten, or may be while an event is waited for."""
        period = sample_period(self.placed, session[0])
        if self.tolerated or between is None or between.cause is None:
            return False
        if between.event is None and between.late < 2 * period:
            return False
        if between.duration + period >= self.limit:
            return False
        is_reported = (session[0], between.cause) in self.reported
        self.reported.add((session[0], between.cause))
        if not is_reported:
            reads = 1 + max(between.credit, 0) // period
            self._report(session[0], between, one.span, other.span, reads, is_certain=True, extent=extent)
        return True

    def check_iterations(self, body: Part, *, is_endless: bool) -> None:
        """Check the gap between the iterations of a loop, and whether each takes as many samples as arrive in it."""
        slowest = max(
            ((found.least * sample_period(self.placed, session[0]), session) for session, found in body.reads.items()),
            default=(0, ("", 0)),
        )
        for session, found in body.reads.items():
            key = session[0]
            if found.before is None or found.after is None:
                continue
            # Between two reads there may also be an iteration without one.
            free = found.past or NOTHING
            between = then(found.after.then(free), found.before)
            is_sum = 0 < free.duration < (between or free).duration
            extent: Extent = "two reads and a turn" if is_sum else "two reads"
            instead = then(found.held, found.before), found.pending
            if self.check(session, between, found, found, extent) or any(
                self.check(session, gap, found, found) for gap in instead
            ):
                # If one input misses samples in an iteration, others may as well: it is one mistake.
                return
            if self.tolerated:
                continue
            taken = found.most * sample_period(self.placed, key)
            if 0 < found.most < MANY and slowest[0] > taken:
                slower = body.reads[slowest[1]].span
                waited = Gap(slowest[0], None, slower, taken)
                extent = "every turn" if found.least == found.most else "every turn, at most"
                self._report_iterations(key, waited, found.span, extent, slower=slowest[1][0], is_endless=is_endless)
                return
            drift, extent = _iteration_with_drift(found)
            if drift is not None and drift.event is None and drift.late >= 0 and drift.cause is not None:
                self._report_iterations(key, drift, found.span, extent, slower=None, is_endless=is_endless)
                return

    def _report_iterations(
        self, key: Key, turn: Gap, read: Span, extent: Extent, *, slower: Key | None, is_endless: bool
    ) -> None:
        assert turn.cause is not None
        period = sample_period(self.placed, key)
        turns = 2 + 2 * period // turn.late if turn.late else 1
        if turns * turn.duration + period < self.limit and (key, turn.cause) not in self.reported:
            self.reported.add((key, turn.cause))
            is_certain = is_endless and extent in ("every turn", "every turn, at most")
            reads = turn.credit // period
            self._report(key, turn, read, read, reads, is_certain=is_certain, slower=slower, extent=extent)

    def _report(
        self,
        key: Key,
        between: Gap,
        earlier: Span,
        read: Span,
        reads: int,
        *,
        is_certain: bool,
        slower: Key | None = None,
        extent: Extent = "two reads",
    ) -> None:
        assert between.cause is not None
        self.report.add(
            SamplesMissed(
                span=between.cause,
                port=key,
                period=sample_period(self.placed, key),
                read=read,
                earlier=earlier,
                event=between.event,
                beside=None if between.event is not None else between.competing_event,
                waits=between.duration,
                slower=slower,
                reads=reads,
                extent=extent,
                is_certain=is_certain,
                is_always=between.on_every_path,
            )
        )


def _iteration_with_drift(found: Reads) -> tuple[Gap | None, Extent]:
    """The iteration that increases the lateness most, possibly together with one that does not read."""
    two = then(found.drift, found.past)
    if found.drift is not None and two is not None and two.rank > found.drift.rank:
        return two, "two turns"
    is_alike = found.drift is not None and found.drift.on_every_path and found.least == found.most
    return found.drift, "every turn" if is_alike else "some turn"
