"""Whatever is done to a good program, the answer is a list of diagnostics or a package, never a traceback."""

from __future__ import annotations

from pathlib import Path

from hypothesis import given, settings
from hypothesis import strategies as st

from cspdiag import pipeline
from cspdiag.diagnostics import SourceFile
from cspdiag.diagnostics.render_text import render
from cspdiag.network.lower import SelectionError
from cspdiag.sources import read_source
from cspdiag.syntax.formatter import format_tree
from tests.robustness.damage import damaged


def answer(name: str, text: str) -> pipeline.Checked:
    """Put a program through everything; raise where any pass raises."""
    checked = pipeline.check(SourceFile(name=name, text=text), read_source)
    assert render(checked.report.diagnostics) or not checked.report.diagnostics
    if checked.program is not None:
        format_tree(checked.program.main)
    try:
        network = pipeline.compile_network(checked)
    except SelectionError:
        return checked
    if network is None:
        assert checked.report.has_errors or checked.program is None
    else:
        assert pipeline.generate(network, read_source)
    return checked


@settings(max_examples=600)
@given(damaged())
def test_a_damaged_program_gets_an_answer(program: tuple[Path, str]) -> None:
    path, text = program
    answer(str(path), text)


@settings(max_examples=100)
@given(st.text(st.characters(codec="utf-8"), max_size=200))
def test_any_text_gets_an_answer(text: str) -> None:
    answer("any.csp", text)
