"""What every text must get: diagnostics at places of the text, or code for every target, both within a time limit."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import NoReturn

from cspdiag import pipeline
from cspdiag.base import SourceFile
from cspdiag.base.diagnostic import Diagnostic
from cspdiag.base.render.text import render
from cspdiag.base.sources import read_source
from cspdiag.codegen.shared.target_error import TargetError
from cspdiag.network.ir.network import Network
from cspdiag.network.lower.program import SelectionError
from cspdiag.syntax.format.formatter import format_tree
from tests.support.alarm import alarm_after

PATIENCE = 120
"""Seconds of computing after which a text is taken to have no answer; the largest one needs about one second."""


class NoAnswerError(Exception):
    """A text kept the compiler busy for longer than any user waits."""


@contextmanager
def limited_computing() -> Iterator[None]:
    """Raise NoAnswerError if the block computes for longer than PATIENCE."""

    def give_up() -> NoReturn:
        raise NoAnswerError(f"no answer after {PATIENCE} s")

    with alarm_after(PATIENCE, give_up, computing=True):
        yield


def _assert_lies_in_text(found: Diagnostic) -> None:
    for span in (found.span, *(label.span for label in found.labels)):
        assert 0 <= span.start <= span.end <= len(span.source.text), found
    assert found.message
    assert "Traceback" not in found.message


def _generate(network: Network) -> None:
    """Generate code for every target and level; a refusal must be a diagnostic."""
    for target in ("python", "c"):
        for level in (0, 1):
            with suppress(TargetError, OSError):
                assert pipeline.generate(network, read_source, target, level)


def answer(name: str, text: str) -> pipeline.Checked:
    """Put a program through everything; raise if any pass raises, or if a diagnostic is outside the text."""
    with limited_computing():
        checked = pipeline.check(SourceFile(name=name, text=text), read_source)
        for found in checked.report.diagnostics:
            _assert_lies_in_text(found)
        assert render(checked.report.diagnostics) or not checked.report.diagnostics
        if checked.program is not None:
            format_tree(checked.program.main)
        try:
            network = pipeline.compile_network(checked)
        except SelectionError:
            return checked
        assert network is not None or checked.report.has_errors or checked.program is None
        if network is not None:
            _generate(network)
    return checked
