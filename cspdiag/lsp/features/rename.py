"""Rename: a new name at all places of a declaration, if the program means the same with it."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Sequence

from lsprotocol import types

from cspdiag.base.diagnostic import Diagnostic, Edit
from cspdiag.base.edits import applied
from cspdiag.base.errors import CspdiagError
from cspdiag.base.record import replaced
from cspdiag.base.span import SourceFile
from cspdiag.editing.occurrences import Occurrence, name_place
from cspdiag.editing.view import View
from cspdiag.lsp.documents import Documents, identity, is_bundled
from cspdiag.lsp.features.actions import workspace_edit
from cspdiag.lsp.features.navigation import Key, key, uses
from cspdiag.model.diagnostics.names import DuplicateName
from cspdiag.syntax.parse.automaton import automaton
from cspdiag.syntax.parse.lexer import CONTEXTUAL_KEYWORDS

_NAME = re.compile(r"[A-Za-z_]\w*", re.ASCII)

MakeView = Callable[[SourceFile, Callable[[str], SourceFile]], View]


class RenameError(CspdiagError):
    """A name cannot be changed, or not to the new one; the text says why."""


def renamed_at(view: View, offset: int) -> Occurrence:
    """The occurrence at an offset, if it can be renamed. Raises RenameError."""
    occurrence = view.here.at(offset)
    if occurrence is None:
        raise RenameError("there is no name here that could be changed")
    place = name_place(occurrence.meaning)
    if place is None:
        raise RenameError(f"`{occurrence.span.text}` is a part of the language")
    if is_bundled(place.file):
        raise RenameError(f"`{occurrence.span.text}` is declared in {place.file}, which cannot be changed")
    return occurrence


def rename(
    views: Sequence[View], occurrence: Occurrence, name: str, documents: Documents, make: MakeView
) -> types.WorkspaceEdit:
    """The edits that give a declaration another name in all programs that contain it.

    Raises RenameError if the name is not one, if files cannot be written, or if the programs would have other errors
    or other meanings of names afterwards.
    """
    if not _NAME.fullmatch(name):
        raise RenameError(f"`{name}` is not a name: letters, digits and `_`, and no digit first")
    if name in automaton().tables.words and name not in CONTEXTUAL_KEYWORDS:
        raise RenameError(f"`{name}` is a keyword of the language")
    declaration = key(occurrence.meaning)
    assert declaration is not None
    edits = [Edit(each.span, name) for each in uses(views, declaration)]
    for path in {edit.span.file for edit in edits}:
        if os.path.exists(path) and not os.access(path, os.W_OK):
            raise RenameError(f"{path} is read-only, and `{occurrence.span.text}` occurs in it")
    _Afterwards(views, edits, declaration, documents, make).require_same()
    return workspace_edit(edits, documents)


class _Afterwards:
    """The programs after the edits."""

    def __init__(
        self, views: Sequence[View], edits: Sequence[Edit], declaration: Key, documents: Documents, make: MakeView
    ) -> None:
        self._views = views
        self._documents = documents
        self._make = make
        self._declaration = declaration
        self._edits: dict[str, list[Edit]] = {}
        for edit in edits:
            self._edits.setdefault(identity(edit.span.file), []).append(edit)
        self._shift = len(edits[0].replacement) - (edits[0].span.end - edits[0].span.start)

    def require_same(self) -> None:
        """Raise RenameError for an error that was not there, or if another place has the name now."""
        for view in self._views:
            after = self._make(self._changed(view.main), lambda name: self._changed(self._documents.read(name)))
            new = {(each.code, each.message) for each in after.diagnostics if each.severity == "error"}
            old = {(each.code, each.message) for each in view.diagnostics if each.severity == "error"}
            if len(new) > len(old):
                code, message = min(new - old)
                found = next(each for each in after.diagnostics if (each.code, each.message) == (code, message))
                raise RenameError(f"with this name the program would be wrong: {self._words(found)}")
            before = {self._moved(*place) for place in _places(view, self._declaration)}
            if before != _places(after, self._moved(*self._declaration)):
                raise RenameError("with this name another declaration would be meant somewhere")

    def _words(self, found: Diagnostic) -> str:
        """What is wrong. Of two declarations with one name the one that has had it is named, not the renamed one."""
        if isinstance(found, DuplicateName):
            first = identity(found.first.file), found.first.start
            if first == self._moved(*self._declaration):
                return replaced(found, first_kind=found.kind).message
        return found.message

    def _changed(self, source: SourceFile) -> SourceFile:
        return SourceFile(name=source.name, text=applied(source.text, self._edits.get(identity(source.name), ())))

    def _moved(self, file: str, offset: int) -> Key:
        """Where a name is after the edits."""
        return file, offset + self._shift * sum(edit.span.start < offset for edit in self._edits.get(file, ()))


def _places(view: View, declaration: Key) -> set[Key]:
    return {(identity(each.span.file), each.span.start) for each in uses([view], declaration)}
