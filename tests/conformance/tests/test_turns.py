"""The generator of programs that communicate in turn, and a few of its programs on the Python targets."""

from __future__ import annotations

import pytest

from cspdiag import pipeline
from cspdiag.base import SourceFile
from cspdiag.base.sources import read_source
from tests.conformance.random.compare import LEAST, communications, difference
from tests.conformance.random.turns import turns
from tests.conformance.sources import network_of


def test_all_programs_are_correct_and_most_communicate_often() -> None:
    made = [communications(str(turns(seed))) for seed in range(30)]
    assert None not in made
    assert sum(count is not None and count >= LEAST for count in made) >= 20


@pytest.mark.parametrize(("text", "least"), [("self->turn", 5), (".alternative.chosen]", 3)])
def test_many_programs_have_loops_and_branches_in_c_that_compute_with_their_number(text: str, least: int) -> None:
    having = 0
    for seed in range(10):
        network = network_of(SourceFile(name="random.csp", text=str(turns(seed))))
        files = pipeline.generate(network, read_source, "c", 0)
        having += any(text in file for file in files.values())
    assert having >= least


@pytest.mark.parametrize("seed", range(100, 108))
def test_readable_and_optimized_python_do_as_the_reference(seed: int) -> None:
    assert difference(str(turns(seed)), ("python-O0", "python-O1")) == ""
