"""Diagnostics as a JUnit report: a test suite for each file, a failed test for each error."""

from __future__ import annotations

from collections.abc import Sequence
from xml.etree import ElementTree

from cspdiag.base.diagnostic import Diagnostic
from cspdiag.base.render.snippet import printable


def render(diagnostics: Sequence[Diagnostic], files: Sequence[str]) -> str:
    """The report on ``files`` and what they import; a file without diagnostics is a test that passed.

    A warning is a test that passed, with its text as output.
    """
    found: dict[str, list[Diagnostic]] = {name: [] for name in files}
    for diagnostic in diagnostics:
        found.setdefault(diagnostic.span.file, []).append(diagnostic)
    root = ElementTree.Element("testsuites", name="cspdiag")
    for name, own in found.items():
        failures = sum(diagnostic.severity == "error" for diagnostic in own)
        suite = suite_of(root, name, tests=max(len(own), 1), failures=failures)
        for diagnostic in own:
            _test(suite, diagnostic)
        if not own:
            ElementTree.SubElement(suite, "testcase", name="check", classname=printable(name), time="0")
    return written(root)


def suite_of(
    root: ElementTree.Element, name: str, *, tests: int, failures: int, errors: int = 0, time: str = "0"
) -> ElementTree.Element:
    """A new test suite with its numbers of tests; ``time`` is in seconds."""
    counts = {"tests": str(tests), "failures": str(failures), "errors": str(errors), "skipped": "0", "time": time}
    return ElementTree.SubElement(root, "testsuite", {"name": printable(name), **counts})


def written(root: ElementTree.Element) -> str:
    """The text of a report."""
    ElementTree.indent(root)
    return f"<?xml version='1.0' encoding='utf-8'?>\n{ElementTree.tostring(root, encoding='unicode')}\n"


def _test(suite: ElementTree.Element, diagnostic: Diagnostic) -> None:
    span = diagnostic.span
    name = f"{diagnostic.code} at {span.line}:{span.column}"
    case = ElementTree.SubElement(suite, "testcase", name=name, classname=printable(span.file), time="0")
    words = diagnostic.words
    message = printable(words.message)
    text = f"{printable(span.file)}:{span.line}:{span.column}: {message}"
    if words.help:
        text += f"\nhelp: {printable(words.help)}"
    if diagnostic.severity == "error":
        failure = ElementTree.SubElement(case, "failure", message=message, type=diagnostic.code)
        failure.text = text
    else:
        ElementTree.SubElement(case, "system-out").text = text
