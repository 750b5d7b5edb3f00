"""What the server does for each message of the protocol."""

from __future__ import annotations

import asyncio
import signal
import sys
from typing import Any

from lsprotocol import types
from pygls.capabilities import ServerCapabilitiesBuilder
from pygls.exceptions import JsonRpcInvalidParams

from cspdiag.editing.positions import Encoding
from cspdiag.lsp.documents import identity
from cspdiag.lsp.features import (
    actions,
    completion,
    folding,
    formatting,
    highlighting,
    hints,
    hover,
    lenses,
    navigation,
    outline,
    rename,
    signature,
)
from cspdiag.lsp.features.diagnostics import too_large
from cspdiag.lsp.folders import programs
from cspdiag.lsp.garbage import Garbage
from cspdiag.lsp.parameters import AssertionParams, DiagramParams, ProgramParams
from cspdiag.lsp.pictures.process import DrawingError
from cspdiag.lsp.proving import ProvingError
from cspdiag.lsp.server import CspdiagServer

server = CspdiagServer()


def encoding_of(capabilities: types.ClientCapabilities) -> Encoding:
    """The code units of positions, as pygls announces them to the editor."""
    match ServerCapabilitiesBuilder.choose_position_encoding(capabilities):
        case types.PositionEncodingKind.Utf8:
            return "utf-8"
        case types.PositionEncodingKind.Utf32:
            return "utf-32"
        case _:  # The default of the protocol; there are no others.
            return "utf-16"


@server.feature(types.INITIALIZE)
def _initialize(ls: CspdiagServer, params: types.InitializeParams) -> None:
    ls.session.positions.encoding = encoding_of(params.capabilities)


@server.feature(types.TEXT_DOCUMENT_DID_OPEN)
def _opened(ls: CspdiagServer, params: types.DidOpenTextDocumentParams) -> None:
    item = params.text_document
    ls.changed(ls.session.documents.open(item.uri, item.text, item.version))


@server.feature(types.TEXT_DOCUMENT_DID_CHANGE)
def _changed(ls: CspdiagServer, params: types.DidChangeTextDocumentParams) -> None:
    document = ls.session.documents.get(params.text_document.uri)
    if document is not None:
        document.change(params.content_changes, params.text_document.version, ls.session.positions)
        ls.changed(document)


@server.feature(types.TEXT_DOCUMENT_DID_CLOSE)
def _closed(ls: CspdiagServer, params: types.DidCloseTextDocumentParams) -> None:
    ls.closed(params.text_document.uri)


@server.feature(types.TEXT_DOCUMENT_DID_SAVE)
def _saved(ls: CspdiagServer, params: types.DidSaveTextDocumentParams) -> None:
    for document in ls.session.documents:
        ls.changed(document)


@server.feature(types.WORKSPACE_DID_CHANGE_WATCHED_FILES)
def _files_changed(ls: CspdiagServer, params: types.DidChangeWatchedFilesParams) -> None:
    for document in ls.session.documents:
        ls.changed(document)


@server.feature(types.TEXT_DOCUMENT_HOVER)
def _hover(ls: CspdiagServer, params: types.HoverParams) -> types.Hover | None:
    place = ls.place(params)
    return None if place is None else hover.hover(*place, ls.session.positions)


# Not after a colon: a blank follows it, after which VS Code sometimes loses what it was answered there and does not ask
# again.
@server.feature(types.TEXT_DOCUMENT_COMPLETION, types.CompletionOptions(trigger_characters=[".", "<", "("]))
def _completion(ls: CspdiagServer, params: types.CompletionParams) -> list[types.CompletionItem]:
    place = ls.place(params)
    return [] if place is None else completion.completion(*place)


@server.feature(types.TEXT_DOCUMENT_SIGNATURE_HELP, types.SignatureHelpOptions(["(", ","]))
def _signature(ls: CspdiagServer, params: types.SignatureHelpParams) -> types.SignatureHelp | None:
    place = ls.place(params)
    return None if place is None else signature.signature(*place)


@server.feature(types.TEXT_DOCUMENT_DOCUMENT_SYMBOL)
def _outline(ls: CspdiagServer, params: types.DocumentSymbolParams) -> list[types.DocumentSymbol]:
    view = ls.view(params.text_document.uri)
    return [] if view is None else outline.outline(view, ls.session.positions)


