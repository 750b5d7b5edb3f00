"""Networks in which no component makes a choice: one run shows everything, as in networks of I/O-PAR and I/O-SEQ
processes.

A component is **steady** if it never withdraws an offer except by accepting it: in no state do two of its edges carry
the same event, and two different ones may be taken in either order with the same result. Networks of steady components
are persistent (Landweber and Robertson, 1978; Keller, 1975): all fair runs are the same up to the order of independent
steps. So it is enough to look at the run in which everything happens that can: it ends in the only deadlock, or returns
to an earlier state, in which a knot is found if there is one. This generalizes the rule that networks of I/O-PAR
processes never deadlock (Welch, Justo and Willcock, 1993) and the one about cycles of I/O-SEQ processes with an I/O-PAR
process in each.
"""

from __future__ import annotations

from typing import TypeAlias

from cspdiag.base.record import record
from cspdiag.proofs.structure.pairs import Shape, Structure
from cspdiag.proofs.transitions.systems.system import INTERNAL
from cspdiag.proofs.verdict import Limits, Move


@record
class PeriodicRun:
    """A run until it returns to the state of ``period`` steps before, or ends; ``taken`` are its steps, ``state`` is
    its last state.

    A step is an event, taken by all its parties, or the complement ``~i`` for an internal step of component ``i``.
    ``period`` is 0 if the run ends.
    """

    taken: list[int]
    state: tuple[int, ...]
    period: int


def is_steady(shape: Shape) -> bool:
    """Whether a component never makes a choice: see the module."""
    for state in shape.reachable:
        edges = dict(shape.edges[state])
        if len(edges) < len(shape.edges[state]):
            return False
        for event, after in edges.items():
            for other, beside in edges.items():
                if event < other and not _meet(shape, event, beside, other, after):
                    return False
    return True


def _meet(shape: Shape, event: int, beside: int, other: int, after: int) -> bool:
    first, second = dict(shape.edges[beside]).get(event), dict(shape.edges[after]).get(other)
    return first is not None and first == second


def first_unsteady(structure: Structure) -> int | None:
    """The first component that is not steady; None if all are."""
    known: dict[int, bool] = {}
    for component, shape in enumerate(structure.shapes):
        steady = known.get(id(shape))
        if steady is None:
            steady = known[id(shape)] = is_steady(shape)
        if not steady:
            return component
    return None


def only_run(structure: Structure, limits: Limits, most_moves: int) -> PeriodicRun | None:
    """The run of a network of steady components, in rounds in each of which everything happens that can; None if it
    takes more than ``most_moves``.

    Raises LimitError when the time is up.
    """
    run = _RunInProgress(structure)
    marked_at, distance = 0, 1
    while run.possible:
        limits.check()
        run.step()
        if run.differing == 0:
            return PeriodicRun(run.taken, tuple(run.state), len(run.taken) - marked_at)
        if len(run.taken) > most_moves:
            return None
        # The comparison point of Brent ("An improved Monte Carlo factorization algorithm", 1980) moves on in doubling
        # distances.
        if len(run.taken) - marked_at >= distance:
            marked_at, distance = len(run.taken), 2 * distance
            run.mark()
    return PeriodicRun(run.taken, tuple(run.state), 0)


def at_rest(structure: Structure, run: PeriodicRun) -> set[int]:
    """The components that take no part in the period of a run."""
    rest = set(range(len(structure.shapes)))
    for taken in run.taken[len(run.taken) - run.period :]:
        rest.difference_update((~taken,) if taken < 0 else structure.system.events[taken].parties)
    return rest


def moves_of(structure: Structure, run: PeriodicRun) -> tuple[Move, ...]:
    """The moves of a run with events of the system: of merged events, one that all parties offer."""
    system = structure.system
    state = list(system.initial)
    moves = []
    for taken in run.taken:
        parties = system.events[taken].parties if taken >= 0 else (~taken,)
        offers = [dict(system.components[party].edges[state[party]]) for party in parties]
        event = INTERNAL if taken < 0 else _representative(structure, taken, offers)
        targets = [offered[event] for offered in offers]
        for party, after in zip(parties, targets, strict=True):
            state[party] = after
        moves.append(Move(event, tuple(zip(parties, targets, strict=True))))
    return tuple(moves)


def _representative(structure: Structure, taken: int, offers: list[dict[int, int]]) -> int:
    return next(
        event
        for event in offers[0]
        if event != INTERNAL and structure.merged[event] == taken and all(event in offered for offered in offers)
    )


Step: TypeAlias = tuple[int, tuple[int, ...]]
"""The state after an edge, and the events (of the shape) that it offers anew: the state before did not, or they have
just been taken.
"""


class _RunInProgress:
    """A run in progress. ``possible`` are the events that can happen now, and the complements of components with an
    internal step.

    What is possible stays possible until it happens, because the components are steady.
    """

    def __init__(self, structure: Structure) -> None:
        tables = {id(shape): _steps(shape) for shape in {id(shape): shape for shape in structure.shapes}.values()}
        self._steps = [tables[id(shape)] for shape in structure.shapes]
        self._events = structure.events
        self._parties = structure.roles
        self._willing = [0] * len(self._parties)
        self.state = [shape.initial for shape in structure.shapes]
        self._marked = self.state.copy()
        self.differing = 0
        self.taken: list[int] = []
        self.possible: list[int] = []
        for component, shape in enumerate(structure.shapes):
            self._offer(component, tuple(number for number, _ in shape.edges[shape.initial]))

    def mark(self) -> None:
        """Marks the present state: ``differing`` counts the components that have left their part of it."""
        self._marked = self.state.copy()
        self.differing = 0

    def _offer(self, component: int, numbers: tuple[int, ...]) -> None:
        events = self._events[component]
        for number in numbers:
            if number == INTERNAL:
                self.possible.append(~component)
                continue
            event = events[number]
            self._willing[event] += 1
            if self._willing[event] == len(self._parties[event]):
                self.possible.append(event)

    def step(self) -> None:
        """Takes every step that is possible now once."""
        now, self.possible = self.possible, []
        state, marked = self.state, self._marked
        for taken in now:
            if taken >= 0:
                self._willing[taken] = 0
                parties = self._parties[taken]
            else:
                parties = [(~taken, INTERNAL)]
            for component, number in parties:
                before = state[component]
                after, offered = self._steps[component][before][number]
                self.differing += (before == marked[component]) - (after == marked[component])
                state[component] = after
                if offered:
                    self._offer(component, offered)
        self.taken += now


def _steps(shape: Shape) -> list[dict[int, Step]]:
    """The step of each state and event."""
    return [
        {
            event: (
                after,
                tuple(offered for offered, _ in shape.edges[after] if offered == event or offered not in dict(edges)),
            )
            for event, after in edges
        }
        for edges in shape.edges
    ]
