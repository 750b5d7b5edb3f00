"""Runs C compilers, but not again on the same: a compiler takes seconds for what hardly ever changes."""

from __future__ import annotations

import os
import shutil
import subprocess
import time
from collections.abc import Iterator
from contextlib import suppress
from functools import cache
from hashlib import sha256
from itertools import pairwise
from pathlib import Path
from tempfile import gettempdir, mkdtemp

from cspdiag.base.files.caches import cache_folder

_CCACHE = Path("/usr/lib/ccache")
"""Commands with the names of compilers, as Debian and others install them."""
_WEEK = 7 * 24 * 3600.0
"""Seconds after which a result that was not used is removed."""


def use_ccache() -> None:
    """Let ccache, if it is installed, answer for the compilers that make and CMake start."""
    if _CCACHE.is_dir():
        os.environ["PATH"] = f"{_CCACHE}{os.pathsep}{os.environ['PATH']}"
        # Tests work in folders of their own, and may take away the usual cache.
        os.environ |= {
            "CCACHE_DIR": f"{cache_folder()}/ccache",
            "CCACHE_BASEDIR": gettempdir(),
            "CCACHE_NOHASHDIR": "1",
        }


def compile_once(*command: str | Path, cwd: Path | None = None) -> None:
    """Run a compiler, or copy what it made in an earlier run, of this session or another, of files with these contents.

    The result is the file after ``-o``, or with ``-c`` alone an object of each source in ``cwd``. All headers count
    that are below the folders of ``-I``, or beside a source; nothing else may be read but the files of the command.
    """
    folder = Path.cwd() if cwd is None else cwd
    words = [str(word) for word in command]
    results = list(_results(words, folder))
    kept = Path(cache_folder(), "tests", _digest(words, folder))
    if kept.is_dir():
        os.utime(kept)
        for position, result in enumerate(results):
            shutil.copy(kept / str(position), result)
        return
    completed = subprocess.run(words, cwd=folder, capture_output=True, text=True, timeout=120, check=False)
    assert completed.returncode == 0, f"{' '.join(words)}\n{completed.stdout}{completed.stderr}"
    _keep(results, kept)


def _results(words: list[str], folder: Path) -> Iterator[Path]:
    """The files that a compiler makes."""
    if "-o" in words:
        yield folder / words[words.index("-o") + 1]
    elif "-c" in words:
        yield from (folder / f"{Path(word).stem}.o" for word in words if word.endswith(".c"))


def _digest(words: list[str], folder: Path) -> str:
    """A name made of everything on which the result depends, and not of the folder in which it is made."""
    digest = sha256(_version(words[0]).encode())
    for before, word in pairwise(words):
        path = folder / word.removeprefix("-I")
        if before == "-o":
            part = ""
        elif word.startswith("-I") and path.is_dir():
            part = f"-I{_contents(path.rglob('*.[ch]'), path)}"
        elif path.is_file():
            beside = _contents(path.parent.glob("*.h"), path.parent) if path.suffix in (".c", ".cpp") else ""
            part = f"{path.name} {_hash(path)} {beside}"
        else:
            part = word
        digest.update(f"{part}\0".encode())
    return digest.hexdigest()[:40]


@cache
def _version(compiler: str) -> str:
    shown = subprocess.run([compiler, "--version"], capture_output=True, text=True, check=True).stdout
    return f"{compiler} {shown}"


def _contents(paths: Iterator[Path], folder: Path) -> str:
    return " ".join(f"{path.relative_to(folder)} {_hash(path)}" for path in sorted(paths))


def _hash(path: Path) -> str:
    return sha256(path.read_bytes()).hexdigest()


def _keep(results: list[Path], place: Path) -> None:
    """Keep results, whole or not at all, and remove what nobody has used for long."""
    place.parent.mkdir(exist_ok=True)
    made = Path(mkdtemp(dir=place.parent))
    for position, result in enumerate(results):
        shutil.copy(result, made / str(position))
    try:
        made.rename(place)
    except OSError:
        # Another process has made the same.
        shutil.rmtree(made)
    for entry in os.scandir(place.parent):
        with suppress(OSError):
            if time.time() - entry.stat().st_mtime > _WEEK:
                shutil.rmtree(entry.path)
