"""Finds the programs in the folders of the editor that import a file."""

from __future__ import annotations

import os
import posixpath
import re
from collections.abc import Iterator, Sequence

from cspdiag.lsp.documents import Documents, identity

MAX_FILES = 2000
"""The largest number of files that are read to find programs."""
_SKIPPED = {"node_modules", "__pycache__", "build", "dist"}
_IMPORT = re.compile(r'^[ \t]*import[ \t]+"([^"\n]*)"', re.MULTILINE)


def importers(file: str, folders: Sequence[str], documents: Documents) -> list[str]:
    """The names of the files in folders whose programs contain a file, given by its identity; that one included."""
    imported: dict[str, set[str]] = {}
    names: dict[str, str] = {}
    for name in programs(folders):
        names[identity(name)] = name
        imported[identity(name)] = set(_imports(name, documents))
    found = {file}
    size = 0
    while len(found) > size:
        size = len(found)
        found |= {importer for importer, targets in imported.items() if not targets.isdisjoint(found)}
    return [names[each] for each in names if each in found]


def _imports(name: str, documents: Documents) -> Iterator[str]:
    try:
        text = documents.read(name).text
    except (OSError, ValueError):
        return
    for path in _IMPORT.findall(text):
        yield identity(posixpath.join(posixpath.dirname(name), path))


def programs(folders: Sequence[str]) -> Iterator[str]:
    """The names of the programs in folders."""
    count = 0
    for folder in folders:
        for place, inside, files in os.walk(folder):
            inside[:] = sorted(name for name in inside if not name.startswith(".") and name not in _SKIPPED)
            for file in sorted(files):
                if file.endswith(".csp"):
                    count += 1
                    if count > MAX_FILES:
                        return
                    yield os.path.join(place, file).replace(os.sep, "/")
