"""Remembers results of proofs, so a program that has not changed costs nothing.

An entry has the output, and the digest of every file that was read for it, and of the bodies that these name. The
version of cspdiag, and the installed files themselves, are part of the key.
"""

from __future__ import annotations

import json
from collections.abc import Iterable
from contextlib import suppress
from hashlib import sha256
from pathlib import Path

from cspdiag import __version__
from cspdiag.base.files.caches import cache_folder, store
from cspdiag.base.files.content import digest_of_file
from cspdiag.base.files.json_text import read_json
from cspdiag.base.record import record
from cspdiag.base.sources import read_source
from cspdiag.base.span import SourceFile


@record
class Printed:
    """The output of a run of ``verify``, its exit code, and the answers as data."""

    code: int
    stdout: str
    stderr: str
    json: str


class Cache:
    """The output of ``verify`` for a file with certain options; entries that cannot be read or written are ignored."""

    def __init__(self, options: str) -> None:
        self._name = f"{sha256(f'{_installed()} {options}'.encode()).hexdigest()}.json"
        self._read: dict[str, str] = {}
        self._bodies: dict[str, str | None] = {}

    def read(self, path: str) -> SourceFile:
        """Read a source file, and remember that the result depends on it. Raises as ``read_source`` does."""
        source = read_source(path)
        self._read[path] = _digest(source.text)
        return source

    def note(self, bodies: Iterable[str]) -> None:
        """Remember that the result depends on files with bodies, such as FMUs."""
        self._bodies.update({path: digest_of_file(path) for path in bodies})

    def find(self) -> Printed | None:
        """The output for the same files, if there is one."""
        try:
            entry = read_json(self._path().read_text(encoding="utf-8"))
            unchanged = all(_digest(read_source(path).text) == digest for path, digest in entry["files"].items())
            unchanged = unchanged and all(digest_of_file(path) == digest for path, digest in entry["bodies"].items())
            return Printed(entry["code"], entry["stdout"], entry["stderr"], entry["json"]) if unchanged else None
        except (OSError, ValueError, KeyError, TypeError, AttributeError):
            return None

    def store(self, printed: Printed) -> None:
        """Store the output for the files that were read."""
        entry = {
            "files": self._read,
            "bodies": self._bodies,
            "code": printed.code,
            "stdout": printed.stdout,
            "stderr": printed.stderr,
            "json": printed.json,
        }
        with suppress(OSError):
            path = self._path()
            path.parent.mkdir(exist_ok=True)
            store(str(path), json.dumps(entry).encode())

    def _path(self) -> Path:
        return Path(cache_folder(), "verify", self._name)


def _installed() -> str:
    """A digest that changes with every change of cspdiag itself, also in a checkout."""
    root = Path(__file__).parents[3]
    files = (
        entry for folder in _CONCERNED for ending in ("py", "csp") for entry in (root / folder).rglob(f"*.{ending}")
    )
    newest = max((entry.stat().st_mtime_ns for entry in files), default=0)
    return f"{__version__} {newest}"


_CONCERNED = (
    "analyses",
    "base",
    "cli",
    "codegen",
    "model",
    "network",
    "optimize",
    "proofs",
    "runtime",
    "simulate",
    "std",
    "syntax",
    "verify",
)


def _digest(text: str) -> str:
    return sha256(text.encode()).hexdigest()
