"""The program that a request is about, and what is remembered of it until the next one."""

from __future__ import annotations

import errno
import os
import posixpath
from collections.abc import Callable, Mapping

from cspdiag.api import LoadedProgram
from cspdiag.base.report import Report
from cspdiag.base.sources import read_source
from cspdiag.base.span import SourceFile, with_line_feeds
from cspdiag.editing.positions import offset_of
from cspdiag.editing.view import View
from cspdiag.model.remembered import RememberedChecks
from cspdiag.studio.engine.data import Data
from cspdiag.studio.engine.failure import RequestError
from cspdiag.studio.engine.program_file import ProgramFile
from cspdiag.syntax import ast
from cspdiag.syntax.incremental import Parsed, parse_again

LONGEST = 1_000_000
"""Characters of all files of a program together."""
MOST_FILES = 200


class Files:
    """The texts of a program by name. Nothing else can be read: what is not among them does not exist, except, if there
    is a ``folder``, what is in that.
    """

    def __init__(self, texts: Mapping[str, str], main: str, folder: str | None = None) -> None:
        self.main = main
        self.folder = folder
        self._sources = {name: SourceFile(name=name, text=text) for name, text in texts.items()}

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Files) and self.main == other.main and self._sources == other._sources

    __hash__ = None  # type: ignore[assignment]

    def read(self, name: str) -> SourceFile:
        """A file of the program. Raises OSError if there is none of that name."""
        found = self._sources.get(posixpath.normpath(name))
        if found is None and self.folder is not None:
            return SourceFile(name=name, text=read_source(os.path.join(self.folder, name)).text)
        if found is None:
            raise OSError(errno.ENOENT, "it is not among the files of this program", name)
        return found

    @property
    def source(self) -> SourceFile:
        """The main file."""
        return self._sources[self.main]


def files_of(params: Data, folder: Callable[[str], str] | None = None) -> Files:
    """The program of a request. What is not sent of it is in the ``folder`` of its main file, if that is given. Raises
    RequestError.
    """
    program = params.get("program", params)
    texts, main = program.get("files"), program.get("main")
    if not isinstance(texts, dict) or not all(isinstance(text, str) for text in texts.values()):
        raise RequestError("`files` of a program is an object of texts by name")
    if len(texts) > MOST_FILES:
        raise RequestError(f"the program has {len(texts)} files, more than the {MOST_FILES} that the studio takes")
    characters = sum(map(len, texts.values()))
    if characters > LONGEST:
        raise RequestError(
            f"the program has {characters} characters, more than the {LONGEST} that the studio takes",
            "`cspdiag check` has no such limit",
        )
    if not isinstance(main, str) or main not in texts:
        raise RequestError("`main` is the name of one of the files of the program")
    for name in texts:
        if posixpath.isabs(name) or posixpath.normpath(name) != name or name.startswith(("..", "std/")):
            raise RequestError(f"{name!r} is not a name of a file below the folder of the program")
    return Files(
        {name: _clean(name, text) for name, text in texts.items()}, main, None if folder is None else folder(main)
    )


def _clean(name: str, text: str) -> str:
    if "\0" in text:
        raise RequestError(f"{name} has zero bytes, so it is not a text")
    try:
        text.encode()
    except UnicodeEncodeError:
        raise RequestError(f"{name} has half of a character of two code units (a surrogate)") from None
    return with_line_feeds(text)


class Programs:
    """What is known of the last program that was asked for, so that after a small change little is done again.

    With a ``file`` the programs are beside that: what is not sent is read from there, and the folder that has them
    becomes the working folder, to which FMUs and other files that a program names are relative.
    """

    def __init__(self, file: ProgramFile | None = None) -> None:
        self._file = file
        self._files: Files | None = None
        self._view: View | None = None
        self._parsed: dict[str, Parsed] = {}
        self._checks = RememberedChecks()

    def files_of(self, params: Data) -> Files:
        """The program of a request. Raises RequestError, and OSError if its folder is gone."""
        if self._file is None:
            return files_of(params)
        files = files_of(params, self._file.folder)
        if files.folder is not None:
            os.chdir(files.folder)
        return files

    def view(self, files: Files) -> View:
        """The program as editors see it."""
        if self._view is None or self._files != files:
            if self._files is not None and self._files.main != files.main:
                self._parsed, self._checks = {}, RememberedChecks()
            self._files = files
            self._view = View(files.source, files.read, self._parse, self._checks)
        return self._view

    def loaded(self, files: Files) -> LoadedProgram:
        """The program as the Python interface has it."""
        return LoadedProgram(files.source, read=files.read)

    def at(self, params: Data) -> tuple[View, int]:
        """The program of a request and the offset of its ``place`` in the file that is named there."""
        place = params.get("place")
        if not isinstance(place, dict) or not isinstance(place.get("line"), int | None):
            raise RequestError("`place` is an object with file, line and character")
        files = self.files_of(params)
        name = place.get("file", files.main)
        if name != files.main:
            if not isinstance(name, str):
                raise RequestError("the file of a place is a name")
            try:
                source = files.read(name)
            except OSError:
                raise RequestError(f"the program has no file {name!r}") from None
            view = View(source, files.read, self._parse)
        else:
            source, view = files.source, self.view(files)
        line, character = max(0, int(place.get("line", 0))), max(0, int(place.get("character", 0)))
        return view, offset_of(source, line, character, "utf-16")

    def _parse(self, source: SourceFile, report: Report) -> ast.SourceTree:
        known = self._parsed.get(source.name)
        if known is None or known.source.text != source.text:
            # Should reading fail in the middle, the previous nodes are no longer where they were.
            self._parsed.pop(source.name, None)
            known = self._parsed[source.name] = parse_again(source, known)
        for mistake in known.mistakes:
            report.add(mistake)
        return known.tree
