"""Answers as a JUnit report: a test for each assertion."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from xml.etree import ElementTree

from cspdiag.base.render.junit import suite_of, written
from cspdiag.base.render.snippet import printable
from cspdiag.proofs.answers.answer import Answer
from cspdiag.proofs.answers.text import render as render_text


def render(answers: Sequence[Answer], file: str) -> str:
    """The report, with one test suite; a refuted assertion is a failure, one that is neither proved nor refuted an
    error.
    """
    root = ElementTree.Element("testsuites", name="cspdiag")
    outcomes = Counter(answer.outcome for answer in answers)
    seconds = sum(answer.seconds for answer in answers)
    refuted, unknown = outcomes["refuted"], outcomes["unknown"]
    suite = suite_of(root, file, tests=len(answers), failures=refuted, errors=unknown, time=f"{seconds:.3f}")
    for answer in answers:
        _test(suite, answer, file)
    return written(root)


def _test(suite: ElementTree.Element, answer: Answer, file: str) -> None:
    case = ElementTree.SubElement(
        suite,
        "testcase",
        name=f"assert {answer.question.text}",
        classname=printable(file),
        time=f"{answer.seconds:.3f}",
    )
    text = printable(render_text([answer], quiet=True))
    if answer.outcome == "proved":
        ElementTree.SubElement(case, "system-out").text = printable(answer.reason)
    else:
        tag = "failure" if answer.outcome == "refuted" else "error"
        found = ElementTree.SubElement(case, tag, message=answer.question.text, type=answer.outcome)
        found.text = text
