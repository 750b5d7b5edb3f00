"""The generator of programs with nested interrupts that meet, and a few of its programs on the Python targets."""

from __future__ import annotations

import re

import pytest

from tests.conformance.random.compare import LEAST, communications, difference
from tests.conformance.random.nested import nested


def test_most_programs_are_correct_and_half_of_them_communicate_often() -> None:
    made = [communications(str(nested(seed))) for seed in range(30)]
    correct = [count for count in made if count is not None]
    assert len(correct) >= 28
    assert sum(count >= LEAST for count in correct) >= len(correct) / 2


def test_guards_of_interrupts_are_both_ends_of_one_channel() -> None:
    texts = [str(nested(seed)) for seed in range(40)]
    both = [text for text in texts if _guards(text, "!") & _guards(text, r"\?")]
    offered = [text for text in texts if (_guards(text, "!") | _guards(text, r"\?")) & _offers(text)]
    assert len(both) > 20
    assert len(offered) > 20


def _guards(text: str, way: str) -> set[str]:
    """The channels inside a process with which guards of interrupts communicate."""
    return set(re.findall(rf"interrupt (?:when [^&]*& )?(own\d+) {way}", text))


def _offers(text: str) -> set[str]:
    return set(re.findall(r"\((own\d+) [?!]", text))


@pytest.mark.parametrize("seed", range(100, 108))
def test_readable_and_optimized_python_do_as_the_reference(seed: int) -> None:
    assert difference(str(nested(seed)), ("python-O0", "python-O1")) == ""
