"""Every kind of diagnostic has a manual page, and its programs do what it says."""

from __future__ import annotations

import re
from collections import Counter
from contextlib import nullcontext
from pathlib import Path

import pytest

from cspdiag.base import Diagnostic
from cspdiag.base.files import resources
from cspdiag.base.manual import FAMILIES, manual_page, manual_pages, read_page, reference
from cspdiag.network.diagnostics.operators import NotDiscretized
from cspdiag.network.diagnostics.precision import ChangedArgument, NotInSinglePrecision, RoundedWhole
from cspdiag.proofs.answers.findings import diagnostics_of
from tests.docs.kinds_of_diagnostics import kinds_of_diagnostics
from tests.literate import CASES, MAIN, check_files, describe
from tests.support.lacking import without_numpy
from tests.support.verifying import RefusedError, answers_to

KINDS = kinds_of_diagnostics()
MANUAL = Path(resources.manual_page_file())
OF_SINGLE_PRECISION = (ChangedArgument, NotInSinglePrecision, RoundedWhole)
"""Those that need ``--real float32``."""
WITHOUT_NUMPY = (NotDiscretized,)
"""Those of a browser."""
by_code = pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.code)


def test_codes_are_unique() -> None:
    assert [code for code, count in Counter(kind.code for kind in KINDS).items() if count > 1] == []


PAGE = """# E0316: ends differ

Two ends of an arrow differ.

A value would change its meaning on the way.

Refused:

```csp
process A {
  in x : int
}
```

Fixed:

```csp
process A {
}
```
"""


def test_a_page_is_read_from_markdown() -> None:
    page = read_page(PAGE)
    assert page.meaning == "Two ends of an arrow differ."
    assert page.reason == "A value would change its meaning on the way."
    assert page.refused == "process A {\n  in x : int\n}\n"
    assert page.fixed == "process A {\n}\n"
    assert page.text.startswith("E0316: ends differ\n\nTwo ends")
    assert f"# {page.code}: {page.title}\n\n{page.markdown}" == PAGE


@pytest.mark.parametrize("lost", ["# ", "\n\nA value", "Refused:", "```csp", "Fixed:", ": ends differ"])
def test_a_page_of_another_form_is_refused(lost: str) -> None:
    with pytest.raises(ValueError, match="not a manual page"):
        read_page(PAGE.replace(lost, ""))


def test_each_page_is_in_its_family_and_belongs_to_a_kind() -> None:
    found = {path.relative_to(MANUAL).as_posix() for path in MANUAL.rglob("*") if path.is_file()}
    family = {folder[:2]: folder for folder in FAMILIES}
    assert found == {f"{family[kind.code[1:3]]}/{kind.code}.md" for kind in KINDS}


@pytest.mark.parametrize("code", ["E0199", "E9901", "E", "", "../E0101"])
def test_a_code_without_a_page_does_not_exist(code: str) -> None:
    with pytest.raises(KeyError):
        manual_page(code)


@by_code
def test_a_page_is_whole(kind: type[Diagnostic]) -> None:
    page = manual_page(kind.code)
    assert re.fullmatch(r"[EW]\d{4}", kind.code)
    assert kind.code[0] == kind.severity[0].upper()
    assert (page.code, page.title) == (kind.code, kind.title)
    for part in (page.title, page.meaning, page.reason, page.refused, page.fixed):
        assert part.strip()


def found_in(program: str, kind: type[Diagnostic]) -> list[Diagnostic]:
    """What is wrong with a program, including proofs if the diagnostic is one of theirs."""
    with without_numpy() if kind in WITHOUT_NUMPY else nullcontext():
        found = check_files({MAIN: program}, "float32" if kind in OF_SINGLE_PRECISION else "double").report.diagnostics
    if found or not kind.code.startswith("E11"):
        return list(found)
    try:
        return diagnostics_of(answers_to({MAIN: program}, MAIN))
    except RefusedError as problem:
        return list(problem.found)


@by_code
def test_the_refused_program_is_refused_for_that_reason_only(kind: type[Diagnostic]) -> None:
    page = manual_page(kind.code)
    found = found_in(page.refused, kind)
    assert {diagnostic.code for diagnostic in found} == {kind.code}, describe(found)
    for diagnostic in found:
        assert diagnostic.message
        assert not diagnostic.message.endswith(".")


@by_code
def test_the_fixed_program_is_clean(kind: type[Diagnostic]) -> None:
    found = found_in(manual_page(kind.code).fixed, kind)
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
