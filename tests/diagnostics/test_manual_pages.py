"""Every kind of diagnostic has a manual page that tells the truth."""

from __future__ import annotations

import re
from collections import Counter

import pytest

from cspdiag.base import Diagnostic
from cspdiag.base.manual import manual_page
from cspdiag.catalogue import kinds_of_diagnostics, manual_pages, reference
from cspdiag.proofs.answers.findings import diagnostics_of
from tests.diagnostics.samples import Sample
from tests.literate import CASES, MAIN, check_files, describe
from tests.verifying import answers_to

KINDS = kinds_of_diagnostics()
by_code = pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.code)


def test_codes_are_unique() -> None:
    assert [code for code, count in Counter(kind.code for kind in KINDS).items() if count > 1] == []


def test_the_page_is_read_from_the_docstring() -> None:
    page = manual_page(Sample)
    assert page.meaning == "Two ends of an arrow differ."
    assert page.reason == "A value would change its meaning on the way."
    assert page.refused == "process A {\n  in x : int\n}\n"
    assert page.mended == "process A {\n}\n"
    assert page.text.startswith("E0399: ends differ\n\nTwo ends")


@by_code
def test_a_page_is_whole(kind: type[Diagnostic]) -> None:
    page = manual_page(kind)
    assert re.fullmatch(r"[EW]\d{4}", page.code)
    assert page.code[0] == page.severity[0].upper()
    assert page.title
    assert page.meaning
    assert page.reason, f"{kind.__name__} says what it means but not why"
    assert page.refused
    assert page.mended


def found_in(program: str, kind: type[Diagnostic]) -> list[Diagnostic]:
    """What is wrong with a program, proofs included where the diagnostic is one of theirs."""
    found = check_files({MAIN: program}).report.diagnostics
    return found or (diagnostics_of(answers_to({MAIN: program}, MAIN)) if kind.code.startswith("E11") else [])


@by_code
def test_the_refused_program_is_refused_for_that_reason_only(kind: type[Diagnostic]) -> None:
    page = manual_page(kind)
    found = found_in(page.refused, kind)
    assert {diagnostic.code for diagnostic in found} == {kind.code}, describe(found)
    for diagnostic in found:
        assert diagnostic.message
        assert not diagnostic.message.endswith(".")


@by_code
def test_the_mended_program_is_clean(kind: type[Diagnostic]) -> None:
    found = found_in(manual_page(kind).mended, kind)
    assert found == [], describe(found)


@pytest.fixture(scope="module")
def literate_text() -> str:
    return "\n".join(path.read_text() for path in CASES.rglob("*.md"))


@by_code
def test_a_literate_case_shows_it(kind: type[Diagnostic], literate_text: str) -> None:
    assert f"[{kind.code}]" in literate_text


def test_the_reference_is_current() -> None:
    written = (CASES.parents[1] / "docs" / "diagnostics.md").read_text()
    assert written == reference(), "make docs writes it"


def test_the_reference_has_every_page() -> None:
    text = reference()
    assert [code for code in manual_pages() if f"### {code}: " not in text] == []
