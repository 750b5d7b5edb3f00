"""An editor that asks the language server over standard input and output, and its answers as texts."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Coroutine, Sequence
from pathlib import Path
from typing import Any

from lsprotocol import types
from pygls.exceptions import JsonRpcException
from pygls.protocol import default_converter
from pytest_lsp import LanguageClient

from cspdiag.base.diagnostic import Edit
from cspdiag.base.edits import applied
from cspdiag.base.span import SourceFile, Span
from cspdiag.lsp.features.highlighting import LEGEND
from cspdiag.lsp.positions import Positions
from cspdiag.model.expressions.functions import FUNCTIONS

CURSOR = "§"
"""Marks the place of a request in the program of a case; a second one ends a range."""

PATIENCE = 30.0
"""Seconds after which a missing answer fails the test."""


class Client(LanguageClient):
    """A client whose editors see all diagnostics, in order."""

    def __init__(self) -> None:
        super().__init__(converter_factory=default_converter)
        self.editors: list[Editor] = []
        self.diagnostics: dict[str, Sequence[types.Diagnostic]] = {}
        self.refreshed: set[str] = set()
        """What the server has had asked for again."""
        self.progress: dict[types.ProgressToken, list[Any]] = {}

        @self.feature(types.TEXT_DOCUMENT_PUBLISH_DIAGNOSTICS)
        def publish(found: types.PublishDiagnosticsParams) -> None:
            self.diagnostics[found.uri] = found.diagnostics
            for editor in self.editors:
                editor.published.put_nowait(found)

        @self.feature(types.WORKSPACE_CODE_LENS_REFRESH)
        def refresh_lenses(*_: object) -> None:
            self.refreshed.add("lenses")

        @self.feature(types.WORKSPACE_SEMANTIC_TOKENS_REFRESH)
        def refresh_tokens(*_: object) -> None:
            self.refreshed.add("tokens")

        @self.feature(types.WINDOW_WORK_DONE_PROGRESS_CREATE)
        def create(_: types.WorkDoneProgressCreateParams) -> None:
            """An editor would show what is done."""

        @self.feature(types.PROGRESS)
        def progress(found: types.ProgressParams) -> None:
            self.progress.setdefault(found.token, []).append(found.value)

        @self.feature(types.WINDOW_SHOW_MESSAGE)
        def show(found: types.ShowMessageParams) -> None:
            self.messages.append(found)

        @self.feature(types.WINDOW_LOG_MESSAGE)
        def log(found: types.LogMessageParams) -> None:
            self.log_messages.append(found)


class Editor:
    """Has the files of one folder open; ``main`` is the one that requests are about."""

    def __init__(self, client: Client, folder: Path) -> None:
        self.client = client
        self.folder = folder
        self.main = ""
        self.text = ""
        self.places: list[types.Position] = []
        self.version = 0
        self.published: asyncio.Queue[types.PublishDiagnosticsParams] = asyncio.Queue()
        client.editors.append(self)

    def uri(self, name: str) -> str:
        return (self.folder / name).as_uri()

    async def open(self, name: str, marked: str) -> list[types.Diagnostic]:
        """Open the main file; returns its diagnostics."""
        self.main = name
        self.places = _places(marked)
        self.text = marked.replace(CURSOR, "")
        self.version += 1
        document = types.TextDocumentItem(self.uri(name), "csp", self.version, self.text)
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
        self.version += 1
        document = types.VersionedTextDocumentIdentifier(self.version, self.uri(self.main))
        return await self._diagnostics_after(
            lambda: self.client.text_document_did_change(types.DidChangeTextDocumentParams(document, list(changes)))
        )

    async def _diagnostics_after(self, act: Callable[[], object]) -> list[types.Diagnostic]:
        act()
        return await self.diagnostics_of(self.main, self.version)

    async def diagnostics_of(self, name: str, version: int | None) -> list[types.Diagnostic]:
        """The diagnostics of a version of a file that are published next."""
        return list((await asyncio.wait_for(self._next(self.uri(name), version), PATIENCE)).diagnostics)

    async def _next(self, uri: str, version: int | None) -> types.PublishDiagnosticsParams:
        while True:
            found = await self.published.get()
            if found.uri == uri and found.version == version:
                return found

    async def close(self) -> None:
        self.client.text_document_did_close(types.DidCloseTextDocumentParams(self.document))
        self.client.editors.remove(self)

    @property
    def document(self) -> types.TextDocumentIdentifier:
        return types.TextDocumentIdentifier(self.uri(self.main))

    def edited(self, edit: types.WorkspaceEdit) -> str:
        """The texts of files after an edit, with the names of those that are not the main one."""
        text = ""
        for uri, edits in (edit.changes or {}).items():
            name = uri.rsplit("/", 1)[-1]
            before = self.text if uri == self.uri(self.main) else (self.folder / name).read_text(encoding="utf-8")
            source = SourceFile(name=name, text=before)
            offset = Positions().offset
            spans = [Span(source, offset(source, each.range.start), offset(source, each.range.end)) for each in edits]
            replaced = [Edit(span, each.new_text) for span, each in zip(spans, edits, strict=True)]
            text += "" if name == self.main else f"{name}:\n"
            text += applied(before, replaced)
        return text

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


async def _definition(editor: Editor) -> str:
    params = types.DefinitionParams(editor.document, editor.places[0])
    found = await editor.client.text_document_definition_async(params)
    return lines([_located(editor, found)] if isinstance(found, types.Location) else [])


def _located(editor: Editor, location: types.Location) -> str:
    name = location.uri.rsplit("/", 1)[-1]
    return f"{'' if location.uri == editor.uri(editor.main) else f'{name}:'}{extent(location.range)}"


async def _references(editor: Editor) -> str:
    context = types.ReferenceContext(include_declaration=True)
    params = types.ReferenceParams(context, editor.document, editor.places[0])
    found = await editor.client.text_document_references_async(params)
    return lines([_located(editor, each) for each in found or ()])


async def _highlights(editor: Editor) -> str:
    params = types.DocumentHighlightParams(editor.document, editor.places[0])
    found = await editor.client.text_document_document_highlight_async(params)
    return lines([extent(each.range) for each in found or ()])


async def _rename(editor: Editor) -> str:
    """The text with the new name ``renamed``, or why not."""
    params = types.RenameParams(editor.document, editor.places[0], "renamed")
    try:
        edit = await editor.client.text_document_rename_async(params)
    except JsonRpcException as problem:
        return lines([problem.message])
    return "" if edit is None else editor.edited(edit)


async def _actions(editor: Editor) -> str:
    """Each action with the text after it."""
    extent_ = types.Range(editor.places[0], editor.places[-1])
    params = types.CodeActionParams(editor.document, extent_, types.CodeActionContext([]))
    found = await editor.client.text_document_code_action_async(params)
    text = ""
    for action in found or ():
        assert isinstance(action, types.CodeAction)
        resolved = action if action.edit else await editor.client.code_action_resolve_async(action)
        assert resolved.edit is not None
        text += f"--- {action.title}\n{editor.edited(resolved.edit)}"
    return text or lines([])


async def _formatting(editor: Editor) -> str:
    params = types.DocumentFormattingParams(editor.document, types.FormattingOptions(2, True))
    found = await editor.client.text_document_formatting_async(params)
    if found is None:
        return "refused\n"
    text = "".join(f"{extent(each.range)}\n" for each in found)
    return text + editor.edited(types.WorkspaceEdit(changes={editor.uri(editor.main): found}))


async def _folding(editor: Editor) -> str:
    params = types.FoldingRangeParams(editor.document)
    found = await editor.client.text_document_folding_range_async(params)
    return lines([f"{each.start_line + 1}-{each.end_line + 1} {each.kind or 'block'}" for each in found or ()])


async def _tokens(editor: Editor) -> str:
    params = types.SemanticTokensParams(editor.document)
    found = await editor.client.text_document_semantic_tokens_full_async(params)
    assert found is not None
    shown = []
    line = column = 0
    for at in range(0, len(found.data), 5):
        down, right, length, kind, modifiers = found.data[at : at + 5]
        line, column = line + down, right + (0 if down else column)
        names = [name for bit, name in enumerate(LEGEND.token_modifiers) if modifiers & 1 << bit]
        word = editor.text.split("\n")[line][column : column + length]
        if LEGEND.token_types[kind] != "keyword":
            shown.append(f"{line + 1}:{column + 1} {word} {' '.join([LEGEND.token_types[kind], *names])}")
    return lines(shown)


async def _hints(editor: Editor) -> str:
    """The text with its hints."""
    end = types.Position(editor.text.count("\n") + 1, 0)
    params = types.InlayHintParams(editor.document, types.Range(types.Position(0, 0), end))
    found = await editor.client.text_document_inlay_hint_async(params)
    edits = [types.TextEdit(types.Range(each.position, each.position), f" [{each.label}]") for each in found or ()]
    return editor.edited(types.WorkspaceEdit(changes={editor.uri(editor.main): edits}))


async def _signature(editor: Editor) -> str:
    params = types.SignatureHelpParams(editor.document, editor.places[0])
    found = await editor.client.text_document_signature_help_async(params)
    if found is None:
        return lines([])
    (shown,) = found.signatures
    assert shown.parameters is not None
    return f"{shown.label}\nnow: {shown.parameters[found.active_parameter or 0].label}\n"


async def _lenses(editor: Editor) -> str:
    params = types.CodeLensParams(editor.document)
    found = await editor.client.text_document_code_lens_async(params)
    return lines([f"{extent(each.range)} {each.command.title}" for each in found or () if each.command])


async def _verified(editor: Editor) -> str:
    """The lenses after their commands, and the diagnostics."""
    found = await editor.client.text_document_code_lens_async(types.CodeLensParams(editor.document))
    for lens in found or ():
        assert lens.command is not None
        command = types.ExecuteCommandParams(lens.command.command, lens.command.arguments)
        await editor.client.workspace_execute_command_async(command)
    return await _lenses(editor) + await all_diagnostics(editor)


FEATURES: dict[str, Callable[[Editor], Coroutine[Any, Any, str]]] = {
    "actions": _actions,
    "completion": _completion,
    "definition": _definition,
    "diagnostics": all_diagnostics,
    "folding": _folding,
    "formatting": _formatting,
    "highlights": _highlights,
    "hints": _hints,
    "hover": _hover,
    "lenses": _lenses,
    "outline": _outline,
    "references": _references,
    "rename": _rename,
    "signature": _signature,
    "tokens": _tokens,
    "verified": _verified,
}
