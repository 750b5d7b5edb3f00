"""What a small program without inputs may do at all: by the semantics of the language over all its schedules, and by
its transition system over all its paths.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence

from cspdiag.network.ir.network import Network
from cspdiag.proofs.transitions.systems.system import INTERNAL, Event, System
from cspdiag.semantics.execute import execute
from cspdiag.semantics.requests import Task
from cspdiag.semantics.scheduler import Scheduler
from cspdiag.verify.decisions import Decisions
from tests.proofs.transitions.following import OBSERVED, State, has_ended, moves

Outcome = tuple[tuple[tuple[str, int], ...], str]
"""How often each channel communicated, and how it ended."""

MOST = 20_000


class TooManyError(Exception):
    """There are more schedules or paths than a small program has."""


def outcomes_of_meaning(network: Network) -> set[Outcome]:
    """Any ready process of the highest level may run, and any ready guard of ``[]`` may be chosen. Raises
    TooManyError.
    """
    decisions = Decisions()

    class AnyOrder(Scheduler):
        def next_task(self, ready: Sequence[Task]) -> Task:
            return ready[decisions.choose(len(ready))]

        def fair(self, ready: Sequence[int], last: int) -> int:
            return ready[decisions.choose(len(ready))]

    found: set[Outcome] = set()
    for _ in range(MOST):
        decisions.begin()
        done = execute(network, scheduler=AnyOrder)
        found.add(_outcome(Counter(entry.channel for entry in done.trace), done.ending.ended))
        if not decisions.advance():
            return found
    raise TooManyError


def outcomes_of_system(system: System) -> set[Outcome]:
    """Any possible step may be taken. Raises TooManyError."""
    start: tuple[State, frozenset[tuple[str, int]]] = (system.initial, frozenset())
    seen, pending = {start}, [start]
    found: set[Outcome] = set()
    while pending:
        state, made = pending.pop()
        following = [(after, _with(made, system, event)) for event, after in moves(system, state)]
        if not following:
            found.add(_outcome(Counter(dict(made)), "terminated" if has_ended(system, state) else "deadlock"))
        for step in following:
            if step not in seen:
                seen.add(step)
                pending.append(step)
        if len(seen) > MOST:
            raise TooManyError
    return found


def _with(made: frozenset[tuple[str, int]], system: System, number: int) -> frozenset[tuple[str, int]]:
    counts = Counter(dict(made))
    if number != INTERNAL:
        counts.update(_communications(system, system.events[number]))
    return frozenset(counts.items())


def _communications(system: System, event: Event) -> Iterator[str]:
    """An output guard on a broadcast serves all readers at once."""
    if event.kind in OBSERVED:
        processes = sum(system.components[party].process for party in event.parties)
        served = processes - 1 if event.kind == "communication" and processes > 2 else 1
        yield from [event.channel] * served


def _outcome(counts: Counter[str], ended: str) -> Outcome:
    return tuple(sorted(counts.items())), ended
