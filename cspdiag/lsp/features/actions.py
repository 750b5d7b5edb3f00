"""Code actions: the fixes of diagnostics, one by one or all that ``cspdiag check --fix`` would make."""

from __future__ import annotations

from collections.abc import Iterable

from lsprotocol import types

from cspdiag.base.diagnostic import Diagnostic, Edit
from cspdiag.editing.fixes import title_of
from cspdiag.editing.view import View
from cspdiag.fix import fix
from cspdiag.lsp.documents import Documents, identity, is_bundled
from cspdiag.lsp.features.diagnostics import diagnostic
from cspdiag.lsp.features.formatting import edits_between

FIX_ALL = f"{types.CodeActionKind.SourceFixAll.value}.cspdiag"


def actions(
    view: View, start: int, end: int, only: Iterable[str], documents: Documents, uri: str
) -> list[types.CodeAction]:
    """What can be done about the diagnostics between two offsets; ``only`` are the kinds that are wanted, if not all.

    What fixes everything is computed only when it is chosen: see ``resolved``.
    """
    wanted = tuple(only)
    found = []
    fixable = [each for each in view.diagnostics if each.edits and not _changes_bundled(each)]
    if _is_wanted(types.CodeActionKind.QuickFix.value, wanted):
        for each in fixable:
            if each.span.file == view.main.name and each.span.start <= end and start <= each.span.end:
                found.append(_quick_fix(each, documents))
    if fixable and _is_wanted(FIX_ALL, wanted):
        title = f"Fix {len(fixable)} of the diagnostics" if len(fixable) > 1 else "Fix what can be fixed"
        found.append(types.CodeAction(title, FIX_ALL, data={"uri": uri}))
    return found


def _is_wanted(kind: str, wanted: tuple[str, ...]) -> bool:
    return not wanted or any(kind == each or kind.startswith(f"{each}.") for each in wanted)


def _changes_bundled(found: Diagnostic) -> bool:
    return any(is_bundled(edit.span.file) for edit in found.edits)


def _quick_fix(found: Diagnostic, documents: Documents) -> types.CodeAction:
    positions = documents.positions
    return types.CodeAction(
        title_of(found),
        types.CodeActionKind.QuickFix,
        diagnostics=[diagnostic(found, positions, documents.uri)],
        is_preferred=True,
        edit=workspace_edit(found.edits, documents),
    )


def workspace_edit(edits: Iterable[Edit], documents: Documents) -> types.WorkspaceEdit:
    """Edits of several files."""
    changes: dict[str, list[types.TextEdit]] = {}
    for edit in edits:
        text = edit.replacement
        if "\n" in text:
            text = text.replace("\n", documents.style(edit.span.file).end)
        text_edit = types.TextEdit(documents.positions.range(edit.span), text)
        changes.setdefault(documents.uri(edit.span.file), []).append(text_edit)
    return types.WorkspaceEdit(changes={uri: list(several) for uri, several in changes.items()})


def resolved(action: types.CodeAction, view: View, documents: Documents) -> types.CodeAction:
    """The action that fixes everything, with its edits."""
    fixed = fix([view.main], documents.read, identity)
    changes = {
        documents.uri(file.before.name): edits_between(
            file.before, file.text, documents.positions, documents.style(file.before.name)
        )
        for file in fixed.files
    }
    action.edit = types.WorkspaceEdit(changes={uri: list(edits) for uri, edits in changes.items()})
    return action
