"""An editor that asks the language server over standard input and output, and its answers as texts."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Coroutine, Sequence
from pathlib import Path
from typing import Any

from lsprotocol import types
from pytest_lsp import LanguageClient

from cspdiag.model.expressions.functions import FUNCTIONS

CURSOR = "§"
"""Marks the place of a request in the program of a case; a second one ends a range."""

PATIENCE = 30.0
"""Seconds after which a missing answer fails the test."""


class Editor:
    """Has the files of one folder open; ``main`` is the one that requests are about."""

    def __init__(self, client: LanguageClient, folder: Path) -> None:
        self.client = client
        self.folder = folder
        self.main = ""
        self.text = ""
        self.places: list[types.Position] = []
        self._version = 0

    def uri(self, name: str) -> str:
        return (self.folder / name).as_uri()

    async def open(self, name: str, marked: str) -> list[types.Diagnostic]:
        """Open the main file; returns its diagnostics."""
        self.main = name
        self.places = _places(marked)
        self.text = marked.replace(CURSOR, "")
        self._version += 1
        document = types.TextDocumentItem(self.uri(name), "csp", self._version, self.text)
        return await self._diagnostics_after(
            lambda: self.client.text_document_did_open(types.DidOpenTextDocumentParams(document))
        )

    async def replace(self, marked: str) -> list[types.Diagnostic]:
        """Replace the text of the main file; returns its diagnostics."""
        self.places = _places(marked)
        self.text = marked.replace(CURSOR, "")
        change: types.TextDocumentContentChangeEvent = types.TextDocumentContentChangeWholeDocument(self.text)
        return await self.change(change)

    async def change(self, *changes: types.TextDocumentContentChangeEvent) -> list[types.Diagnostic]:
        self._version += 1
        document = types.VersionedTextDocumentIdentifier(self._version, self.uri(self.main))
        return await self._diagnostics_after(
            lambda: self.client.text_document_did_change(types.DidChangeTextDocumentParams(document, list(changes)))
        )

    async def _diagnostics_after(self, act: Callable[[], object]) -> list[types.Diagnostic]:
        act()
        return await self.diagnostics_of(self.main, self._version)

    async def diagnostics_of(self, name: str, version: int | None) -> list[types.Diagnostic]:
        """The diagnostics of a version of a file, once they have been published."""
        while True:
            found: types.PublishDiagnosticsParams = await asyncio.wait_for(
                self.client.wait_for_notification(types.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS), PATIENCE
            )
            if found.uri == self.uri(name) and found.version == version:
                return list(found.diagnostics)

    async def close(self) -> None:
        self.client.text_document_did_close(types.DidCloseTextDocumentParams(self.document))

    @property
    def document(self) -> types.TextDocumentIdentifier:
        return types.TextDocumentIdentifier(self.uri(self.main))

    async def answer(self, feature: str) -> str:
        """What the server answers at the marked place, as text."""
        return await FEATURES[feature](self)


def _places(marked: str) -> list[types.Position]:
    places = []
    before = ""
    for part in marked.split(CURSOR)[:-1]:
        before += part
        places.append(types.Position(before.count("\n"), len(before.rsplit("\n", 1)[-1].encode("utf-16-le")) // 2))
    return places


def place(position: types.Position) -> str:
    return f"{position.line + 1}:{position.character + 1}"


def extent(found: types.Range) -> str:
    return f"{place(found.start)}-{place(found.end)}"


def lines(found: Sequence[str]) -> str:
    return "".join(f"{line}\n" for line in found) or "nothing\n"


def described(diagnostics: Sequence[types.Diagnostic]) -> str:
    """Diagnostics as text."""
    found = []
    for each in diagnostics:
        severity = types.DiagnosticSeverity(each.severity).name.lower() if each.severity else ""
        tags = "".join(f" {types.DiagnosticTag(tag).name.lower()}" for tag in each.tags or ())
        first, *rest = each.message.split("\n")
        found.append(f"{extent(each.range)} {severity}{tags}[{each.code}] {first}")
        found += [f"  {line}" for line in rest]
        found += [f"  see {extent(r.location.range)} {r.message}" for r in each.related_information or ()]
    return lines(found)


async def all_diagnostics(editor: Editor) -> str:
    """The diagnostics of all files, those of the main one first."""
    # An answer comes after what was published before.
    await editor.client.text_document_document_symbol_async(types.DocumentSymbolParams(editor.document))
    published = editor.client.diagnostics
    text = described(published.get(editor.uri(editor.main), ()))
    for uri in sorted(uri for uri, found in published.items() if found and uri != editor.uri(editor.main)):
        if uri.startswith(editor.folder.as_uri()):
            text += f"{uri.rsplit('/', 1)[-1]}:\n{described(published[uri])}"
    return text.replace(str(editor.folder), "FOLDER")


async def _hover(editor: Editor) -> str:
    params = types.HoverParams(editor.document, editor.places[0])
    found = await editor.client.text_document_hover_async(params)
    if found is None:
        return lines([])
    assert isinstance(found.contents, types.MarkupContent)
    assert found.range is not None
    # A fence would end the block of the case.
    return f"{extent(found.range)}\n{found.contents.value.replace('```', '~~~')}\n"


async def _completion(editor: Editor) -> str:
    params = types.CompletionParams(editor.document, editor.places[0])
    found = await editor.client.text_document_completion_async(params)
    assert isinstance(found, list)
    found = sorted(found, key=lambda item: item.sort_text or "")
    names = [f"{types.CompletionItemKind(item.kind or 1).name.lower()} {item.detail or item.label}" for item in found]
    shown = [
        name
        for name, item in zip(names, found, strict=True)
        if item.kind not in (types.CompletionItemKind.Keyword, types.CompletionItemKind.Unit)
        and item.label not in FUNCTIONS
    ]
    keywords = [item.label for item in found if item.kind == types.CompletionItemKind.Keyword]
    return lines([*shown, f"keywords: {', '.join(keywords)}"] if keywords else shown)


async def _outline(editor: Editor) -> str:
    params = types.DocumentSymbolParams(editor.document)
    found = await editor.client.text_document_document_symbol_async(params)

    def shown(symbol: types.DocumentSymbol, depth: int) -> list[str]:
        detail = f" : {symbol.detail}" if symbol.detail else ""
        line = (
            f"{'  ' * depth}{types.SymbolKind(symbol.kind).name.lower()} {symbol.name}{detail} {extent(symbol.range)}"
        )
        return [line, *(inner for child in symbol.children or () for inner in shown(child, depth + 1))]

    assert found is not None
    return lines([line for symbol in found if isinstance(symbol, types.DocumentSymbol) for line in shown(symbol, 0)])


FEATURES: dict[str, Callable[[Editor], Coroutine[Any, Any, str]]] = {
    "completion": _completion,
    "diagnostics": all_diagnostics,
    "hover": _hover,
    "outline": _outline,
}
