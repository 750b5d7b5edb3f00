"""Processes that are certain to miss samples: between two reads of a sampled input they take longer than its period.

From its first read on, and until the process ends, each sample of an input must be taken before the next one arrives.
So a sequential part is summarized by the gaps before, after and between its reads of each input (``reads``). Paths are
those that may be taken: under any conditions, and with events at any time, but only one between two reads. Times are
lower bounds: what is not known (a partner, computation) takes no time, and a loop without reads takes one iteration.
Parallel branches that both read an input have different sessions, and are not compared with each other.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from itertools import chain, repeat
from typing import assert_never

from cspdiag.base import Report, Span
from cspdiag.base.record import replaced
from cspdiag.network.checks.samples.findings import Findings
from cspdiag.network.checks.samples.first import first_late
from cspdiag.network.checks.samples.gaps import NOTHING, Gap
from cspdiag.network.checks.samples.reads import (
    INSTANT,
    MANY,
    NEVER_ENDS,
    Part,
    Reads,
    Session,
    endless,
    free_session,
    in_parallel,
    least_time,
    not_read,
    on_some_path,
    one_of,
    one_of_exits,
    one_read,
    part,
    repeated,
    within,
)
from cspdiag.network.checks.samples.sequences import Sequences
from cspdiag.network.infer.contexts import Placed
from cspdiag.network.infer.possible import decided, possible_branches, variants_by_sample_condition
from cspdiag.network.infer.waiting import inputs_of, is_always_ready, known_duration
from cspdiag.network.ir import actions as ir
from cspdiag.network.relations import end_key
from cspdiag.network.shapes import InstanceShape, Key


class MissedSamples:
    """Finds samples that are certainly missed; the contexts of instances must be processed first."""

    def __init__(self, report: Report) -> None:
        self.report = report
        self._known: dict[Placed, Part] = {}

    def process(self, placed: Placed, *, is_outermost: bool) -> None:
        """Report where a process takes longer between two reads of an input than its samples are apart."""
        body = placed.shape.body
        if body is None or placed.shape.incomplete:
            return
        found = _Process(placed, self._known, self.report)
        self._known[placed] = found.part(body)
        if is_outermost and not found.findings.reported and (late := first_late(placed, body)) is not None:
            found.findings.add_first(late)


class _Process(Sequences):
    """Summarizes the parts of one process."""

    def __init__(self, placed: Placed, known: Mapping[Placed, Part], report: Report) -> None:
        super().__init__(placed, Findings(placed, report))
        self.known = known
        self.ready: frozenset[Key] = frozenset()
        """Events that a guard has found ready, so the next read of them does not wait."""
        self._bodies: dict[tuple[int, frozenset[Key], bool], Part] = {}
        """The bodies of branches, which may be analysed on several paths."""

    def part(self, action: ir.CoreAction) -> Part:
        match action:
            case ir.RunInstance():
                instance = self.placed.shape.instances[action.instance]
                return self._law(instance, action.span) if instance.shape.is_submodel else self._process(action)
            case ir.ReadValue():
                return self._read((end_key(action.source),), action.span)
            case ir.WriteValue() | ir.AssignValue() | ir.SkipStep() | ir.ResetInstance():
                return INSTANT
            case ir.WaitStep():
                waits = known_duration(self.placed, action.duration)
                return part(Gap(waits, None, action.span)) if waits else INSTANT
            case ir.StopStep():
                return NEVER_ENDS
            case ir.RaiseException():
                return part(None, exits={action.exception: INSTANT})
            case ir.SequentialSteps():
                return self.sequence(map(self.part, action.steps))
            case ir.ParallelSteps():
                return in_parallel(map(self._optional_part, action.steps))
            case ir.Choice():
                return self._choice(action)
            case ir.Repeat():
                body = self._optional_part(action.body)
                ends = action.until is not None and decided(self.placed, action.until)
                if ends:
                    return body
                self.findings.check_iterations(body, is_endless=action.until is None)
                return endless(body) if action.until is None else repeated(body)
            case ir.WhileLoop():
                if decided(self.placed, action.condition) is False:
                    return INSTANT
                body = self._optional_part(action.body)
                self.findings.check_iterations(body, is_endless=False)
                return one_of([INSTANT, repeated(body)])
            case ir.CountedLoop():
                return self._counted_loop(action)
            case ir.IfElse():
                holds = decided(self.placed, action.condition)
                paths = [action.then] * (holds is not False) + [action.otherwise] * (holds is not True)
                return one_of([self._optional_part(path) for path in paths])
            case ir.CatchException():
                return self._catch(action)
            case ir.InterruptOn():
                return self._interrupt(action)
            case ir.Group():
                return self.part(action.body)
            case _:
                assert_never(action)

    def _counted_loop(self, loop: ir.CountedLoop[ir.CoreAction]) -> Part:
        """An event that was ready before the first iteration may be read in it; all other iterations begin alike."""
        first = self.part(loop.body)
        return self.sequence(chain((first,), repeat(self.part(loop.body), loop.iterations - 1)))

    def _optional_part(self, action: ir.CoreAction) -> Part:
        """A part that is not on every path: an event that was ready before it may still be ready afterwards."""
        was_ready = self.ready
        found = self.part(action)
        self.ready = was_ready
        return found

    def _law(self, instance: InstanceShape, span: Span) -> Part:
        return self._read([key for key in inputs_of(instance) if key is not None], span)

    def _read(self, keys: Iterable[Key], span: Span) -> Part:
        """Reads that begin immediately: a sample is taken when it is there, and then the events are waited for."""
        keys = list(keys)
        event = next((key for key in keys if self._is_event(key)), None)
        time = NOTHING if event is None else Gap(0, event, span)
        self.ready -= set(keys)
        return part(time, {(key, 0): one_read(self.period(key), time, span) for key in keys if self.period(key)})

    def _process(self, action: ir.RunInstance) -> Part:
        """A process has sessions of its own; here it only takes time, and may wait for events."""
        inside = self.known.get(self.placed.inside[action.instance])
        if inside is None:
            return INSTANT
        exits = {name: part(_caused(found.time, action.span)) for name, found in inside.exits.items()}
        return part(_caused(inside.time, action.span), exits=exits)

    def _is_event(self, key: Key) -> bool:
        return self.placed.facts[key][0] == "event" and key not in self.ready

    def _choice(self, action: ir.Choice[ir.CoreAction]) -> Part:
        """One of the possible branches, with and without the conditions of samples."""
        return one_of([self._chosen(path) for path in variants_by_sample_condition(self.placed, action)])

    def _chosen(self, action: ir.Choice[ir.CoreAction]) -> Part:
        """One of the branches, after what is waited for before it can be chosen."""
        branches = possible_branches(self.placed, action)
        events = [branch for branch in branches if self._event_of(branch) is not None]
        time_outs = [branch for branch in branches if isinstance(branch.event, ir.AfterEvent)]
        if branches and len(events) == len(branches):
            waits = Gap(0, self._event_of(events[0]), events[0].event.span)
            return self.sequence((part(waits), one_of([self._branch(branch, NOTHING, {}) for branch in branches])))
        # The moment until which an event may occur: then a sample or a time-out is chosen.
        until = NOTHING
        if len(events) + len(time_outs) == len(branches):
            until = min(filter(None, map(self._time_out, time_outs)), key=lambda gap: gap.duration, default=NOTHING)
        samples = self._samples(branches)
        is_waiting = not any(is_always_ready(self.placed, branch.event) for branch in branches)
        is_certain = (is_waiting or not (samples or events)) and not (time_outs and samples)
        was_tolerated = self.findings.tolerated
        self.findings.tolerated = was_tolerated or not is_certain
        parts = []
        for place, branch in enumerate(branches):
            instead = {}
            for key, sample in samples.items():
                is_first = action.prioritized and place < sample
                is_last = action.prioritized and not is_first
                instead[key, 0] = self._instead_of(key, branch, waits=is_waiting, is_first=is_first, is_last=is_last)
            parts.append(self._branch(branch, until.maybe_shorter if branch in events else NOTHING, instead))
        self.findings.tolerated = was_tolerated
        chosen = one_of(parts)
        if is_certain:
            return chosen
        # Whether a sample arrives before a time-out, or is already there, depends on the lateness, of which only a
        # bound is known.
        reads = {session: on_some_path(session, parts, found.span) for session, found in chosen.reads.items()}
        return part(least_time(parts), reads, chosen.exits)

    def _event_of(self, branch: ir.Branch[ir.CoreAction]) -> Key | None:
        """The event that a guard waits for."""
        if not isinstance(branch.event, ir.InputEvent | ir.ReadyEvent):
            return None
        key = end_key(branch.event.source)
        return key if self._is_event(key) else None

    def _samples(self, branches: Iterable[ir.Branch[ir.CoreAction]]) -> dict[Key, int]:
        """The sampled inputs that guards wait for, with the positions of these guards."""
        guarded = {
            end_key(branch.event.source): place
            for place, branch in enumerate(branches)
            if isinstance(branch.event, ir.InputEvent | ir.ReadyEvent)
        }
        return {key: place for key, place in guarded.items() if self.period(key)}

    def _time_out(self, branch: ir.Branch[ir.CoreAction]) -> Gap | None:
        assert isinstance(branch.event, ir.AfterEvent)
        waits = known_duration(self.placed, branch.event.duration)
        return Gap(waits, None, branch.event.span) if waits else None

    def _branch(
        self, branch: ir.Branch[ir.CoreAction], until: Gap, instead: Mapping[Session, Reads], parallel: Part = INSTANT
    ) -> Part:
        """What follows when a branch is chosen, at the latest at the moment ``until``, and ``instead`` of samples.

        Its guard waits in parallel with the part ``parallel``, with a session of its own.
        """
        event = branch.event
        if isinstance(event, ir.InputEvent | ir.ReadyEvent):
            key = end_key(event.source)
            was_ready = self.ready
            self.ready = was_ready | {key} if isinstance(event, ir.ReadyEvent) else was_ready - {key}
            following = self._following(branch)
            self.ready = was_ready
            if self.period(key):
                session = free_session(key, parallel)
                taken = part(NOTHING, {session: one_read(self.period(key), NOTHING, event.span)})
                return following if isinstance(event, ir.ReadyEvent) else self.sequence((taken, following))
        else:
            following = self._following(branch)
        time = self._time_out(branch) or NOTHING if isinstance(event, ir.AfterEvent) else until
        return self.sequence((part(time, instead), following))

    def _following(self, branch: ir.Branch[ir.CoreAction]) -> Part:
        place = id(branch.body), self.ready, self.findings.tolerated
        if place not in self._bodies:
            self._bodies[place] = self._optional_part(branch.body)
        return self._bodies[place]

    def _instead_of(
        self, sample: Key, chosen: ir.Branch[ir.CoreAction], *, waits: bool, is_first: bool, is_last: bool
    ) -> Reads:
        """The reads of a sample if something else is chosen: an event may occur at any time, up to the next sample.

        One that ``is_first`` is chosen even if the sample is already there, one that ``is_last`` only before.
        """
        event = self._event_of(chosen) if waits else None
        span = chosen.event.span
        held = NOTHING if event is None else Gap(0, None, span, -self.period(sample) + is_last, event)
        return not_read(held, NOTHING if is_first else None, span)

    def _interrupt(self, action: ir.InterruptOn[ir.CoreAction]) -> Part:
        branch = action.branch
        holds = decided(self.placed, branch.condition)
        if holds is False:
            return self._optional_part(action.body)
        if holds and is_always_ready(self.placed, branch.event):
            return self._replaced_immediately(action)
        is_time_out = isinstance(branch.event, ir.AfterEvent)
        longest = self._longest(branch) if holds else 0
        was_limit = self.findings.limit
        self.findings.limit = min(was_limit, longest) if longest else was_limit
        body = self._optional_part(action.body)
        self.findings.limit = was_limit
        handler = self._following(branch) if is_time_out else self._branch(branch, NOTHING, {}, parallel=body)
        if body.time is NOTHING and not body.reads:
            return body
        event = self._event_of(branch)
        if event is not None:
            return one_of([body, self.sequence((self._abandoned(body, event, branch.event.span), handler))])
        limit = (self._time_out(branch) if is_time_out else None) or NOTHING
        may_end = not is_time_out or limit is NOTHING or body.time is None or body.time.event is not None
        if not may_end and body.time is not None and body.time.duration < limit.duration:
            return body
        left = self.sequence((self._cut_off(body, limit), handler))
        if not is_time_out and longest and body.time is not None and body.time.event is None:
            may_end = body.time.duration < longest
        if not may_end:
            return replaced(left, exits=one_of_exits((body.exits, left.exits)))
        return one_of([within(body, limit) if is_time_out else body, left])

    def _replaced_immediately(self, action: ir.InterruptOn[ir.CoreAction]) -> Part:
        """The handler after a body that is cancelled before it reads or waits; only an exception can end the body
        earlier.
        """
        was_tolerated = self.findings.tolerated
        self.findings.tolerated = True
        body = self._optional_part(action.body)
        self.findings.tolerated = was_tolerated
        following = self._following(action.branch)
        return replaced(following, exits=one_of_exits((body.exits, following.exits)))

    def _longest(self, branch: ir.Branch[ir.CoreAction]) -> int:
        """The number of nanoseconds after which a guard certainly occurs, for a time-out or a sample; 0 if it is not
        known.
        """
        if isinstance(branch.event, ir.AfterEvent):
            return known_duration(self.placed, branch.event.duration)
        return (
            self.period(end_key(branch.event.source)) if isinstance(branch.event, ir.InputEvent | ir.ReadyEvent) else 0
        )

    def _abandoned(self, body: Part, event: Key, span: Span) -> Part:
        """A body that an event ends, at any time up to the next sample that the body waits for."""
        time = Gap(0, event, span) if body.time is None else body.time.maybe_shorter
        reads = {}
        for session, found in body.reads.items():
            held = Gap(0, None, span, -self.period(session[0]), event)
            again = found.most > 1 and found.before is not None
            past = NOTHING if body.time is None or found.before is not None else body.time.maybe_shorter
            reads[session] = replaced(
                found, past=past, after=held if again else None, least=0, drift=None, held=held, pending=None
            )
        return part(time, reads)

    def _cut_off(self, body: Part, limit: Gap) -> Part:
        """A body that is left somewhere, after at most ``limit``: nothing is certain after its reads."""
        is_longer = body.time is None or body.time.rank >= limit.rank
        reads = {}
        for session, found in body.reads.items():
            is_read = found.before is not None and found.before.rank <= limit.rank
            waits = found.past is None and is_read
            reads[session] = replaced(
                found,
                before=found.before if is_read else None,
                past=None if waits and limit is not NOTHING else limit if is_longer else found.past,
                after=NOTHING if is_read or found.after is not None else None,
                least=0,
                drift=None,
                held=limit if waits and limit.duration < self.period(session[0]) else None,
                pending=None,
            )
        return part(limit if is_longer else body.time, reads)

    def _catch(self, action: ir.CatchException[ir.CoreAction]) -> Part:
        was_tolerated = self.findings.tolerated
        self.findings.tolerated = was_tolerated or action.exception == "Timeout"
        body = self._optional_part(action.body)
        self.findings.tolerated = was_tolerated
        handler = self._optional_part(action.handler)
        if action.exception == "Timeout":
            caught = {
                key: replaced(found, before=None, most=MANY, drift=None, pending=None)
                for key, found in body.reads.items()
            }
            body = replaced(body, reads=caught)
            return one_of([body, self.sequence((self._cut_off(body, NOTHING), handler))])
        raised = body.exits.get(action.exception)
        others = {name: found for name, found in body.exits.items() if name != action.exception}
        body = replaced(body, exits=others)
        return body if raised is None else one_of([body, self.sequence((raised, handler))])


def _caused(time: Gap | None, span: Span) -> Gap | None:
    return time if time is None or time is NOTHING else replaced(time, cause=span)
