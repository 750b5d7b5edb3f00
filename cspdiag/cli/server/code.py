"""Whether the code that a server has loaded is still that on the disk."""

from __future__ import annotations

import os
import sys

from cspdiag.base.files.resources import grammar_file
from cspdiag.cli.server import place

_Facts = tuple[int, int, int]


class Code:
    """The files of the interpreter and of the package, as they were when this was made: before anything of them was
    loaded, as far as possible.
    """

    def __init__(self) -> None:
        self._facts = {path: _facts(path) for path in _files()}

    def keep_loaded_layers(self) -> None:
        """Forget the layers of which no module is loaded: a check never loads them."""
        loaded = {name.split(".")[1] for name in sys.modules if name.startswith("cspdiag.")}
        unused = {entry.name for entry in os.scandir(place.PACKAGE) if entry.is_dir()} - loaded - {"std"}
        folders = tuple(os.path.join(place.PACKAGE, name, "") for name in unused)
        self._facts = {path: facts for path, facts in self._facts.items() if not path.startswith(folders)}

    def has_changed(self) -> bool:
        """Whether any of the files has changed or has gone."""
        return any(_facts(path) != facts for path, facts in self._facts.items())


def _files() -> list[str]:
    """The interpreter, the grammar, all modules and bundled libraries of the package."""
    found = [sys.executable, grammar_file()]
    for folder, _, names in os.walk(place.PACKAGE):
        found += [os.path.join(folder, name) for name in names if name.endswith((".py", ".csp"))]
    return found


def _facts(path: str) -> _Facts | None:
    try:
        facts = os.stat(path)
    except OSError:
        return None
    return facts.st_mtime_ns, facts.st_size, facts.st_ino
