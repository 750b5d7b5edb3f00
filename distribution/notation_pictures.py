"""Draws the pictures of docs/notation.md from the compositions above them; ``--check`` only reports which are out of
date.

python distribution/notation_pictures.py [--check]
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from cspdiag.base import Report, SourceFile
from cspdiag.draw.composition.diagram import draw_composition
from cspdiag.draw.elements.composition import CompositionDiagram
from cspdiag.draw.elements.read_composition import composition_diagram
from cspdiag.draw.hiding import hidden
from cspdiag.draw.output.svg import render_svg
from cspdiag.syntax import ast
from cspdiag.syntax.parser import parse

DOCS = Path(__file__).parent.parent / "docs"
PAGE = DOCS / "notation.md"
_PROGRAM = re.compile(r"^```csp\n(?P<text>.*?)^```$", re.MULTILINE | re.DOTALL)
_EXAMPLE = re.compile(
    r"^```composition(?P<inside> inside)?\n(?P<text>.*?)^```\n\n!\[[^\]]+\]\((?P<picture>[\w/]+\.svg)\)$",
    re.MULTILINE | re.DOTALL,
)
_DEFINITIONS = """
submodel Law { in x : double out y : double y = x }
process Mode { in angle : double out voltage : double
  communication { var x : double = 0 }
  composition { mu (angle ? x ; voltage ! x) }
}
"""


@dataclass(frozen=True)
class Example:
    """A composition, and how many of its levels are drawn."""

    text: str
    depth: int


def examples(page: str) -> dict[str, Example]:
    """The compositions of the page by the path of their picture, relative to the page."""
    return {match["picture"]: Example(match["text"], 2 if match["inside"] else 1) for match in _EXAMPLE.finditer(page)}


def example_diagram(page: str, example: Example) -> CompositionDiagram:
    """The diagram of a composition of the page's process. Raises ValueError if it cannot be read."""
    match = _PROGRAM.search(page)
    assert match is not None
    text = _DEFINITIONS + match["text"].replace("composition { skip }", f"composition {{ {example.text} }}")
    report = Report()
    tree = parse(SourceFile(name="notation.md", text=text), report)
    if tree is None or report.diagnostics:
        raise ValueError(f"cannot read `{example.text.strip()}`: {[each.message for each in report.diagnostics]}")
    definitions = {item.name.text: item for item in tree.items if not isinstance(item, ast.Import | ast.Assertion)}
    process = definitions["Joint"]
    assert isinstance(process, ast.ProcessDefinition)
    return composition_diagram(definitions, process, example.depth)


def pictures() -> Iterator[tuple[Path, str]]:
    """The path and the text of each picture."""
    page = PAGE.read_text(encoding="utf-8")
    for path, example in examples(page).items():
        yield (
            DOCS / path,
            render_svg(draw_composition(example_diagram(page, example), is_headed=False, hidden=hidden(["legend"]))),
        )


def main(arguments: list[str]) -> int:
    """Write the pictures, or check them; returns 1 if one is out of date."""
    stale = [(path, text) for path, text in pictures() if not path.exists() or path.read_text(encoding="utf-8") != text]
    for path, text in stale:
        print(path.relative_to(DOCS.parent))
        if "--check" not in arguments:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
    return int(bool(stale) and "--check" in arguments)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