@server.feature(types.WORKSPACE_SYMBOL)
def _symbols(ls: CspdiagServer, params: types.WorkspaceSymbolParams) -> list[types.WorkspaceSymbol]:
    documents = ls.session.documents
    opened = [document.source.name for document in documents]
    names = {identity(name): name for name in (*programs(ls.folders), *opened)}
    return outline.symbols(params.query, names.values(), documents)


@server.feature(types.TEXT_DOCUMENT_DEFINITION)
def _definition(ls: CspdiagServer, params: types.DefinitionParams) -> types.Location | None:
    place = ls.place(params)
    return None if place is None else navigation.definition(*place, ls.session.documents)


@server.feature(types.TEXT_DOCUMENT_REFERENCES)
def _references(ls: CspdiagServer, params: types.ReferenceParams) -> list[types.Location]:
    place = ls.place(params)
    occurrence = None if place is None else place[0].here.at(place[1])
    declaration = None if occurrence is None else navigation.key(occurrence.meaning)
    if declaration is None:
        return []
    views = ls.session.views_with(declaration[0], ls.folders)
    documents = ls.session.documents
    return navigation.references(views, declaration, documents, declared=params.context.include_declaration)


@server.feature(types.TEXT_DOCUMENT_DOCUMENT_HIGHLIGHT)
def _highlights(ls: CspdiagServer, params: types.DocumentHighlightParams) -> list[types.DocumentHighlight]:
    place = ls.place(params)
    return [] if place is None else navigation.highlights(*place, ls.session.positions)


@server.feature(types.TEXT_DOCUMENT_PREPARE_RENAME)
def _prepare_rename(ls: CspdiagServer, params: types.PrepareRenameParams) -> types.Range | None:
    place = ls.place(params)
    if place is None:
        return None
    try:
        return ls.session.positions.range(rename.renamed_at(*place).span)
    except rename.RenameError as problem:
        raise JsonRpcInvalidParams(str(problem)) from None


@server.feature(types.TEXT_DOCUMENT_RENAME, types.RenameOptions(prepare_provider=True))
def _rename(ls: CspdiagServer, params: types.RenameParams) -> types.WorkspaceEdit | None:
    place = ls.place(params)
    if place is None:
        return None
    session = ls.session
    try:
        occurrence = rename.renamed_at(*place)
        declaration = navigation.key(occurrence.meaning)
        views = session.views_with(declaration[0], ls.folders) if declaration is not None else []
        return rename.rename(views, occurrence, params.new_name, session.documents, session.view_of)
    except rename.RenameError as problem:
        raise JsonRpcInvalidParams(str(problem)) from None


@server.feature(
    types.TEXT_DOCUMENT_CODE_ACTION,
    types.CodeActionOptions([types.CodeActionKind.QuickFix, actions.FIX_ALL], resolve_provider=True),
)
def _actions(ls: CspdiagServer, params: types.CodeActionParams) -> list[types.CodeAction]:
    uri = params.text_document.uri
    view = ls.view(uri)
    if view is None:
        return []
    start, end = ls.offsets(view, params.range)
    return actions.actions(view, start, end, params.context.only or (), ls.session.documents, uri)


@server.feature(types.CODE_ACTION_RESOLVE)
def _resolve_action(ls: CspdiagServer, action: types.CodeAction) -> types.CodeAction:
    uri = action.data.get("uri") if isinstance(action.data, dict) else None
    view = ls.view(uri) if isinstance(uri, str) else None
    return action if view is None else actions.resolved(action, view, ls.session.documents)


@server.feature(types.TEXT_DOCUMENT_FORMATTING)
def _formatting(ls: CspdiagServer, params: types.DocumentFormattingParams) -> list[types.TextEdit] | None:
    document = ls.document(params.text_document.uri)
    return None if document is None else formatting.formatting(document, ls.session.positions)


@server.feature(types.TEXT_DOCUMENT_RANGE_FORMATTING)
def _range_formatting(ls: CspdiagServer, params: types.DocumentRangeFormattingParams) -> list[types.TextEdit] | None:
    document = ls.document(params.text_document.uri)
    lines = params.range.start.line, params.range.end.line
    return None if document is None else formatting.formatting(document, ls.session.positions, lines)


@server.feature(types.TEXT_DOCUMENT_FOLDING_RANGE)
def _folding(ls: CspdiagServer, params: types.FoldingRangeParams) -> list[types.FoldingRange]:
    document = ls.document(params.text_document.uri)
    return [] if document is None else folding.folding(document.source)


