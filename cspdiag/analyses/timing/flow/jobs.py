"""The jobs of a thread: everything that it does from any wait that it may come to, with the samples that it follows
there.

All ways are followed, from the beginning on. A thread that follows samples of a period may wait only where the next of
them ends the wait, for a known time, or for partners; and from a sample on it has to take those of its other ends, too,
before it waits for the next. What is otherwise is a ``Gap``: nothing is proved of it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from cspdiag.analyses.timing.flow.followed import (
    NOTHING,
    Books,
    Standing,
    at_tick,
    is_first,
    is_open,
    is_owed,
    moved,
    opened,
    periods,
    with_standing,
)
from cspdiag.analyses.timing.flow.paths import Job, Node, Path, either
from cspdiag.analyses.timing.threads.graph import Offer, Place, Thread
from cspdiag.analyses.timing.threads.termination import MOST_ROUNDS
from cspdiag.base import Span
from cspdiag.base.graphs import reached, strong_components
from cspdiag.base.record import record

State = tuple[int, Books]
Step = tuple[State, int, bool, Offer | None, bool]
"""Where it goes on: the state, the delay before, whether others run meanwhile, the communication, if it is waited for.
"""

LARGEST_NUMBER_OF_NODES = 2_000


class UnboundedError(Exception):
    """The work between two waits has no bound; ``span`` is the place of the loop."""

    def __init__(self, reason: str, span: Span) -> None:
        super().__init__(reason)
        self.reason = reason
        self.span = span


@record
class Gap:
    """A place at which samples of some inputs, with their periods, may come unseen while a thread waits there.

    ``untaken``: it may have to take that of the last tick still.
    """

    place: int
    followed: tuple[tuple[str, int], ...]
    untaken: bool = False


class Jobs:
    """The jobs of one thread. With ``meets`` rendezvous are part of one."""

    def __init__(self, thread: Thread, *, meets: bool = True) -> None:
        self.thread = thread
        self.meets = meets
        self._begins = False
        """Whether nothing has happened yet."""
        self.ends = False
        """Whether the thread may come to its end, or to a ``stop``, without an exception."""
        self.gaps: list[Gap] = []

    def all(self) -> list[Job]:
        """The job from the beginning, and one for each offer of each wait that the thread may come to."""
        self._begins = self.thread.begins_at_once
        begins = self._path(self.thread.entry, 0, NOTHING)
        self._begins = False
        found: dict[tuple[int, int], list[tuple[Offer, Path, bool]]] = {}
        seen: set[Node] = set(begins.nodes)
        pending = list(begins.nodes)
        while pending:
            number, books = pending.pop()
            for which, offer in enumerate(self.thread.places[number].offers):
                path = self._from(number, offer, books)
                found.setdefault((number, which), []).append((offer, path, bool(books)))
                new = path.nodes - seen
                seen |= new
                pending += new
                if len(seen) > LARGEST_NUMBER_OF_NODES:
                    place = self.thread.places[number]
                    raise UnboundedError("it waits in too many different situations to look at", place.span)
        self.gaps = list(dict.fromkeys(self.gaps))
        return [Job(-1, None, begins)] + [
            Job(number, ways[0][0], _merged([path for _, path, _ in ways]), any(owed for _, _, owed in ways))
            for (number, _), ways in sorted(found.items())
        ]

    def _from(self, number: int, offer: Offer, books: Books) -> Path:
        """The path after a wait."""
        period = 0
        if offer.kind == "sample":
            period = offer.period
            books = at_tick(books, period)
            if offer.takes:
                books = with_standing(books, [offer], Standing.TAKEN)
        place, target = self.thread.places[number], self.thread.places[offer.target]
        return self._path(offer.target, period, moved(opened(books, offer.opens), place, target))

    def reachable(self, starts: Iterable[int], period: int, avoided: int) -> set[int]:
        """The places that a job may come to from some without passing another one, if all samples are there."""
        offers = [offer for place in self.thread.places for offer in place.offers if offer.kind == "sample"]
        books = at_tick(with_standing(NOTHING, offers, Standing.TAKEN), period)
        begin = [(start, books) for start in starts if start != avoided]

        def after(state: State) -> list[State]:
            return [following for following in self._next(state, period) if following[0] != avoided]

        return {number for number, _ in reached(begin, after)}

    def _path(self, start: int, period: int, books: Books) -> Path:
        done: dict[State, Path] = {}
        open_: set[State] = set()
        pending: list[tuple[State, bool]] = [((start, books), False)]
        while pending:
            state, is_left = pending.pop()
            if is_left:
                open_.discard(state)
                done[state] = self._combined(state, period, done)
                continue
            if state in done or state in open_:
                continue
            open_.add(state)
            pending.append((state, True))
            for following, _, _, _, _ in self._following(state, period):
                if following in open_:
                    self._check_loop(following, period)
                elif following not in done:
                    pending.append((following, False))
        return done[start, books]

    def _check_loop(self, back: State, period: int) -> None:
        """A way back without any wait: without work it is no matter, otherwise nobody knows how often it is gone."""
        inside = set(reached([back], lambda state: self._next(state, period)))
        numbers = {state for state in inside if self._comes_back(state, back, period)}
        around = [(self.thread.places[number], books) for number, books in numbers]
        turns = self._turns({number for number, _ in numbers})
        for place, books in around:
            if self._lets_pass(place, books):
                reason = (
                    "it may go round a loop that waits here for time to pass, without a sample in between, nobody "
                    "knows how often"
                )
                raise UnboundedError(_too_many(turns) if turns else reason, place.span)
        if any(place.cost or place.offers for place, _ in around):
            place = self.thread.places[back[0]]
            reason = "how often this repeats before it waits for a sample or an event cannot be seen"
            raise UnboundedError(_too_many(turns) if turns else reason, place.span)

    def _turns(self, inside: set[int]) -> int | None:
        """How many rounds the innermost loop around some places has, if that is known."""
        around = [circle for circle in self.thread.circles if circle.again <= min(inside) and max(inside) < circle.end]
        return min(around, key=lambda circle: circle.end - circle.again).turns if around else None

    def _comes_back(self, state: State, goal: State, period: int) -> bool:
        return goal in reached(self._next(state, period), lambda here: self._next(here, period))

    def _next(self, state: State, period: int) -> list[State]:
        return [following for following, *_ in self._following(state, period)]

    def _following(self, state: State, period: int) -> Iterator[Step]:
        """Where it goes on without stopping."""
        number, books = state
        place = self.thread.places[number]
        if not place.offers:
            books = opened(books, place.opens)
            for target in place.successors:
                yield (target, moved(books, place, self.thread.places[target])), 0, place.breaks, None, False
        elif place.polls:
            yield from self._at_once(place, books, period)
            for target in place.successors:
                yield (target, moved(books, place, self.thread.places[target])), 0, False, None, False
        elif any(self._is_there(offer, books, period) for offer in place.offers):
            yield from self._at_once(place, books, period)
        elif self._lets_pass(place, books):
            longest = place.longest_delay() or 0
            for offer in place.offers:
                yield self._after(place, offer, books), longest, True, _met(offer), False
        elif self.meets and not place.is_idle:
            for offer in place.offers:
                yield self._after(place, offer, books), 0, True, offer, True

    def _stops(self, state: State, period: int) -> bool:
        """Whether it may wait there for something that is no part of a job."""
        number, books = state
        place = self.thread.places[number]
        if not place.offers or place.polls or self._lets_pass(place, books):
            return False
        if any(offer.is_certain and self._is_there_surely(offer, books, period) for offer in place.offers):
            return False
        return place.is_idle or not self.meets

    def _lets_pass(self, place: Place, books: Books) -> bool:
        """Whether a thread that follows samples waits there for none, and no longer than they are apart."""
        longest = place.longest_delay()
        return bool(books) and longest is not None and not place.periods() and longest < min(periods(books))

    def _at_once(self, place: Place, books: Books, period: int) -> Iterator[Step]:
        """What may be there already when a thread comes to a wait."""
        for offer in place.offers:
            if offer.kind == "sample" and not self._is_there(offer, books, period) and not place.polls:
                continue
            if offer.kind == "sample" and (offer.key, period, Standing.TAKEN) in books:
                continue
            yield self._after(place, offer, books), 0, False, _met(offer), False

    def _is_there(self, offer: Offer, books: Books, period: int) -> bool:
        """Whether a sample that is offered may be there already."""
        if offer.kind != "sample":
            return False
        # Another branch of the process may follow the period already.
        is_shared = bool(self.thread.shared) and not self._begins and (offer.key[1], offer.period) in self.thread.shared
        return is_owed(books, offer) or is_first(books, offer) or (is_shared and not is_open(books, offer))

    def _is_there_surely(self, offer: Offer, books: Books, period: int) -> bool:
        """Whether a sample that is offered is there for certain."""
        if offer.kind != "sample":
            return False
        # A job that a sample began belongs to its tick: who follows the period has had a first one.
        return is_owed(books, offer) or (offer.period == period and is_first(books, offer, surely=True))

    def _after(self, place: Place, offer: Offer, books: Books) -> State:
        if offer.kind == "sample" and offer.takes:
            books = with_standing(books, [offer], Standing.TAKEN)
        elif offer.kind == "sample" and not is_owed(books, offer):
            books = with_standing(books, [offer], Standing.OWED)
        return offer.target, moved(opened(books, offer.opens), place, self.thread.places[offer.target])

    def _combined(self, state: State, period: int, done: dict[State, Path]) -> Path:
        number, books = state
        place = self.thread.places[number]
        steps = list(self._following(state, period))
        # Around a loop without work, there is nothing to add.
        known = [(done[step[0]], *step[1:]) for step in steps if step[0] in done]
        path = either(iter(known))
        path.is_only &= len(known) == len(steps)
        if self._stops(state, period):
            path.is_only &= not steps
            path.nodes |= {(number, self._settled(number, books))}
            path.keeps |= periods(books)
        elif not steps:
            self._note_end(number, books)
        self._add(path, number, place)
        return path

    def _add(self, path: Path, number: int, place: Place) -> None:
        """What a place itself does."""
        for net in place.gives:
            path.gives[net, True] = path.gives.get((net, True), 0) + 1
        path.work += place.cost
        path.least += place.cost
        path.first += place.cost
        path.outputs |= set(place.outputs)
        if place.move is not None:
            path.moves |= {number}
        if place.leaf:
            path.leaves |= {place.leaf}
        if place.leaf and place.cost >= path.heaviest[0]:
            path.heaviest = (place.cost, place.leaf)

    def _settled(self, number: int, books: Books) -> Books:
        """The books with which it waits: it follows all inputs for which it waits there. Notes what nobody takes."""
        place = self.thread.places[number]
        untaken = [
            (key[0], period)
            for key, period, standing in books
            if standing == Standing.OWED
            and not any(offer.key == key and offer.is_certain for offer in place.offers if offer.kind == "sample")
        ]
        books = with_standing(books, place.offers, Standing.TAKEN)
        settled = frozenset(
            (key, period, Standing.TAKEN if standing == Standing.OWED else standing) for key, period, standing in books
        )
        unseen = periods(settled) - place.certain_periods()
        if unseen:
            followed = sorted((key[0], period) for key, period, _ in settled if period in unseen)
            self.gaps.append(Gap(number, tuple(followed)))
        if untaken:
            self.gaps.append(Gap(number, tuple(sorted(untaken)), untaken=True))
        return settled

    def _note_end(self, number: int, books: Books) -> None:
        """A thread that has ended, or waits forever, takes no more samples."""
        place = self.thread.places[number]
        if not place.is_end:
            return
        self.ends = True
        if books and (place.halts or not self.thread.is_outermost):
            self.gaps.append(Gap(number, tuple(sorted((key[0], period) for key, period, _ in books))))


def _too_many(turns: int) -> str:
    return (
        f"this repeats {turns} times before it waits for a sample or an event, and no more than {MOST_ROUNDS} rounds "
        "are followed"
    )


def _met(offer: Offer) -> Offer | None:
    return offer if offer.kind == "partner" else None


def _merged(paths: list[Path]) -> Path:
    """One path for all with which a wait may be left."""
    if len(paths) == 1:
        return paths[0]
    found = either((path, 0, False, None, False) for path in paths)
    found.is_only = False
    return found


def cycles(stops: dict[int, frozenset[int]]) -> list[frozenset[int]]:
    """Sets of waits that a thread may come back to from each other; ``stops`` leads from each wait to the next ones."""
    found = strong_components(stops, lambda wait: sorted(stops.get(wait, ())))
    return [frozenset(group) for group in found if len(group) > 1 or group[0] in stops.get(group[0], ())]
