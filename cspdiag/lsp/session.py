"""What is open in the editor, and the programs that this makes."""

from __future__ import annotations

from collections.abc import Sequence

from cspdiag.base.diagnostic import Diagnostic
from cspdiag.base.files.content import Stamp, digest_of_file, stamp_of_file
from cspdiag.base.report import Report
from cspdiag.base.span import SourceFile
from cspdiag.editing.view import View
from cspdiag.lsp.documents import Document, Documents, identity
from cspdiag.lsp.folders import importers
from cspdiag.lsp.positions import Positions
from cspdiag.model.remembered import RememberedChecks
from cspdiag.pipeline import Reader
from cspdiag.syntax import ast
from cspdiag.syntax.incremental import Parsed, parse_again
from cspdiag.syntax.on_demand import parsed


class Session:
    """The open documents with a view of each; a view is used until a file of its program changes."""

    def __init__(self) -> None:
        self.positions = Positions()
        self.documents = Documents(self.positions)
        self._views: dict[str, View] = {}
        self._parsed: dict[str, Parsed] = {}
        """By name: the last text of a file with its tree and the mistakes in it."""
        self._checks: dict[str, RememberedChecks] = {}
        """For each open document the checks of its program that need not be made again."""
        self.views = 0
        """How many views were made."""
        self.parses = 0
        """How many texts were parsed."""
        self.imports_changed = False
        """Whether a program has changed whose main file has not, because of an import or a body, since the editor was
        last refreshed.
        """
        self._stamps: dict[str, Stamp | None] = {}
        """By name: what distinguished the files of the programs of open documents at the last look at the disk."""

    def view(self, document: Document) -> View:
        """The program of which an open document is the main file, as it is now."""
        known = self._views.get(document.identity)
        if known is not None and known.main is document.source and self._is_present(known):
            return known
        if known is not None and known.main is document.source:
            self.imports_changed = True
        if known is not None and not _has_same_bodies(known):
            # What was checked may depend on the description of an FMU.
            self._checks.pop(document.identity, None)
        self.views += 1
        view = self._views[document.identity] = View(
            document.source, self.documents.read, self._parse, self._checks_of(document)
        )
        return view

    def _checks_of(self, document: Document) -> RememberedChecks:
        return self._checks.setdefault(document.identity, RememberedChecks())

    def diagnostics(self, document: Document) -> list[Diagnostic]:
        """Everything that is wrong with the program of an open document."""
        found = self.view(document).diagnostics
        # Now it is known which files the program imports.
        self._forget()
        return found

    def views_with(self, file: str, folders: Sequence[str]) -> list[View]:
        """The programs that contain a file, given by its identity: those of open documents, and those in folders."""
        views = [self.view(each) for each in self.documents if not each.is_too_large]
        known = {view.main.name for view in views}
        for name in importers(file, folders, self.documents):
            if name not in known:
                views.append(self.view_of(self.documents.read(name), self.documents.read))
        return [view for view in views if any(identity(name) == file for name in view.sources)]

    def view_of(self, main: SourceFile, read: Reader) -> View:
        """A program that is not kept, because no document that is open is its main file, or not with this text."""
        return View(main, read, parsed)

    def close(self, uri: str) -> None:
        """Forget an open document."""
        document = self.documents.get(uri)
        self.documents.close(uri)
        if document is not None:
            self._views.pop(document.identity, None)
            self._checks.pop(document.identity, None)
            self._forget()

    def changed_on_disk(self) -> list[Document]:
        """The open documents whose programs have other files since the last call, without those of which the editor has
        sent a notification meanwhile: it does so only for the folders that it has open, if at all.
        """
        before, self._stamps = self._stamps, {}
        found = []
        for document in self.documents:
            view = self._views.get(document.identity)
            if view is None:
                continue
            stamps = {name: stamp_of_file(name) for name in (*view.texts, *view.bodies)}
            self._stamps |= stamps
            is_other = any(name not in before or before[name] != stamp for name, stamp in stamps.items())
            # A request may have made the program again, of which nothing was published.
            if is_other and (self.imports_changed or not self._is_present(view)):
                found.append(document)
        return found

    def _is_present(self, view: View) -> bool:
        """Whether the imported files and the bodies still are as they were, and no other text of a file of the program
        was parsed meanwhile: its nodes then have places in that text.
        """
        is_same = all(self._text(name) == text for name, text in view.texts.items()) and all(
            name in self._parsed and self._parsed[name].tree is tree for name, tree in view.trees.items()
        )
        return is_same and _has_same_bodies(view)

    def _text(self, name: str) -> str | None:
        try:
            return self.documents.read(name).text
        except (OSError, ValueError):
            return None

    def _parse(self, source: SourceFile, report: Report) -> ast.SourceTree:
        known = self._parsed.get(source.name)
        if known is None or known.source.text != source.text:
            self.parses += 1
            # Should reading fail in the middle, the previous nodes are no longer where they were.
            self._parsed.pop(source.name, None)
            known = self._parsed[source.name] = parse_again(source, known)
        for mistake in known.mistakes:
            report.add(mistake)
        return known.tree

    @property
    def remembered(self) -> int:
        """How many trees are kept, without those of bundled libraries."""
        return sum(not name.startswith("std/") for name in self._parsed)

    def _forget(self) -> None:
        """Keep only the trees of files that belong to a program of an open document."""
        used = {name for view in self._views.values() for name in (view.main.name, *view.texts)}
        for name in [name for name in self._parsed if name not in used and not name.startswith("std/")]:
            del self._parsed[name]

    def users(self, document: Document) -> list[Document]:
        """The open documents whose programs contain a document, itself included."""
        return [each for each in self.documents if each is document or self._imports(each, document.identity)]

    def _imports(self, document: Document, other: str) -> bool:
        view = self._views.get(document.identity)
        return view is not None and any(identity(name) == other for name in view.texts)


def _has_same_bodies(view: View) -> bool:
    return all(digest_of_file(path) == digest for path, digest in view.bodies.items())
