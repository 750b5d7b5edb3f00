"""The jobs of a thread: what it does after each wait at which it may arrive, with the samples that it follows there.

All paths are searched from the beginning of the thread. A thread that follows samples of a period may only wait where
the next of them ends the wait, for a known time, or for partners; and before it waits for the next sample it has to
take the present one at each end that it follows. Any other wait is a ``Gap``, about which nothing is proved.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator

from cspdiag.analyses.timing.flow.followed import (
    NOTHING_FOLLOWED,
    FollowedEnds,
    SampleStatus,
    after_step,
    after_tick,
    is_due,
    is_surely_followed,
    may_be_first_read,
    periods,
    with_possible,
    with_status,
)
from cspdiag.analyses.timing.flow.paths import Job, Path, WaitState, merge_branches
from cspdiag.analyses.timing.threads.graph import Offer, Place, Thread
from cspdiag.analyses.timing.threads.termination import LARGEST_NUMBER_OF_ITERATIONS
from cspdiag.base import Span
from cspdiag.base.graphs import reached, strong_components
from cspdiag.base.record import record

State = tuple[int, FollowedEnds]
Step = tuple[State, int, bool, Offer | None, bool]
"""A step without a stop: the next state, the delay before it, whether other threads may run in between, the
communication, and whether that is waited for.
"""

LARGEST_NUMBER_OF_WAIT_STATES = 2_000


class UnboundedError(Exception):
    """The work between two waits has no bound; ``span`` is the place of the loop."""

    def __init__(self, reason: str, span: Span) -> None:
        super().__init__(reason)
        self.reason = reason
        self.span = span


@record
class Gap:
    """A place where a thread waits and may miss samples of the inputs in ``followed``, which are given with their
    periods.

    With ``untaken`` it may be the sample of the last tick that has not been taken yet.
    """

    place: int
    followed: tuple[tuple[str, int], ...]
    untaken: bool = False


class JobSearch:
    """Searches for the jobs of one thread. With ``meets`` a job includes the rendezvous that it waits for."""

    def __init__(self, thread: Thread, *, meets: bool = True) -> None:
        self.thread = thread
        self.meets = meets
        self._is_beginning = False
        """Whether the program has only just begun."""
        self.ends = False
        """Whether the thread may end, or reach a ``stop``, without an exception."""
        self.gaps: list[Gap] = []

    def find(self) -> list[Job]:
        """The job from the beginning of the thread, and one for each offer of each wait at which it may arrive."""
        self._is_beginning = self.thread.begins_at_once
        begins = self._path(self.thread.entry, 0, NOTHING_FOLLOWED)
        self._is_beginning = False
        found: dict[tuple[int, int], list[tuple[Offer, Path, bool]]] = {}
        seen: set[WaitState] = set(begins.wait_states)
        pending = list(begins.wait_states)
        while pending:
            number, followed = pending.pop()
            for which, offer in enumerate(self.thread.places[number].offers):
                path = self._path_after(number, offer, followed)
                found.setdefault((number, which), []).append((offer, path, bool(followed)))
                new = path.wait_states - seen
                seen |= new
                pending += new
                if len(seen) > LARGEST_NUMBER_OF_WAIT_STATES:
                    place = self.thread.places[number]
                    raise UnboundedError("it waits in too many different situations to look at", place.span)
        self.gaps = list(dict.fromkeys(self.gaps))
        return [Job(-1, None, begins)] + [
            Job(
                number,
                visits[0][0],
                _merge_visits([path for _, path, _ in visits]),
                any(follows for _, _, follows in visits),
            )
            for (number, _), visits in sorted(found.items())
        ]

    def _path_after(self, number: int, offer: Offer, followed: FollowedEnds) -> Path:
        """The path after an offer has ended a wait."""
        period = 0
        if offer.kind == "sample":
            period = offer.period
            followed = after_tick(followed, period)
            if offer.takes:
                followed = with_status(followed, [offer], SampleStatus.TAKEN)
        place, target = self.thread.places[number], self.thread.places[offer.target]
        return self._path(offer.target, period, after_step(with_possible(followed, offer.may_follow), place, target))

    def reachable(self, starts: Iterable[int], period: int, avoided: Collection[int]) -> set[int]:
        """The places that a job can reach from ``starts`` without passing any of ``avoided``; all samples are there."""
        offers = [offer for place in self.thread.places for offer in place.offers if offer.kind == "sample"]
        followed = after_tick(with_status(NOTHING_FOLLOWED, offers, SampleStatus.TAKEN), period)
        begin = [(start, followed) for start in starts if start not in avoided]

        def after(state: State) -> list[State]:
            return [following for following in self._successors(state, period) if following[0] not in avoided]

        return {number for number, _ in reached(begin, after)}

    def stops_without(self, offer: Offer, begins: Iterable[int], avoided: int) -> set[int]:
        """The waits at which a job of a sample may end, from ``begins`` on, without passing ``avoided``; all other
        samples of its period are there.
        """
        offers = [other for place in self.thread.places for other in place.offers if other.kind == "sample"]
        followed = after_tick(with_status(NOTHING_FOLLOWED, offers, SampleStatus.TAKEN), offer.period)
        if offer.takes:
            followed = with_status(followed, [offer], SampleStatus.TAKEN)
        begin = [(start, followed) for start in begins if start != avoided]

        def after(state: State) -> list[State]:
            return [following for following in self._successors(state, offer.period) if following[0] != avoided]

        return {state[0] for state in reached(begin, after) if self._may_stop(state, offer.period)}

    def _path(self, start: int, period: int, followed: FollowedEnds) -> Path:
        done: dict[State, Path] = {}
        entered: set[State] = set()
        pending: list[tuple[State, bool]] = [((start, followed), False)]
        while pending:
            state, is_left = pending.pop()
            if is_left:
                entered.discard(state)
                done[state] = self._combined(state, period, done)
                continue
            if state in done or state in entered:
                continue
            entered.add(state)
            pending.append((state, True))
            for following, _, _, _, _ in self._steps(state, period):
                if following in entered:
                    self._check_loop(following, period)
                elif following not in done:
                    pending.append((following, False))
        return done[start, followed]

    def _check_loop(self, back: State, period: int) -> None:
        """Check a loop without a wait: if it computes or lets time pass, the number of its iterations must be known."""
        inside = set(reached([back], lambda state: self._successors(state, period)))
        numbers = {state for state in inside if self._returns_to(state, back, period)}
        around = [(self.thread.places[number], followed) for number, followed in numbers]
        iterations = self._iterations({number for number, _ in numbers})
        for place, followed in around:
            if self._may_delay(place, followed):
                reason = (
                    "it may repeat a loop that waits here for time to pass, without a sample in between, an unknown "
                    "number of times"
                )
                raise UnboundedError(_too_many(iterations) if iterations else reason, place.span)
        if any(place.cost or place.offers for place, _ in around):
            place = self.thread.places[back[0]]
            reason = "how often this repeats before it waits for a sample or an event cannot be seen"
            raise UnboundedError(_too_many(iterations) if iterations else reason, place.span)

    def _iterations(self, inside: set[int]) -> int | None:
        """The number of iterations of the innermost loop around some places, if it is known."""
        around = [loop for loop in self.thread.loops if loop.header <= min(inside) and max(inside) < loop.end]
        return min(around, key=lambda loop: loop.end - loop.header).iterations if around else None

    def _returns_to(self, state: State, goal: State, period: int) -> bool:
        return goal in reached(self._successors(state, period), lambda here: self._successors(here, period))

    def _successors(self, state: State, period: int) -> list[State]:
        return [following for following, *_ in self._steps(state, period)]

    def _steps(self, state: State, period: int) -> Iterator[Step]:
        """The steps from a state that do not end the job."""
        number, followed = state
        place = self.thread.places[number]
        if not place.offers:
            followed = with_possible(followed, place.may_follow)
            for target in place.successors:
                yield (target, after_step(followed, place, self.thread.places[target])), 0, place.breaks, None, False
        elif place.polls:
            yield from self._without_waiting(place, followed, period)
            for target in place.successors:
                yield (target, after_step(followed, place, self.thread.places[target])), 0, False, None, False
        elif any(self._may_be_ready(offer, followed, period) for offer in place.offers):
            yield from self._without_waiting(place, followed, period)
        elif self._may_delay(place, followed):
            longest = place.longest_delay() or 0
            for offer in place.offers:
                yield self._after(place, offer, followed), longest, True, _partner_offer(offer), False
        elif self.meets and not place.is_idle:
            for offer in place.offers:
                yield self._after(place, offer, followed), 0, True, offer, True

    def _may_stop(self, state: State, period: int) -> bool:
        """Whether the job may end here, in a wait that is not part of it."""
        number, followed = state
        place = self.thread.places[number]
        if not place.offers or place.polls or self._may_delay(place, followed):
            return False
        if any(offer.is_certain and self._is_surely_ready(offer, followed, period) for offer in place.offers):
            return False
        return place.is_idle or not self.meets

    def _may_delay(self, place: Place, followed: FollowedEnds) -> bool:
        """Whether a thread that follows samples waits here for none of them, and for less time than lies between two of
        them.
        """
        longest = place.longest_delay()
        return bool(followed) and longest is not None and not place.periods() and longest < min(periods(followed))

    def _without_waiting(self, place: Place, followed: FollowedEnds, period: int) -> Iterator[Step]:
        """The steps with offers that may be ready when the thread arrives at a wait."""
        for offer in place.offers:
            if offer.kind == "sample" and not self._may_be_ready(offer, followed, period) and not place.polls:
                continue
            if offer.kind == "sample" and (offer.key, period, SampleStatus.TAKEN) in followed:
                continue
            yield self._after(place, offer, followed), 0, False, _partner_offer(offer), False

    def _may_be_ready(self, offer: Offer, followed: FollowedEnds, period: int) -> bool:
        """Whether a sample that is offered may already be there."""
        if offer.kind != "sample":
            return False
        # Another branch of the process may already follow the period.
        is_shared = (
            bool(self.thread.shared) and not self._is_beginning and (offer.key[1], offer.period) in self.thread.shared
        )
        return (
            is_due(followed, offer)
            or may_be_first_read(followed, offer)
            or (is_shared and not is_surely_followed(followed, offer))
        )

    def _is_surely_ready(self, offer: Offer, followed: FollowedEnds, period: int) -> bool:
        """Whether a sample that is offered is there for certain."""
        if offer.kind != "sample":
            return False
        # A job that a sample began belongs to its tick: a process that follows the period has had a first sample.
        return is_due(followed, offer) or (offer.period == period and may_be_first_read(followed, offer, surely=True))

    def _after(self, place: Place, offer: Offer, followed: FollowedEnds) -> State:
        if offer.kind == "sample" and offer.takes:
            followed = with_status(followed, [offer], SampleStatus.TAKEN)
        elif offer.kind == "sample" and not is_due(followed, offer):
            followed = with_status(followed, [offer], SampleStatus.DUE)
        return offer.target, after_step(
            with_possible(followed, offer.may_follow), place, self.thread.places[offer.target]
        )

    def _combined(self, state: State, period: int, done: dict[State, Path]) -> Path:
        number, followed = state
        place = self.thread.places[number]
        steps = list(self._steps(state, period))
        # A step back to an entered state is a loop without work, which adds nothing.
        known = [(done[step[0]], *step[1:]) for step in steps if step[0] in done]
        path = merge_branches(iter(known))
        path.is_unique &= len(known) == len(steps)
        if self._may_stop(state, period):
            path.is_unique &= not steps
            path.certain_outputs = frozenset()
            path.certain_moves = frozenset()
            path.wait_states |= {(number, self._followed_while_waiting(number, followed))}
            path.still_followed |= periods(followed)
        elif not steps:
            self._note_end(number, followed)
        self._add(path, number, place)
        return path

    def _add(self, path: Path, number: int, place: Place) -> None:
        """Add what a place itself does."""
        for net in place.sends:
            path.sends[net, True] = path.sends.get((net, True), 0) + 1
        path.work += place.cost
        path.least_work += place.cost
        path.first_step += place.cost
        path.outputs |= set(place.outputs)
        path.certain_outputs |= set(place.certain_outputs)
        if place.move is not None:
            path.moves |= {number}
            path.certain_moves |= {number} if place.is_certain_to_move else frozenset()
        if place.leaf:
            path.leaves |= {place.leaf}
        if place.leaf and place.cost >= path.heaviest[0]:
            path.heaviest = (place.cost, place.leaf)

    def _followed_while_waiting(self, number: int, followed: FollowedEnds) -> FollowedEnds:
        """The ends that are followed during a wait, with those for which it waits; notes the samples that are not
        taken.
        """
        place = self.thread.places[number]
        untaken = [
            (key[0], period)
            for key, period, status in followed
            if status == SampleStatus.DUE
            and not any(offer.key == key and offer.is_certain for offer in place.offers if offer.kind == "sample")
        ]
        followed = with_status(followed, place.offers, SampleStatus.TAKEN)
        while_waiting = frozenset(
            (key, period, SampleStatus.TAKEN if status == SampleStatus.DUE else status)
            for key, period, status in followed
        )
        unseen = periods(while_waiting) - place.certain_periods()
        if unseen:
            missable = sorted((key[0], period) for key, period, _ in while_waiting if period in unseen)
            self.gaps.append(Gap(number, tuple(missable)))
        if untaken:
            self.gaps.append(Gap(number, tuple(sorted(untaken)), untaken=True))
        return while_waiting

    def _note_end(self, number: int, followed: FollowedEnds) -> None:
        """Note that a thread that has ended, or waits forever, takes no more samples."""
        place = self.thread.places[number]
        if not place.is_end:
            return
        self.ends = True
        if followed and (place.halts or not self.thread.is_outermost):
            self.gaps.append(Gap(number, tuple(sorted((key[0], period) for key, period, _ in followed))))


def _too_many(iterations: int) -> str:
    return (
        f"this repeats {iterations} times before it waits for a sample or an event, and no more than "
        f"{LARGEST_NUMBER_OF_ITERATIONS} rounds are followed"
    )


def _partner_offer(offer: Offer) -> Offer | None:
    return offer if offer.kind == "partner" else None


def _merge_visits(paths: list[Path]) -> Path:
    """One path for all states in which a wait may be left."""
    if len(paths) == 1:
        return paths[0]
    found = merge_branches((path, 0, False, None, False) for path in paths)
    found.is_unique = False
    return found


def cycles(stops: dict[int, frozenset[int]]) -> list[frozenset[int]]:
    """Sets of waits that a thread can reach from one another; ``stops`` leads from each wait to the next ones."""
    found = strong_components(stops, lambda wait: sorted(stops.get(wait, ())))
    return [frozenset(group) for group in found if len(group) > 1 or group[0] in stops.get(group[0], ())]
