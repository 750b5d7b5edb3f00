"""The structure of a file: what remains when the text in its comments, docstrings and strings is removed."""

from __future__ import annotations

import ast
import re
import tomllib
import xml.etree.ElementTree as ElementTree
from html.parser import HTMLParser


def skeleton(path: str, text: str) -> object:
    """Equal for two files that differ only in comments and strings."""
    suffix = path.rpartition(".")[2]
    readers = {"py": _python, "c": _c, "h": _c, "pml": _c, "csp": _cspm, "toml": _toml, "svg": svg, "html": html}
    return readers.get(suffix, len)(text) if suffix in readers else None


def docstrings(text: str) -> list[str]:
    """All docstrings of a Python module."""
    tree = ast.parse(text)
    owners = (node for node in ast.walk(tree) if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef))
    return [found for owner in owners if (found := ast.get_docstring(owner)) is not None]


def _python(text: str) -> str:
    tree = ast.parse(text)
    compile(text, "generated", "exec")
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            node.value = ""
    return ast.dump(tree)


_C_TOKEN = re.compile(r'/\*.*?\*/|//[^\n]*|"(?:\\.|[^"\\\n])*"|[A-Za-z_]\w*|[\w.]+|\S', re.DOTALL)


def _c(text: str) -> list[str]:
    """The tokens; trigraphs and continued lines are resolved first, as a compiler does, so they hide nothing."""
    for written, meant in {"??/": "\\", "??'": "^", "??(": "[", "??)": "]", "??!": "|", "??<": "{", "??>": "}"}.items():
        text = text.replace(written, meant)
    tokens = _C_TOKEN.findall(text.replace("\\\n", ""))
    return ['""' if token[0] == '"' else token for token in tokens if not token.startswith(("/*", "//"))]


def _cspm(text: str) -> list[str]:
    return [row.partition("--")[0] for row in text.split("\n")]


def _toml(text: str) -> object:
    found = tomllib.loads(text)
    found["project"]["description"] = ""
    return found


def svg(text: str) -> list[str]:
    """The elements in order."""
    return [element.tag for element in ElementTree.fromstring(text).iter()]


class _Tags(HTMLParser):
    def __init__(self) -> None:
        super().__init__()
        self.tags: list[tuple[str, tuple[str, ...]]] = []

    def handle_starttag(self, tag: str, attributes: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, tuple(name for name, _ in attributes)))


def html(text: str) -> set[tuple[str, tuple[str, ...]]]:
    """The kinds of elements with their attributes."""
    parser = _Tags()
    parser.feed(text)
    return set(parser.tags)
