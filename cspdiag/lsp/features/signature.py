"""Signature help: the parameters of what is called or instantiated, while arguments are written."""

from __future__ import annotations

from lsprotocol import types

from cspdiag.editing import descriptions, text_at
from cspdiag.editing.view import View
from cspdiag.model.expressions.functions import FUNCTIONS
from cspdiag.syntax import ast


def signature(view: View, offset: int) -> types.SignatureHelp | None:
    """The signature of the innermost call around an offset."""
    source = view.tree.source
    outlined = text_at.definition_at(source, offset)
    before = text_at.tokens(source, outlined.start if outlined is not None else 0, offset)
    called = text_at.called([token for token in before if token.kind != "comment"])
    if called is None:
        return None
    definition = view.program.definitions.get(called.name)
    match definition:
        case ast.ProcessDefinition() | ast.SubmodelDefinition() | ast.DriverDefinition():
            parts = [descriptions.parameter_code(each) for each in definition.parameters]
            label, docs = descriptions.signature(definition), [each.doc for each in definition.parameters]
            names = [each.name.text for each in definition.parameters]
        case ast.StructDefinition():
            parts = [f"{each.name.text}: {each.type.span.text}" for each in definition.fields]
            label, docs = f"{called.name}({', '.join(parts)})", [each.doc for each in definition.fields]
            names = [each.name.text for each in definition.fields]
        case _ if called.name in FUNCTIONS:
            label = FUNCTIONS[called.name].written
            names = parts = [part.strip() for part in label[len(called.name) + 1 : -1].split(",")]
            docs = [None] * len(parts)
        case _:  # A name without parameters, or without a meaning.
            return None
    if not parts:
        return None
    found = types.SignatureInformation(
        label,
        documentation=_markdown(getattr(definition, "doc", None)),
        parameters=[types.ParameterInformation(part, _markdown(doc)) for part, doc in zip(parts, docs, strict=True)],
    )
    active = names.index(called.present) if called.present in names else min(called.count, len(parts) - 1)
    return types.SignatureHelp([found], active_signature=0, active_parameter=active)


def _markdown(doc: str | None) -> types.MarkupContent | None:
    return None if doc is None else types.MarkupContent(types.MarkupKind.Markdown, doc)
