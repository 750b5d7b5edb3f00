"""A text that is parsed again after a change has the tree and the mistakes that it has when it is parsed at once.

``python -m tests.syntax.test_incremental SECONDS SEED`` looks for differences for longer.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path
from random import Random

import pytest

from cspdiag.base import Diagnostic, Report, SourceFile, Span
from cspdiag.base.record import field_names, is_record
from cspdiag.syntax import parser
from cspdiag.syntax.incremental import Parsed, parse_again
from tests.syntax.edits import versions

ROOT = Path(__file__).parents[2]
FILES = sorted([*ROOT.glob("models/*/*.csp"), *ROOT.glob("cspdiag/std/*.csp")])
NAME = "changed.csp"
TWO = "const first = 1\n\n/// The second.\nconst second = 2 // twice\n"


def written(item: object, source: SourceFile) -> object:
    """Everything in a tree as values, with the places."""
    if isinstance(item, Span):
        assert item.source is source
        return item.start, item.end
    if isinstance(item, tuple):
        return [written(each, source) for each in item]
    if is_record(item) and not isinstance(item, SourceFile):
        return type(item), [written(getattr(item, name), source) for name in field_names(item)]
    return item


def shown(mistakes: list[Diagnostic]) -> list[object]:
    """Everything that diagnostics say, with the places."""
    return [
        (
            *(each.code, each.severity, each.span.file, each.span.start, each.span.end),
            *(each.message, each.label, each.help),
            [(label.span.file, label.span.start, label.span.end, label.message) for label in each.all_labels],
            [(edit.span.file, edit.span.start, edit.span.end, edit.replacement) for edit in each.edits],
        )
        for each in mistakes
    ]


def after(text: str, known: Parsed | None) -> Parsed:
    """The text parsed again, compared with what it is when it is parsed at once."""
    again = parse_again(SourceFile(name=NAME, text=text), known)
    source, report = again.source, Report()
    tree = parser.parse(source, report)
    assert shown(again.mistakes) == shown(report.diagnostics), text
    assert again.tree.source is source
    assert written(again.tree, source) == written(tree, source), text
    return again


def some_lines(random: Random) -> str:
    """Consecutive lines of a program."""
    lines = random.choice(FILES).read_text(encoding="utf-8").splitlines(keepends=True)
    start = random.randrange(len(lines))
    return "".join(lines[start : start + random.randint(5, 40)])


def compare(seed: int) -> None:
    """Change a text often, and compare each of its versions."""
    random = Random(seed)
    known: Parsed | None = None
    for text in versions(random, some_lines(random), 60):
        known = after(text, known)


@pytest.mark.parametrize("first", range(0, 40, 10))
def test_thousands_of_random_changes(first: int) -> None:
    for seed in range(first, first + 10):
        compare(seed)


def test_a_whole_program_while_it_is_changed() -> None:
    random = Random(1)
    known: Parsed | None = None
    for text in versions(random, (ROOT / "models/jiwy/jiwy.csp").read_text(encoding="utf-8"), 30):
        known = after(text, known)


def test_definitions_that_did_not_change_keep_their_nodes() -> None:
    known = after(TWO, None)
    first, second = known.tree.items
    changed = after(TWO.replace("= 1", "= 100"), known)
    assert changed.tree.items[0] is not first
    assert changed.tree.items[1] is second
    assert second.span.text == "const second = 2"
    assert after(TWO, changed).tree.items[1] is second


@pytest.mark.parametrize(
    ("before", "then"),
    [
        pytest.param(TWO, TWO.replace("The second", "Another"), id="its doc comment"),
        pytest.param(TWO, TWO.replace("The", "Any"), id="its doc comment, of the same length"),
        pytest.param(TWO, "/* " + TWO, id="a comment that is opened before it"),
        pytest.param("/* " + TWO, TWO, id="and closed again"),
        pytest.param(TWO, TWO + "* 3", id="an expression that continues at the end of the text"),
        pytest.param("const a = 5\nparameter b = 1\n", "const a = 5\nparameters\n", id="the word after it"),
        pytest.param("const a = at\nconst b = 1", "const a = at\n+ 1", id="what is after a word with two meanings"),
        pytest.param("const a = 5 \nmsx", "const a = 5 \tms\n", id="a unit on the next line"),
        pytest.param("const a = 1\nconst b = 2", "const a = 1\n}\nconst b = 2", id="a brace too many"),
        pytest.param("process P {\n}\nconst b = 2\n", "process P {\n\nconst b = 2\n", id="a brace too few"),
        pytest.param(
            "const a = 1\n\u20ac\nconst b = 2", "const a = 1\n\u20ac\u20ac\nconst b = 2", id="unknown characters"
        ),
        pytest.param("\u00e4 = 1\nconst a = 1", "\u00e4 = 1\nconst \u00e4 = 1", id="a name that is reported once"),
        pytest.param(TWO, TWO.replace("\n", "\r\n"), id="other ends of lines"),
        pytest.param(TWO, "", id="nothing is left"),
        pytest.param(TWO, TWO + TWO, id="it is there twice"),
    ],
)
def test_what_a_definition_depends_on(before: str, then: str) -> None:
    known = after(before, None)
    for text in (then, before, then):
        known = after(text, known)


if __name__ == "__main__":
    end, next_seed = time.monotonic() + float(sys.argv[1]), int(sys.argv[2])
    while time.monotonic() < end:
        compare(next_seed)
        next_seed += 1
    print(f"no difference up to seed {next_seed}")
