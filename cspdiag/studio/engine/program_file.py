"""The program of ``cspdiag studio FILE`` as it is on disk."""

from __future__ import annotations

import os
from contextlib import suppress

from cspdiag.base.report import Report
from cspdiag.base.sources import read_source
from cspdiag.base.span import SourceFile
from cspdiag.studio.engine.data import Data

_BESIDE = (".py", ".svg")
"""Hand-written bodies, and drawings that move with the run."""
_LARGEST = 1_000_000
"""Bytes of a file beside the program that pages get."""


class ProgramFile:
    """A program on this machine. The names of its files are relative to the folder that has them all: that of the
    file, or one further out if it imports files from there.
    """

    def __init__(self, path: str) -> None:
        self._path = os.path.realpath(path)

    def read(self) -> Data:
        """The texts of the file, of those that it imports, and of what lies beside them, as a program of requests.

        Raises OSError if the file cannot be read; others that cannot be read are left out.
        """
        from cspdiag.model.names.imports import load

        texts = {self._path: read_source(self._path).text}

        def read(name: str) -> SourceFile:
            source = read_source(name)
            texts[source.name] = source.text
            return source

        load(SourceFile(name=self._path, text=texts[self._path]), read, Report())
        folders = {os.path.dirname(path) for path in texts}
        for folder in sorted(folders):
            texts |= _beside(folder)
        outermost = os.path.commonpath(folders)
        named = {_name(path, outermost): text for path, text in texts.items()}
        return {"files": named, "main": _name(self._path, outermost)}

    def recordings(self, main: str) -> list[str]:
        """The recordings in its folder, by their names in the program whose main file is called ``main``."""
        from cspdiag.simulate.record.stored.given import ENDINGS

        folder = self.folder(main)
        paths = [os.path.join(self.own_folder, name) for name in sorted(os.listdir(self.own_folder))]
        return [_name(path, folder) for path in paths if path.endswith(ENDINGS) and os.path.isfile(path)]

    def folder(self, main: str) -> str:
        """The folder to which the names of a program are relative whose main file is called ``main``: if that is this
        file, the one in which it has that name.
        """
        suffix = f"{os.sep}{main.replace('/', os.sep)}"
        return (self._path.removesuffix(suffix) or os.sep) if self._path.endswith(suffix) else self.own_folder

    @property
    def own_folder(self) -> str:
        """The folder of the file."""
        return os.path.dirname(self._path)


def _beside(folder: str) -> dict[str, str]:
    texts = {}
    with suppress(OSError):
        for name in sorted(os.listdir(folder)):
            path = os.path.join(folder, name)
            if name.endswith(_BESIDE) and os.path.isfile(path) and os.path.getsize(path) <= _LARGEST:
                with suppress(OSError):
                    texts[path] = read_source(path).text
    return texts


def _name(path: str, folder: str) -> str:
    return os.path.relpath(path, folder).replace(os.sep, "/")
