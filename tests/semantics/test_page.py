"""``docs/semantics.md``: every program of the page has the trace below it."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from cspdiag.base import Report, SourceFile
from cspdiag.syntax.format.formatter import format_tree
from cspdiag.syntax.parser import parse
from tests.conformance.sources import JUST_AFTER, network_of
from tests.conformance.targets import READABLE, REFERENCE, Target
from tests.conformance.test_worked_traces import trace_lines

PAGE = (Path(__file__).parents[2] / "docs" / "semantics.md").read_text(encoding="utf-8")
SECTIONS = [part.partition("\n") for part in PAGE.split("\n## ")[1:]]
WORKED = [
    pytest.param(match["program"], match["trace"].splitlines(), id=f"{title}-{number}")
    for title, _, text in SECTIONS
    for number, match in enumerate(
        re.finditer(r"^```csp\n(?P<program>.*?)^```\n\n```trace\n(?P<trace>.*?)^```$", text, re.MULTILINE | re.DOTALL)
    )
]


@pytest.mark.parametrize("target", [REFERENCE, READABLE], ids=["meaning", "readable code"])
@pytest.mark.parametrize(("program", "trace"), WORKED)
def test_program_has_the_trace_below_it(program: str, trace: list[str], target: Target) -> None:
    network = network_of(SourceFile(name="semantics.md", text=program))
    assert trace_lines(target.run(network, None, 100_000_000 + JUST_AFTER)) == trace


@pytest.mark.parametrize(("program", "trace"), WORKED)
def test_program_is_in_the_standard_format(program: str, trace: list[str]) -> None:
    assert format_tree(parse(SourceFile(name="semantics.md", text=program), Report())) == program


def test_every_rule_has_a_worked_trace() -> None:
    assert [title for title, _, text in SECTIONS if "```trace\n" not in text] == ["The state"]
    assert len(WORKED) == PAGE.count("```csp\n") == PAGE.count("```trace\n")
