"""The interpreter names, for everything it does, where the language reference states it, and these places exist."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
MODULES = sorted((ROOT / "cspdiag" / "semantics").rglob("[!_]*.py"))
PAGE = (ROOT / "docs" / "language.md").read_text(encoding="utf-8")
PLACES = {
    *re.findall(r"^#+ (.*)$", PAGE, re.MULTILINE),
    *re.findall(r"^- \*\*([^*]+)\.\*\*", PAGE, re.MULTILINE),
}


def sections(node: ast.ClassDef | ast.FunctionDef) -> set[str]:
    """The references in the docstring of a class or function."""
    return set(re.findall("«([^»]+)»", " ".join((ast.get_docstring(node) or "").split())))


def definitions(path: Path) -> Iterator[tuple[str, set[str]]]:
    """The classes and functions of a module with the places that they name; a method also has those of its class."""
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.ClassDef | ast.FunctionDef):
            yield node.name, sections(node)
            for inner in node.body if isinstance(node, ast.ClassDef) else ():
                if isinstance(inner, ast.FunctionDef):
                    yield inner.name, sections(inner) | sections(node)


@pytest.mark.parametrize("path", MODULES, ids=lambda path: path.stem)
def test_every_definition_names_a_place_of_the_reference(path: Path) -> None:
    found = list(definitions(path))
    assert found
    assert [name for name, places in found if not name.startswith("_") and not places] == []
    assert {place for _, places in found for place in places} <= PLACES
