"""A transition system allows every run of its program, in whatever order the ready processes continue, and whatever
comes from outside.
"""

from __future__ import annotations

from collections import Counter
from pathlib import Path

import pytest

from cspdiag.base import SourceFile
from cspdiag.proofs.transitions import transition_system
from tests.conformance.sources import network_of, read
from tests.proofs.transitions.following import Lost
from tests.proofs.transitions.hunt import schedule
from tests.proofs.transitions.schedules import random_run
from tests.properties.drawing import draw_programs

PROGRAMS = sorted((Path(__file__).parent / "any_order").glob("*.csp"))


@pytest.mark.parametrize("path", PROGRAMS, ids=lambda path: path.stem)
def test_program_of_one_construct(path: Path) -> None:
    network = network_of(read(str(path)))
    assert len(random_run(network, 0, until=20_000_000).trace) > 0
    assert schedule(network, 5, limit=20_000)["any order: too many states"] < 5


def test_random_program() -> None:
    found: Counter[str] = Counter()

    def look(text: str) -> None:
        found.update(schedule(network_of(SourceFile(name="random.csp", text=text)), 3, limit=2_000))

    draw_programs(look, 10, 11, shrink=False)
    assert found["any order: terminated"] > 3
    assert found["any order: deadlock"] > 3


def test_run_that_the_system_does_not_allow_is_found() -> None:
    twice = "process Main {\n  out o : int\n\n  composition { o ! 1 ; wait 1 ms ; o ! 2 }\n}\n"
    network = network_of(SourceFile(name="twice.csp", text=twice))
    once = network_of(SourceFile(name="once.csp", text=twice.replace(" ; wait 1 ms ; o ! 2", "")))
    with pytest.raises(Lost, match="schedule 0: after 1 of 2 communications"):
        schedule(network, 1, limit=100, system=transition_system(once))
