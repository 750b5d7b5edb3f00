"""Trees that are kept in the user's cache from one command to the next.

For each file there is the tree of its last text. It is used only if the file still has this text, under this name, and
if the code that makes trees is the same.
"""

from __future__ import annotations

import os
import sys
from functools import cache
from typing import TYPE_CHECKING
from zlib import crc32

from cspdiag import __version__
from cspdiag.base.files import resources
from cspdiag.base.files.caches import cache_folder, store
from cspdiag.base.report import Report
from cspdiag.base.sources import STANDARD_INPUT
from cspdiag.base.span import SourceFile
from cspdiag.syntax.on_demand import parsed

if TYPE_CHECKING:
    from cspdiag.syntax.ast import SourceTree

MOST_FILES = 400
"""When there are more, half of them are removed, those that were written first."""
_LONGEST = 200_000
"""Characters of a text whose tree is kept."""
_SUFFIX = f".{sys.implementation.cache_tag}.tree"
_MADE_BY = ("ast", "build", "parse", "parser.py", "kept.py", "../base/record.py", "../base/span.py")
"""The code on which a tree and its stored form depend, relative to this folder."""


def parse(source: SourceFile, report: Report) -> SourceTree:
    """The tree of a file, as from ``cspdiag.syntax.parser.parse``."""
    path = _path(source)
    if path is None:
        return parsed(source, report)
    seal = _seal(source)
    tree = _read(path, seal, source)
    if tree is not None:
        return tree
    mistakes = Report()
    tree = parsed(source, mistakes)
    for mistake in mistakes.diagnostics:
        report.add(mistake)
    if not mistakes.diagnostics:
        _write(path, seal, tree)
    return tree


def _path(source: SourceFile) -> str | None:
    """Where the tree of a file is kept; None if it is not."""
    if source.name == STANDARD_INPUT or len(source.text) > _LONGEST:
        return None
    key = f"{os.path.abspath(source.name)}\0{source.name}"
    try:
        folder = os.path.join(cache_folder(), "trees")
        os.makedirs(folder, mode=0o700, exist_ok=True)
    except OSError:
        return None
    return os.path.join(folder, f"{_sum(key):08x}{_SUFFIX}")


def _seal(source: SourceFile) -> bytes:
    """What a kept tree begins with. Another text may have the same, so the texts are compared besides."""
    return f"{__version__} {_code():08x} {_sum(source.text):08x}\n".encode()


def _sum(text: str) -> int:
    return crc32(text.encode(errors="surrogatepass"))


@cache
def _code() -> int:
    """A number that differs if the code that makes trees does."""
    here = os.path.dirname(__file__)
    facts = []
    for path in (*(os.path.join(here, name) for name in _MADE_BY), resources.grammar_file()):
        inside = sorted(os.listdir(path)) if os.path.isdir(path) else [""]
        for name in inside:
            if name.endswith(".py") or not name:
                file = os.stat(os.path.join(path, name) if name else path)
                facts.append((name, file.st_mtime_ns, file.st_size))
    return _sum(repr(facts))


def _read(path: str, seal: bytes, source: SourceFile) -> SourceTree | None:
    try:
        with open(path, "rb") as file:
            if file.read(len(seal)) != seal:
                return None
            check, data = file.read(4), file.read()
        if int.from_bytes(check, "big") != crc32(data):
            return None
        from _pickle import loads

        tree: SourceTree = loads(data)
        return tree if (tree.source.name, tree.source.text) == (source.name, source.text) else None
    except Exception:
        # Whatever is wrong with it, the text is there.
        return None


def _write(path: str, seal: bytes, tree: SourceTree) -> None:
    """Keep a tree; one that cannot be kept is made again next time."""
    try:
        from _pickle import dumps

        data = dumps(tree, 5)
        store(path, seal + crc32(data).to_bytes(4, "big") + data)
        _make_room(os.path.dirname(path))
    except (OSError, RecursionError, ImportError):
        return


def _make_room(folder: str) -> None:
    names = os.listdir(folder)
    if len(names) <= MOST_FILES:
        return
    paths = [os.path.join(folder, name) for name in names]
    for path in sorted(paths, key=lambda path: os.stat(path).st_mtime_ns)[: len(paths) // 2]:
        os.unlink(path)
