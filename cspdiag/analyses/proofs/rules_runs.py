"""Networks in which nobody chooses: one run tells all, as in networks of I/O-PAR and I/O-SEQ processes.

A component is **steady** when it never takes an offer back except by accepting it: in no state do two of its edges carry the same event, and two different ones may
be taken in either order with the same result. Networks of steady components are persistent (Landweber and Robertson, 1978; Keller, 1975): all fair runs do
the same, up to the order of what is independent. So the one run in which everything that can happen does decides: it ends in the only deadlock
there is, or comes back to a state that it has been in, in which a knot is seen if there is one. It generalizes the rule that networks of I/O-PAR processes never
deadlock (Welch, Justo and Willcock, 1993) and that of circles of I/O-SEQ ones with an I/O-PAR process in each.
"""

from __future__ import annotations

from dataclasses import dataclass

from cspdiag.analyses.proofs.pairs import Shape, Structure
from cspdiag.analyses.proofs.verdict import Limits, Move
from cspdiag.analyses.transitions.system import INTERNAL


@dataclass(frozen=True)
class Run:
    """The run until it comes round or ends: the moves to where it has been ``period`` moves before, or to where nothing is possible."""

    moves: tuple[Move, ...]
    state: tuple[int, ...]
    period: int
    """The number of moves of a round, 0 if the run ends."""


def is_steady(shape: Shape) -> bool:
    """Whether a component chooses nowhere: see the module."""
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


def unsteady(structure: Structure) -> int | None:
    """The first component that chooses, or None."""
    known: dict[int, bool] = {}
    for component, shape in enumerate(structure.shapes):
        steady = known.get(id(shape))
        if steady is None:
            steady = known[id(shape)] = is_steady(shape)
        if not steady:
            return component
    return None


def the_run(structure: Structure, limits: Limits, most_moves: int) -> Run | None:
    """The run of a network of steady components, in rounds in which everything happens that can; None if it takes more than ``most_moves``.

    Raises LimitError when the time is up.
    """
    run = _Running(structure)
    marked_at, distance = 0, 1
    while run.possible:
        limits.check()
        run.step()
        if run.differing == 0:
            return Run(tuple(run.moves), tuple(run.state), len(run.moves) - marked_at)
        if len(run.moves) > most_moves:
            return None
        # The comparison point of Brent ("An improved Monte Carlo factorization algorithm", 1980) moves on in doubling distances.
        if len(run.moves) - marked_at >= distance:
            marked_at, distance = len(run.moves), 2 * distance
            run.mark()
    return Run(tuple(run.moves), tuple(run.state), 0)


class _Running:
    """A run under way: ``possible`` are the events, and the components with an internal step, that can happen now."""

    def __init__(self, structure: Structure) -> None:
        self.structure = structure
        self.state = [shape.initial for shape in structure.shapes]
        self.moves: list[Move] = []
        self.parties = [event.parties for event in structure.system.events]
        self.willing = [0] * len(self.parties)
        self.possible: dict[tuple[int, int], None] = {}
        self.differing = 0
        self._marked: list[int] = self.state.copy()
        for component in range(len(self.state)):
            self._offer(component)

    def mark(self) -> None:
        """Remember the present state: ``differing`` counts the components that are in another one."""
        self._marked = self.state.copy()
        self.differing = 0

    def _offer(self, component: int) -> None:
        shape, events = self.structure.shapes[component], self.structure.events[component]
        for number, _ in shape.edges[self.state[component]]:
            if number == INTERNAL:
                self.possible[(INTERNAL, component)] = None
                continue
            event = events[number]
            self.willing[event] += 1
            if self.willing[event] == len(self.parties[event]):
                self.possible[(event, 0)] = None

    def _withdraw(self, component: int) -> None:
        shape, events = self.structure.shapes[component], self.structure.events[component]
        for number, _ in shape.edges[self.state[component]]:
            if number == INTERNAL:
                self.possible.pop((INTERNAL, component), None)
            else:
                event = events[number]
                self.willing[event] -= 1
                self.possible.pop((event, 0), None)

    def step(self) -> None:
        """Let everything happen that is possible now, each once."""
        for event, component in list(self.possible):
            parties = (component,) if event == INTERNAL else self.parties[event]
            targets = [self._target(party, event) for party in parties]
            for party in parties:
                self._withdraw(party)
            for party, after in zip(parties, targets, strict=True):
                self.differing += (after != self._marked[party]) - (self.state[party] != self._marked[party])
                self.state[party] = after
            for party in parties:
                self._offer(party)
            self.moves.append(Move(event, tuple(zip(parties, targets, strict=True))))

    def _target(self, component: int, event: int) -> int:
        events = self.structure.events[component]
        return next(
            after
            for number, after in self.structure.shapes[component].edges[self.state[component]]
            if (events[number] if number != INTERNAL else INTERNAL) == event
        )
