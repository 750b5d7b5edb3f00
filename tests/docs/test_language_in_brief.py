"""What docs/language-in-brief.md promises: at most 3,000 words, programs that compile, and the reference in brief."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from cspdiag import pipeline
from cspdiag.base import Diagnostic, Report, SourceFile
from cspdiag.syntax.format.formatter import format_tree
from cspdiag.syntax.parse.tables import load
from cspdiag.syntax.parser import parse

DOCS = Path(__file__).parents[2] / "docs"
PAGE = (DOCS / "language-in-brief.md").read_text(encoding="utf-8")
REFERENCE = (DOCS / "language.md").read_text(encoding="utf-8")
PROGRAMS = re.findall(r"^```csp\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)
HABITS = PAGE.partition("## What is often written wrongly\n")[2]
SURROUNDINGS = {
    "In a composition": """
        process A { composition { wait 1 ms } }
        process Main {
          in input : int
          communication { a : A  b : A  c : A  var v : int = 0  var done : bool = false }
          composition { $ }
        }""",
    "In a submodel": "submodel Law(n: int) { in x : double  out y : double  $ }",
    "Among ports": "process Main { $  composition { skip } }",
    "In `communication`": """
        process A { composition { wait 1 ms } }
        process Main { in input : int  communication { $ }  composition { skip } }""",
    "At the top": "$",
}
"""For each list of habits what is around its rows."""


def checked(text: str) -> list[Diagnostic]:
    def no_other_file(path: str) -> SourceFile:
        raise OSError(path)

    return pipeline.check(SourceFile(name="page.csp", text=text), no_other_file).report.diagnostics


def errors_in(text: str) -> list[str]:
    """The codes of errors, without those of instances that the row does not run."""
    codes = [diagnostic.code for diagnostic in checked(text) if diagnostic.severity == "error"]
    return [code for code in codes if code != "E0607"]


def habits() -> list[object]:
    """The rows of the lists of habits: where, what is wrong, what is right, and the code."""
    lists = re.findall(r"^([^\n]+):\n\n```text\n(.*?)^```$", HABITS, re.MULTILINE | re.DOTALL)
    assert [heading.rpartition(". ")[2] for heading, _ in lists] == list(SURROUNDINGS)
    return [
        pytest.param(surroundings, *re.split(r"  +", row), id=row.partition("  ")[0])
        for (_, rows), surroundings in zip(lists, SURROUNDINGS.values(), strict=True)
        for row in rows.splitlines()
    ]


def test_it_has_at_most_3000_words() -> None:
    assert len(PAGE.split()) <= 3000, "words as wc counts them, programs included"


@pytest.mark.parametrize("program", PROGRAMS, ids=[re.findall(r" (\w+)", text)[0] for text in PROGRAMS])
def test_its_programs_compile_and_are_in_the_standard_format(program: str) -> None:
    assert [f"{d.span.line}: {d.code} {d.message}" for d in checked(program)] == []
    assert format_tree(parse(SourceFile(name="page.csp", text=program), Report())) == program


@pytest.mark.parametrize(("surroundings", "wrong", "right", "code"), habits())
def test_what_is_wrong_is_refused_and_what_is_right_is_not(
    surroundings: str, wrong: str, right: str, code: str
) -> None:
    assert errors_in(surroundings.replace("$", wrong)) == [code]
    assert errors_in(surroundings.replace("$", right)) == []


def test_it_has_each_keyword_of_the_grammar() -> None:
    keywords = {word for word in load().words if word[0].isalpha()}
    assert keywords - set(re.findall(r"\w+", PAGE)) == set()


def test_each_section_names_the_section_of_the_reference_that_it_condenses() -> None:
    sections = re.findall(r"^## .+\n\n(.+)\n", PAGE, re.MULTILINE)
    condensed = [re.findall(r"\[([^\]]+)\]\(language\.md#[\w-]+\)", line) for line in sections]
    assert [] not in condensed
    assert {title for titles in condensed for title in titles} == set(re.findall(r"^## (.+)$", REFERENCE, re.MULTILINE))
