"""From a candidate to a trace: a search directed towards the states of a candidate.

A candidate of the SAT proof says in which states the stuck components would be. The distance of each of them from
there, in its own graph, shows which steps lead nearer. First only such steps are taken; when none is left, the most
promising of all states found so far is expanded (best-first search; Hart, Nilsson and Raphael, 1968). A trace that is
found is a real one; if none is found, nothing is known.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from heapq import heappop, heappush
from itertools import product

from cspdiag.proofs.search.stuck_sets import OffersByState
from cspdiag.proofs.search.traces import causes, end_of
from cspdiag.proofs.structure.pairs import Shape
from cspdiag.proofs.structure.question import StuckQuestion
from cspdiag.proofs.transitions.systems.system import INTERNAL
from cspdiag.proofs.verdict import LimitError, Limits, Method, Move, Refuted

MOST_STATES = 30_000
"""The number of states examined before the search gives up; fewer in larger systems."""

MOST_PLACES = 1_000_000
"""The limit of the number of states examined times the number of components."""

SMALL = 60
"""In systems with at most this number of components every state is examined for a knot, and a shortest trace
is sought.
"""

FAR = 1 << 30
"""The distance of a state from which a component never reaches its state in the candidate."""


def refute_by_candidate(
    question: StuckQuestion,
    candidate: Sequence[int],
    stuck: Sequence[int],
    limits: Limits,
    method: Method,
    most_states: int = MOST_STATES,
) -> Refuted | None:
    """A refutation with a deadlock or a knot like the candidate; None if none was found within the limits.

    If ``most_states`` is 0, only steps that lead nearer are tried.
    """
    search = _Search(question, candidate, stuck)
    trace: list[Move] | None = None
    try:
        trace = search.descend(limits)
        if trace is None and most_states:
            trace = search.follow(limits, most_states, eager=True)
        if trace is not None and most_states and len(candidate) <= SMALL:
            shorter = search.follow(limits, most_states, eager=False)
            if shorter is not None and len(shorter) < len(trace):
                trace = shorter
    except LimitError:
        pass
    if trace is None:
        return None
    offers, end = OffersByState(question.system), end_of(question.system.initial, trace)
    if question.together:
        return Refuted(method, tuple(trace), offers.waiting(end))
    members = offers.knot(end)
    kept = causes(trace, members)
    # Without the other moves a failure may be possible that ends the wait.
    if not set(members) <= set(offers.knot(end_of(question.system.initial, kept))):
        kept = tuple(trace)
    return Refuted(method, kept, members)


class _Search:
    """Distances to a candidate, and the steps of the system."""

    def __init__(self, question: StuckQuestion, candidate: Sequence[int], stuck: Sequence[int]) -> None:
        self.question, self.stuck = question, tuple(stuck)
        self.structure, self.system = question.structure, question.system
        self.offers = OffersByState(question.system)
        known: dict[tuple[int, int], list[int]] = {}
        self.distances: list[list[int] | None] = [None] * len(candidate)
        for component in self.stuck:
            shape, target = self.structure.shapes[component], candidate[component]
            key = (id(shape), target)
            if key not in known:
                known[key] = _distances(shape, target)
            self.distances[component] = known[key]
        self.widest = max((len(event.parties) for event in self.system.events), default=1)

    def distance(self, state: Sequence[int]) -> int:
        """The sum of the numbers of local steps from a global state to the candidate."""
        total = 0
        for component in self.stuck:
            distances = self.distances[component]
            total += distances[state[component]] if distances else 0
        return total

    def descend(self, limits: Limits) -> list[Move] | None:
        """The trace that only takes steps that lead nearer; None if it does not reach the candidate."""
        state = list(self.system.initial)
        trace: list[Move] = []
        waiting = [(component, event) for component in self.stuck for event, _ in self._edges(component, state)]
        waiting.reverse()
        while waiting:
            component, event = waiting.pop()
            move = self._nearest(component, event, state)
            if move is None:
                continue
            if len(trace) % 1000 == 0:
                limits.check()
            for party, after in move.moves:
                state[party] = after
            trace.append(move)
            waiting += [(party, other) for party, _ in move.moves for other, _ in self._edges(party, state)]
        return trace if self._is_like_candidate(state) else None

    def _edges(self, component: int, state: Sequence[int]) -> tuple[tuple[int, int], ...]:
        return self.system.components[component].edges[state[component]]

    def _nearest(self, component: int, event: int, state: Sequence[int]) -> Move | None:
        """The step with an event that leads nearest; None if it is not possible or does not lead nearer."""
        gain, moves = 0, []
        for party in (component,) if event == INTERNAL else self.system.events[event].parties:
            targets = [after for offered, after in self._edges(party, state) if offered == event]
            if not targets:
                return None
            distances = self.distances[party]
            after = min(targets, key=distances.__getitem__) if distances else targets[0]
            if distances:
                gain += distances[state[party]] - distances[after]
            moves.append((party, after))
        return Move(event, tuple(moves)) if gain > 0 else None

    def follow(self, limits: Limits, most_states: int, *, eager: bool) -> list[Move] | None:
        """The trace found by expanding the nearest state first (``eager``), or the one with the least sum of steps so
        far and steps at least to come, which finds a shortest trace; None if none is found.
        """
        start = self.system.initial
        most = min(most_states, MOST_PLACES // max(1, len(start)))
        parents: dict[tuple[int, ...], tuple[tuple[int, ...], Move] | None] = {start: None}
        steps = {start: 0}
        heap = [(self._rank(start, 0, eager), 0, start)]
        while heap and len(parents) < most:
            _, _, state = heappop(heap)
            limits.check()
            possible = list(self._moves(state))
            if self._is_like_candidate(state) or self._is_stuck(state, possible):
                return _trace(parents, state)
            for move in possible:
                local = list(state)
                for party, after in move.moves:
                    local[party] = after
                following = tuple(local)
                if following in steps and (eager or steps[following] <= steps[state] + 1):
                    continue
                if self.distance(following) < FAR:
                    parents[following] = (state, move)
                    steps[following] = steps[state] + 1
                    heappush(heap, (self._rank(following, steps[following], eager), len(parents), following))
        return None

    def _rank(self, state: Sequence[int], steps: int, eager: bool) -> tuple[int, int]:
        distance = self.distance(state)
        return (distance, steps) if eager else (steps + -(-distance // self.widest), distance)

    def _is_like_candidate(self, state: Sequence[int]) -> bool:
        """Whether the stuck components are in their states of the candidate, and no failure can release them."""
        return self.distance(state) == 0 and (not self.structure.fails or self._is_stuck(state, []))

    def _is_stuck(self, state: Sequence[int], possible: list[Move]) -> bool:
        if self.question.together:
            return not possible and bool(self.offers.waiting(state))
        return (len(state) <= SMALL or not possible) and bool(self.offers.knot(state))

    def _moves(self, state: Sequence[int]) -> Iterator[Move]:
        willing: dict[int, int] = {}
        for component in range(len(state)):
            for event in dict.fromkeys(event for event, _ in self._edges(component, state)):
                willing[event] = willing.get(event, 0) + 1
            for event, after in self._edges(component, state):
                if event == INTERNAL:
                    yield Move(INTERNAL, ((component, after),))
        for event, count in willing.items():
            if event == INTERNAL or count < len(self.system.events[event].parties):
                continue
            parties = self.system.events[event].parties
            choices = [[after for offered, after in self._edges(party, state) if offered == event] for party in parties]
            for targets in product(*choices):
                yield Move(event, tuple(zip(parties, targets, strict=True)))


def _distances(shape: Shape, target: int) -> list[int]:
    """The number of steps from every state of a shape to ``target`` if all partners are willing; ``FAR`` if it is
    unreachable.
    """
    before: list[list[int]] = [[] for _ in shape.edges]
    for state, edges in enumerate(shape.edges):
        for _, after in edges:
            before[after].append(state)
    distances = [FAR] * len(shape.edges)
    distances[target] = 0
    layer = [target]
    while layer:
        following = []
        for state in layer:
            for earlier in before[state]:
                if distances[earlier] == FAR:
                    distances[earlier] = distances[state] + 1
                    following.append(earlier)
        layer = following
    return distances


def _trace(parents: dict[tuple[int, ...], tuple[tuple[int, ...], Move] | None], state: tuple[int, ...]) -> list[Move]:
    moves = []
    while (parent := parents[state]) is not None:
        state, move = parent
        moves.append(move)
    return moves[::-1]
