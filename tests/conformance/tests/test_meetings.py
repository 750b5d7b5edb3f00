"""The generator of programs that communicate often, and a few of its programs on the Python targets."""

from __future__ import annotations

import pytest

from tests.conformance.random.compare import LEAST, communications, difference
from tests.conformance.random.meetings import meetings


def test_most_programs_are_correct_and_half_of_them_communicate_often() -> None:
    made = [communications(str(meetings(seed))) for seed in range(40)]
    correct = [count for count in made if count is not None]
    assert len(correct) >= 30
    assert sum(count >= LEAST for count in correct) >= len(correct) / 2


def test_a_quarter_of_the_programs_runs_laws_between_variables() -> None:
    made = [str(meetings(seed)) for seed in range(60)]
    assert sum(": Sums" in text or ": Counts" in text for text in made) >= 15


@pytest.mark.parametrize("seed", [2, 13, 181])
def test_law_of_a_cancelled_process_does_not_run(seed: int) -> None:
    """Programs with such laws in parallel with interrupts."""
    assert difference(str(meetings(seed)), ("python-O0",)) == ""


@pytest.mark.parametrize("seed", range(100, 112))
def test_readable_and_optimized_python_do_as_the_reference(seed: int) -> None:
    text = str(meetings(seed))
    if communications(text) is not None:
        assert difference(text, ("python-O0", "python-O1")) == ""


def test_smaller_programs_are_smaller() -> None:
    program = meetings(7)
    size = sum(body.size() for _, _, body in program.leaves) + program.top.size()
    for other in program.smaller():
        assert sum(body.size() for _, _, body in other.leaves) + other.top.size() <= size
