"""However a correct program is damaged, the answer is a list of diagnostics or a package, never a traceback.

``python -m tests.robustness.hunt`` tries more of them.
"""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from tests.robustness.answers import answer
from tests.robustness.damage import damaged

PROGRAMS = 250
BLOCK = 125


@pytest.mark.parametrize("start", range(0, PROGRAMS, BLOCK))
def test_a_damaged_program_gets_an_answer(start: int) -> None:
    answers = [answer(str(path), text) for path, text in map(damaged, range(start, start + BLOCK))]
    refused = sum(checked.report.has_errors or checked.program is None for checked in answers)
    # Both kinds of programs occur: those that are refused, and those that are still correct.
    assert BLOCK // 2 < refused < BLOCK * 9 // 10


@settings(max_examples=100)
@given(st.text(st.characters(codec="utf-8"), max_size=200))
def test_any_text_gets_an_answer(text: str) -> None:
    answer("any.csp", text)
