"""The server: what is open, and which diagnostics the editor shows."""

from __future__ import annotations

import asyncio
import time
from typing import Any

from lsprotocol import types
from pygls.lsp.server import LanguageServer

from cspdiag import __version__
from cspdiag.editing.proved import Proved
from cspdiag.editing.view import View
from cspdiag.lsp.documents import Document, name_of
from cspdiag.lsp.features import diagnostics
from cspdiag.lsp.features.lenses import asserted
from cspdiag.lsp.garbage import Garbage
from cspdiag.lsp.pictures.process import Drawer
from cspdiag.lsp.progress import with_progress
from cspdiag.lsp.protocol import Protocol, converter
from cspdiag.lsp.proving import TIME_LIMIT, prove
from cspdiag.lsp.session import Session
from cspdiag.syntax import ast

_SOON = 0.002
"""Seconds after a change until the program is checked, so that changes that were sent together are one."""
_LONGEST_PAUSE = 0.5
"""Seconds of quiet for which the check of a slow program waits at most."""
_QUICK = 0.1
"""Seconds of a check from which on it waits for quiet."""
_BETWEEN_LOOKS = 2.0
"""Seconds between two looks at the files on the disk of which open programs consist."""


class CspdiagServer(LanguageServer):
    """The language server of cspdiag."""

    def __init__(self) -> None:
        super().__init__(
            "cspdiag",
            __version__,
            text_document_sync_kind=types.TextDocumentSyncKind.Incremental,
            protocol_cls=Protocol,
            converter_factory=converter,
        )
        self.session = Session()
        self.drawer = Drawer()
        self._proofs: dict[tuple[str, str], tuple[View, asyncio.Task[list[Proved]]]] = {}
        """The proofs under way, by the name of the file and the text of the assertion, with their programs."""
        self._timer: asyncio.TimerHandle | None = None
        self._look_timer: asyncio.TimerHandle | None = None
        self._changed: dict[str, Document] = {}
        """Open documents whose diagnostics are to be computed, by identity."""
        self._published: dict[str, dict[str, list[types.Diagnostic]]] = {}
        """What was published for each URI, by the identity of the document whose program has it."""
        self._last_seconds = 0.0
        self._garbage = Garbage()

    # Documents

    def changed(self, document: Document) -> None:
        """Publish the diagnostics of a document and of the open programs that contain it, soon."""
        for user in self.session.users(document):
            self._changed[user.identity] = user
        self._garbage.wait()
        if self._timer is not None:
            self._timer.cancel()
        pause = _SOON if self._last_seconds < _QUICK else min(self._last_seconds, _LONGEST_PAUSE)
        loop = asyncio.get_running_loop()
        self._timer = loop.call_later(pause, self._publish_changed)
        if self._look_timer is None:
            self._look_timer = loop.call_later(_BETWEEN_LOOKS, self._look)

    def _look(self) -> None:
        """Publish what has changed because of files on the disk, and look again later, as long as any file is open."""
        self._look_timer = None
        for document in self.session.changed_on_disk():
            self.changed(document)
        if self._look_timer is None and any(self.session.documents):
            self._look_timer = asyncio.get_running_loop().call_later(_BETWEEN_LOOKS, self._look)

    def _publish_changed(self) -> None:
        self._timer = None
        changed, self._changed = self._changed, {}
        began = time.perf_counter()
        for document in changed.values():
            if self.session.documents.get(document.uri) is document:
                self._publish(document)
        if self.session.imports_changed:
            self.session.imports_changed = False
            self._refresh()
        self._last_seconds = time.perf_counter() - began
        self._garbage.left()

    def _publish(self, document: Document) -> None:
        found: dict[str, list[types.Diagnostic]] = {document.uri: []}
        found[document.uri] += diagnostics.encoding(document.source, document.misread, self.session.positions)
        if document.is_too_large:
            found[document.uri].append(diagnostics.unchecked(document))
        else:
            uri, positions = self.session.documents.uri, self.session.positions
            for each in self.session.diagnostics(document):
                shown = diagnostics.diagnostic(each, positions, uri)
                found.setdefault(uri(each.span.file), []).append(shown)
        self._replace(document.identity, found)

    def _replace(self, owner: str, found: dict[str, list[types.Diagnostic]]) -> None:
        """Publish what has changed in the diagnostics of the program of one document."""
        touched = dict.fromkeys([*found, *(uri for uri, owners in self._published.items() if owner in owners)])
        for uri in touched:
            owners = self._published.setdefault(uri, {})
            if uri in found:
                owners[owner] = found[uri]
            else:
                owners.pop(owner, None)
            unique = {repr(each): each for several in owners.values() for each in several}
            version = self.session.documents.version(self._name(uri))
            self.text_document_publish_diagnostics(types.PublishDiagnosticsParams(uri, list(unique.values()), version))
            if not owners:
                del self._published[uri]

    def _name(self, uri: str) -> str:
        document = self.session.documents.get(uri)
        return uri if document is None else document.source.name

    def closed(self, uri: str) -> None:
        """Withdraw the diagnostics of a document's program."""
        document = self.session.documents.get(uri)
        self.session.close(uri)
        if document is not None:
            self._changed.pop(document.identity, None)
            self._replace(document.identity, {})
            for user in self.session.users(document):
                if user is not document:
                    self.changed(user)

    # Proofs

    async def prove(self, view: View, assertion: ast.Assertion) -> list[Proved]:
        """Answer an assertion of a program, while the editor shows that this is under way.

        Raises ProvingError, and CancelledError if it was cancelled in the editor, or because the assertion is being
        proved of a later text; then that is what is wanted.
        """
        words = asserted(assertion)
        key = view.main.name, words
        before, running = self._proofs.get(key, (None, None))
        if running is not None:
            if before is view:
                return await asyncio.shield(running)
            running.cancel()
        proof = prove(view.main, view.files, assertion.span.start)
        detail = f"for at most {TIME_LIMIT:g} s"
        task = asyncio.create_task(with_progress(self, f"Verifying `{words}`", detail, proof))
        self._proofs[key] = view, task
        try:
            return await task
        finally:
            if self._proofs.get(key) == (view, task):
                del self._proofs[key]

    def answered(self, uri: str, view: View, words: str, found: list[Proved]) -> None:
        """Show what was proved of an assertion of a program; if that has another text now, the lens says so."""
        document = self.session.documents.get(uri)
        if document is None:
            return
        for each in found:
            document.answered[words] = each.title
        if not document.is_too_large and self.session.view(document) is view:
            self._publish(document)
        self._refresh_lenses()

    # Requests of the editor that it makes again

    def _refresh_lenses(self) -> None:
        workspace = self.client_capabilities.workspace
        if workspace is not None and workspace.code_lens is not None and workspace.code_lens.refresh_support:
            self.workspace_code_lens_refresh(None)

    def _refresh(self) -> None:
        """Have the editor ask again for all that it shows in texts that it has not changed."""
        self._refresh_lenses()
        workspace = self.client_capabilities.workspace
        if workspace is None:
            return
        if workspace.inlay_hint is not None and workspace.inlay_hint.refresh_support:
            self.workspace_inlay_hint_refresh(None)
        if workspace.semantic_tokens is not None and workspace.semantic_tokens.refresh_support:
            self.workspace_semantic_tokens_refresh(None)

    # Requests

    @property
    def folders(self) -> list[str]:
        """The folders that the editor has open."""
        return [name_of(folder.uri) for folder in self.workspace.folders.values()]

    def document(self, uri: str) -> Document | None:
        """An open document; None if it is not open or too large."""
        document = self.session.documents.get(uri)
        return None if document is None or document.is_too_large else document

    def offsets(self, view: View, range_: types.Range) -> tuple[int, int]:
        """The offsets of a range in the main file of a program."""
        positions = self.session.positions
        return positions.offset(view.main, range_.start), positions.offset(view.main, range_.end)

    def place(self, params: Any) -> tuple[View, int] | None:
        """The program and the offset that a request is about; None if nothing is known of its document."""
        view = self.view(params.text_document.uri)
        if view is None:
            return None
        return view, self.session.positions.offset(view.main, params.position)

    def view(self, uri: str) -> View | None:
        """The program of an open document; None if it is not open or too large."""
        document = self.document(uri)
        return None if document is None else self.session.view(document)
