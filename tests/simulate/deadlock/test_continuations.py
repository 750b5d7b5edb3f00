"""What a process is found to communicate after a wait contains what it does communicate: reports of deadlocks say that
no process does what is not in it.
"""

from __future__ import annotations

from collections.abc import Callable

import pytest

from cspdiag.base import SourceFile
from cspdiag.network.ir.network import CoreNetwork
from cspdiag.semantics.execute import execute
from cspdiag.semantics.scheduler import Scheduler
from cspdiag.simulate.deadlock.continuations import Continuations, Use
from cspdiag.simulate.deadlock.waiting import Offer, WaitingRecord
from cspdiag.simulate.run.whereabouts import Whereabouts
from tests.conformance.random.compare import LIMIT
from tests.conformance.random.meetings import meetings
from tests.conformance.random.nested import nested
from tests.conformance.random.nodes import Program
from tests.conformance.random.parts import parts
from tests.conformance.sources import InvalidProgramError, network_of

PROGRAMS = 25
STANDSTILLS = 20


def standstills(network: CoreNetwork) -> list[tuple[int, list[WaitingRecord]]]:
    """The processes that wait at the ends of the first instants of a run, with the numbers of communications so far."""
    found: list[tuple[int, list[WaitingRecord]]] = []
    places = Whereabouts(network)

    class Observed(Scheduler):
        def run_until_none_is_ready(self) -> None:
            super().run_until_none_is_ready()
            assert self.main is not None
            if not self.main.ended and len(found) < STANDSTILLS:
                found.append((len(self.trace), [_at_delay(record) for record in places.waiting(self.main)]))

    execute(network, None, LIMIT, scheduler=Observed)
    return found


def _at_delay(record: WaitingRecord) -> WaitingRecord:
    """A record that may also be of a delay: those of deadlocks need not distinguish it from ``stop``."""
    if record.waits == "forever, at stop":
        record.waits = "until later"
    return record


@pytest.mark.parametrize("program", [meetings, nested, parts])
def test_all_that_follows_was_expected(program: Callable[[int], Program]) -> None:
    followed = 0
    for seed in range(PROGRAMS):
        try:
            network = network_of(SourceFile(name="random.csp", text=str(program(seed))))
        except InvalidProgramError:
            continue
        continuations = Continuations(network)
        trace = execute(network, None, LIMIT).trace
        for made, waiting in standstills(network):
            expected = frozenset[Use]().union(*map(continuations.of, waiting))
            for communication in trace[made:]:
                for side, path in (("write", communication.writer), ("read", communication.reader)):
                    if path:
                        followed += 1
                        use = Use(Offer(communication.channel, side), continuations.process_of(path))
                        assert use in expected, f"seed {seed}: {use} after {waiting}"
    assert followed > 100
