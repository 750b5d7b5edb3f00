"""The formatter keeps meaning and comments, and a second pass changes nothing."""

from __future__ import annotations

from pathlib import Path
from random import Random

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from cspdiag.base import Report, SourceFile
from cspdiag.syntax import ast
from cspdiag.syntax.format.formatter import format_tree
from cspdiag.syntax.parser import parse
from tests.syntax.generate import program, sprinkled, text_of

RELAXED = settings(max_examples=150, deadline=None, suppress_health_check=list(HealthCheck))


def parsed(text: str) -> ast.SourceTree:
    report = Report()
    tree = parse(SourceFile(name="case.csp", text=text), report)
    assert not report.diagnostics, [f"{d.span} {d.message}" for d in report.diagnostics] + [text]
    return tree


def formatted(text: str) -> str:
    return format_tree(parsed(text))


def assert_kept(text: str) -> None:
    before = parsed(text)
    once = format_tree(before)
    after = parsed(once)
    assert ast.same_tree(before, after), once
    assert [c.text.replace("\r\n", "\n") for c in before.comments] == [c.text for c in after.comments]
    assert format_tree(after) == once
    assert "\n\n\n" not in once
    assert not any(line != line.rstrip() for line in once.split("\n") if "*" not in line)


@RELAXED
@given(st.integers(0, 2**40).map(Random))
def test_random_programs_keep_their_meaning(random: Random) -> None:
    assert_kept(text_of(program(random)))


@RELAXED
@given(st.integers(0, 2**40).map(Random))
def test_comments_anywhere_are_kept(random: Random) -> None:
    assert_kept(sprinkled(program(random, definitions=2), random))


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", ""),
        ("// only a comment", "// only a comment\n"),
        ("\n\n// a\n\n\n\n// b\n\nconst A=1// c\n", "// a\n\n// b\n\nconst A = 1 // c\n"),
        ("const A=1 ms const B=2us", "const A = 1 ms\nconst B = 2 us\n"),
        ("enum M {\n a, b }", "enum M {\n  a,\n  b\n}\n"),
        ("enum M { a,b }", "enum M { a, b }\n"),
        (
            "process P{in a:int out bb:double<rad>@T// tick\n\n out c:int}",
            "process P {\n  in  a  : int\n  out bb : double<rad> @ T // tick\n\n  out c : int\n}\n",
        ),
        (
            "process P{composition{a;b\n;c}}",
            "process P {\n  composition {\n    a ; b ; c\n  }\n}\n",
        ),
        (
            "process P{composition{a;\nb||c}}".replace("b||c", "(b||c)"),
            "process P {\n  composition {\n    a ;\n    (b || c)\n  }\n}\n",
        ),
        (
            "process P {\n  communication {\n\n    // first\n    a -> b // second\n    // last\n  }\n}\n",
            "process P {\n  communication {\n    // first\n    a -> b // second\n    // last\n  }\n}\n",
        ),
    ],
)
def test_layout(text: str, expected: str) -> None:
    assert formatted(text) == expected


def test_lines_that_are_too_long_are_broken() -> None:
    sources = ", ".join(f"producer{number}.output" for number in range(8))
    text = formatted(f"process P {{ communication {{ {sources} -> any -> consumer.input, recorder.input }} }}")
    assert max(map(len, text.splitlines())) <= 120
    assert text.count("producer") == 8


def test_doc_comments_stay_with_their_definition() -> None:
    text = "/// what it is\n/// and does\nprocess P {\n  /// the angle\n  in x : int\n}\n"
    assert formatted(text) == text


ROOT = Path(__file__).parents[2]
PROGRAMS = sorted([*ROOT.glob("models/*/*.csp"), *ROOT.glob("cspdiag/std/*.csp")])


@pytest.mark.parametrize("path", PROGRAMS, ids=lambda path: str(path.relative_to(ROOT)))
def test_models_and_library_keep_their_meaning(path: Path) -> None:
    assert_kept(path.read_text(encoding="utf-8"))
