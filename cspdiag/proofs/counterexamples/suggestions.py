"""Changes of the text that may remove a deadlock, the smallest first; only a proof can show whether one does."""

from __future__ import annotations

from collections.abc import Iterator

from cspdiag.model.program import Program
from cspdiag.network.ir.network import CoreNetwork
from cspdiag.proofs.counterexamples.change_connections import buffered, exchanged_connections
from cspdiag.proofs.counterexamples.change_steps import exchanged, parallel, served_first, served_in_any_order
from cspdiag.proofs.counterexamples.counterexample import Counterexample
from cspdiag.proofs.counterexamples.suggestion import Suggestion


def suggestions(found: Counterexample, program: Program, network: CoreNetwork) -> Iterator[Iterator[Suggestion]]:
    """The changes to try for processes that wait for each other, grouped by kind."""
    waiting = [entry for entry in found.waiting if entry.name in found.ring] or list(found.waiting)
    places = list(dict.fromkeys(entry.span for entry in waiting if entry.span is not None))
    yield exchanged(program, places)
    yield exchanged_connections(program, network, waiting)
    yield parallel(program, places)
    yield served_first(program, places)
    yield served_in_any_order(program, places)
    yield buffered(program, network, waiting)
