"""Programs from the literature have the known numbers of states and deadlocks, and the known shortest traces.

Written in the language they have the same numbers as their machines: a parallel that starts first does not need a step
of its own.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from cspdiag import load
from cspdiag.proofs.search.breadth_first import count, deadlock_free
from cspdiag.proofs.transitions import transition_system
from cspdiag.proofs.transitions.systems.system import System
from cspdiag.proofs.verdict import Limits, Refuted

PROGRAMS = Path(__file__).parent / "programs"


def system_of(name: str, top: str, number: int | None = None) -> System:
    settings = {} if number is None else {"number": number}
    return transition_system(load(PROGRAMS / f"{name}.csp").build(top=top, set=settings))


@pytest.mark.parametrize(
    ("name", "top", "number", "states", "deadlocks"),
    [
        *(("philosophers", "SymmetricTable", n, states, 1) for n, states in ((4, 543), (5, 2623), (6, 12671))),
        *(("philosophers", "Table", n, states, 0) for n, states in ((4, 464), (5, 2240), (6, 10816))),
        *(("scheduler", "Scheduler", n, 3 * n * 2 ** (n - 1), 0) for n in (3, 5, 8)),
        *(("token_ring", "Ring", n, n * 2 ** (n + 1), 0) for n in (3, 5, 8)),
        ("io_par_ring", "Ring", 4, 70, 0),
        ("io_par_ring", "Ring", 8, 12870, 0),
        ("io_seq_ring", "Ring", 4, 1, 1),
        ("client_server", "Chain", 4, 7, 0),
        ("client_server", "Chain", 8, 15, 0),
        ("client_server", "Ring", 3, 17, 7),
        ("client_server", "Ring", 5, 122, 31),
        ("alternating_bit", "LossyProtocol", None, 116, 0),
        ("alternating_bit", "ReliableProtocol", None, 92, 6),
    ],
)
def test_states_and_deadlocks(name: str, top: str, number: int | None, states: int, deadlocks: int) -> None:
    found = count(system_of(name, top, number), Limits())
    assert found == (states, deadlocks)


@pytest.mark.parametrize(
    ("name", "top", "number", "length"),
    [
        ("philosophers", "SymmetricTable", 4, 8),
        ("philosophers", "SymmetricTable", 6, 12),
        ("client_server", "Ring", 3, 3),
        ("client_server", "Ring", 5, 5),
        ("alternating_bit", "ReliableProtocol", None, 11),
    ],
)
def test_shortest_trace(name: str, top: str, number: int | None, length: int) -> None:
    verdict = deadlock_free(system_of(name, top, number), Limits())
    assert isinstance(verdict, Refuted)
    assert len(verdict.trace) == length


@pytest.mark.parametrize(("name", "top", "per_cell"), [("philosophers", "Table", 2), ("scheduler", "Scheduler", 1)])
def test_equal_instances_share_what_was_found_out(
    name: str, top: str, per_cell: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    from cspdiag.proofs.transitions.threads import explore as exploring
    from cspdiag.proofs.transitions.threads import threads

    followed: list[str] = []

    def noted(occurrence, node, role):  # type: ignore[no-untyped-def]
        followed.append(occurrence.path)
        return exploring.explore(occurrence, node, role)

    monkeypatch.setattr(threads, "explore", noted)
    system = system_of(name, top, 200)
    assert len(system.components) == 1 + 200 * per_cell
    assert len(followed) <= 4
