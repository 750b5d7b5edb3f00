"""Runs texts through the passes up to the network, for the tests of this folder."""

from __future__ import annotations

from collections.abc import Mapping

from cspdiag import pipeline
from cspdiag.base import Report, SourceFile
from cspdiag.model.program import Program, Value
from cspdiag.network.analyse import Analysis
from cspdiag.network.ir.network import Network, ProcessClass
from cspdiag.network.lower.program import lower
from cspdiag.network.shapes import Shape
from tests.literate import MAIN, check_files, describe


def checked(text: str) -> Program:
    """The program of a text without errors."""
    found = check_files({MAIN: text})
    assert found.program is not None, describe(found.report.diagnostics)
    assert not found.report.has_errors, describe(found.report.diagnostics)
    return found.program


def network(text: str, overrides: Mapping[str, Value] | None = None, **selection: str) -> Network:
    """The network of a text."""
    report = Report()
    found = lower(checked(text), selection.get("top"), selection.get("environment"), overrides or {}, report)
    assert found is not None, describe(report.diagnostics)
    return found


def process(found: Network, name: str) -> ProcessClass:
    """A process class by name."""
    entry = found.class_named(name)
    assert isinstance(entry, ProcessClass)
    return entry


def shape_of(text: str, top: str = "Main") -> tuple[Shape, Analysis]:
    """The shape of a process, after all passes; their diagnostics are ignored."""

    def read(path: str) -> SourceFile:
        raise FileNotFoundError(path)

    found = pipeline.check(SourceFile(name=MAIN, text=text), read)
    assert found.program is not None, describe(found.report.diagnostics)
    analysis = Analysis(found.program, Report())
    definition = next(d for d in analysis.definitions.order if d.name.text == top)
    shape = analysis.add_root(definition, (), {}, {})
    analysis.run()
    return shape, analysis
