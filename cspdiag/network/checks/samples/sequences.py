"""Sequences of parts of a process, with a check of the gaps between the reads of each input."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from cspdiag.network.checks.samples.findings import Findings
from cspdiag.network.checks.samples.gaps import Elapsed, either, then
from cspdiag.network.checks.samples.reads import (
    INSTANT,
    Part,
    Reads,
    Session,
    earlier,
    joined,
    later,
    one_of_exits,
    part,
)
from cspdiag.network.infer.contexts import Placed
from cspdiag.network.infer.waiting import sample_period
from cspdiag.network.shapes import Key


class Sequences:
    """Joins the parts of one process, and reports what is found between them."""

    def __init__(self, placed: Placed, findings: Findings) -> None:
        self.placed = placed
        self.findings = findings

    def period(self, key: Key) -> int:
        """The sample period of an input in nanoseconds; 0 if it is not known."""
        return sample_period(self.placed, key)

    def sequence(self, parts: Iterable[Part]) -> Part:
        """One part after the other, with a check of the gaps between the reads of each input."""
        elapsed = Elapsed()
        reads: dict[Session, Reads] = {}
        since: dict[Session, int] = {}
        exits: list[Mapping[str, Part]] = []
        for each in parts:
            if each.exits and (first := elapsed.since(0)) is not None:
                so_far = part(first, _until_now(reads, since, elapsed))
                exits.append({name: self._then(so_far, found) for name, found in each.exits.items()})
            for key, other in each.reads.items():
                one = reads.get(key)
                if one is not None:
                    reads[key] = self._joined(key, later(one, elapsed.since(since[key])), other)
                elif (before := elapsed.since(0)) is not None:
                    reads[key] = earlier(other, before)
            elapsed.add(each.time)
            since.update(dict.fromkeys(each.reads, elapsed.position))
            if each.time is None:
                break  # What follows is never reached.
        return part(elapsed.since(0), _until_now(reads, since, elapsed), one_of_exits(exits))

    def _then(self, one: Part, other: Part) -> Part:
        return other if one is INSTANT else self.sequence((one, other))

    def _joined(self, session: Session, one: Reads, other: Reads) -> Reads:
        is_reported = self.findings.check(session, then(one.after, other.before), one, other)
        held = then(one.held, other.before)
        pending = either(one.pending, held if held is not None and held.late >= 2 * self.period(session[0]) else None)
        if one.after is not None:
            is_reported = is_reported or self.findings.check(session, other.pending, one, other)
        else:
            pending = either(pending, other.pending)
        return joined(one, other, None if is_reported else pending)


def _until_now(reads: Mapping[Session, Reads], since: Mapping[Session, int], elapsed: Elapsed) -> dict[Session, Reads]:
    return {key: later(found, elapsed.since(since[key])) for key, found in reads.items()}
