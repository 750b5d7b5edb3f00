"""``docs/timing.md`` shows what the tool prints."""

from __future__ import annotations

import re
from pathlib import Path

from cspdiag.analyses.timing.report.gantt import gantt_svg
from cspdiag.analyses.timing.report.render_text import table
from cspdiag.base import Report, SourceFile
from cspdiag.syntax.format.formatter import format_tree
from cspdiag.syntax.parser import parse
from tests.analyses.timing.programs import report_of

DOCS = Path(__file__).parents[4] / "docs"
PAGE = (DOCS / "timing.md").read_text(encoding="utf-8")


def block(kind: str) -> str:
    found = re.search(rf"^```{kind}\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)
    assert found is not None
    return found[1]


def test_the_table_is_that_of_the_program() -> None:
    assert block("text") == table(report_of(block("csp")))


def test_the_picture_is_that_of_the_program() -> None:
    assert (DOCS / "images" / "gantt.svg").read_text(encoding="utf-8") == gantt_svg(report_of(block("csp")))


def test_the_program_is_in_the_standard_format() -> None:
    assert format_tree(parse(SourceFile(name="timing.md", text=block("csp")), Report())) == block("csp")
