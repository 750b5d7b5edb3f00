"""What the C kernel has no numbers for is refused, at its place."""

from __future__ import annotations

import pytest

from cspdiag import pipeline
from cspdiag.base.sources import read_source
from cspdiag.base.span import SourceFile
from cspdiag.codegen.c.process import writer
from cspdiag.codegen.c.process.steps import alternatives
from cspdiag.codegen.shared.target_error import TargetError

CHOICE = """process Main {
  in a[9] : int
  communication { var v : int }
  composition {
    mu (alt i < 9 : a[i] ? v -> skip)
  }
}
"""


def generate() -> None:
    network = pipeline.build(SourceFile(name="case.csp", text=CHOICE), read_source).network
    assert network is not None
    pipeline.generate(network, read_source, "c")


def test_as_many_as_there_are_numbers(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(alternatives, "MOST_GUARDS", 9)
    generate()


def test_too_many_guards(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(alternatives, "MOST_GUARDS", 8)
    with pytest.raises(TargetError, match=r"case\.csp:5.*: an alternative of 9 guards"):
        generate()


def test_too_many_places(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(writer, "MOST_PLACES", 0)
    with pytest.raises(TargetError, match=r"case\.csp:5.*: the process waits at more than 0 places"):
        generate()