@server.feature(types.TEXT_DOCUMENT_SEMANTIC_TOKENS_FULL, highlighting.LEGEND)
def _tokens(ls: CspdiagServer, params: types.SemanticTokensParams) -> types.SemanticTokens:
    view = ls.view(params.text_document.uri)
    return types.SemanticTokens([]) if view is None else highlighting.semantic_tokens(view, ls.session.positions)


@server.feature(types.TEXT_DOCUMENT_SEMANTIC_TOKENS_RANGE, highlighting.LEGEND)
def _tokens_of_range(ls: CspdiagServer, params: types.SemanticTokensRangeParams) -> types.SemanticTokens:
    view = ls.view(params.text_document.uri)
    if view is None:
        return types.SemanticTokens([])
    return highlighting.semantic_tokens(view, ls.session.positions, *ls.offsets(view, params.range))


@server.feature(types.TEXT_DOCUMENT_INLAY_HINT)
def _hints(ls: CspdiagServer, params: types.InlayHintParams) -> list[types.InlayHint]:
    view = ls.view(params.text_document.uri)
    return [] if view is None else hints.hints(view, *ls.offsets(view, params.range), ls.session.positions)


@server.feature(types.TEXT_DOCUMENT_CODE_LENS)
def _lenses(ls: CspdiagServer, params: types.CodeLensParams) -> list[types.CodeLens]:
    uri = params.text_document.uri
    document, view = ls.document(uri), ls.view(uri)
    if document is None or view is None:
        return []
    commands = lenses.commands_of(ls.client_capabilities)
    return lenses.lenses(view, uri, ls.session.positions, commands, document.answered)


@server.command(lenses.VERIFY)
async def _verify(ls: CspdiagServer, *sent: object) -> str | None:
    """Prove an assertion; the answer is the title of its lens, and a diagnostic if it fails."""
    params = AssertionParams.of(sent)
    view = ls.view(params.uri)
    if view is None:
        return None
    assertion = lenses.assertion_at(view, params.line)
    if assertion is None:
        return None
    # While it is proved the text may change, and with it the places in the tree.
    asserted = lenses.asserted(assertion)
    try:
        found = await ls.prove(view, assertion)
    except ProvingError as problem:
        # The reason first: editors cut what is long.
        message = f"Not proved: {problem} (`{asserted}`)"
        ls.window_show_message(types.ShowMessageParams(types.MessageType.Error, message))
        return None
    except asyncio.CancelledError:
        return None
    view.answers.update({each.start: each for each in found})
    ls.answered(params.uri, view, asserted, found)
    return "\n".join(each.title for each in found)


@server.feature("cspdiag/program")
def _program(ls: CspdiagServer, sent: object) -> dict[str, Any] | None:
    """The files of an open program, by URI, its bodies included, and the fingerprint that its lenses have."""
    view = ls.view(ProgramParams.of(sent).uri)
    if view is None:
        return None
    names = (*view.files, *(path for path, digest in view.bodies.items() if digest is not None))
    return {"files": [ls.session.documents.uri(name) for name in names], "fingerprint": view.fingerprint}


@server.feature("cspdiag/diagram")
async def _diagram(ls: CspdiagServer, sent: object) -> dict[str, Any] | None:
    """A diagram of an open program, as docs/editors.md describes it."""
    params = DiagramParams.of(sent)
    view = ls.view(params.uri)
    if view is None:
        document = ls.session.documents.get(params.uri)
        return {"problem": "the file is not open" if document is None else too_large(document)}
    position = params.position
    request = {
        "main": view.main.name,
        "texts": view.files,
        "encoding": ls.session.positions.encoding,
        "offset": None if position is None else ls.session.positions.offset(view.main, position),
        **params.wanted,
    }
    try:
        # A picture that is wanted as a file takes the place of no other.
        answer = await ls.drawer.draw(f"{params.uri} {params.wanted.get('format', '')}", request)
    except DrawingError as problem:
        return {"problem": str(problem)}
    for part in (answer or {}).get("parts", ()):
        for place in part["places"]:
            place["uri"] = ls.session.documents.uri(place.pop("file"))
    return answer


def serve() -> None:
    """Serve an editor on standard input and output until it ends the connection."""
    sys.setrecursionlimit(max(sys.getrecursionlimit(), 10_000))
    # The thread that reads the input would wait for it, and nothing has to be finished.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    Garbage.prepare()
    server.start_io()
