"""The generator of programs that compute with what is known before they run, and a few of its programs on the Python
targets.
"""

from __future__ import annotations

import pytest

from tests.conformance.random.compare import communications, difference
from tests.conformance.random.known import known


def test_programs_are_correct_and_write_what_they_compute() -> None:
    made = [communications(str(known(seed))) for seed in range(12)]
    correct = [count for count in made if count is not None]
    assert len(correct) >= 10
    assert sum(correct) >= 5 * len(correct)


@pytest.mark.parametrize("seed", [1, 6, 15, 21, 22, 26, 30, 136, 263])
def test_readable_and_optimized_python_do_as_the_reference(seed: int) -> None:
    text = str(known(seed))
    if communications(text) is not None:
        assert difference(text, ("python-O0", "python-O1")) == ""
