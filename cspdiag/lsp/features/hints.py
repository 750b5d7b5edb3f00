"""Inlay hints: what was inferred and is not in the text, kinds and periods."""

from __future__ import annotations

from collections.abc import Iterator

from lsprotocol import types

from cspdiag.editing.view import View
from cspdiag.lsp.positions import Positions
from cspdiag.model.constants.durations import duration
from cspdiag.syntax import ast
from cspdiag.syntax.walk import declarations


def hints(view: View, start: int, end: int, positions: Positions) -> list[types.InlayHint]:
    """The hints between two offsets."""
    found = []
    for item in view.tree.items:
        if item.span.start <= end and start <= item.span.end:
            for offset, text, tooltip in _of(view, item):
                if start <= offset <= end:
                    place = positions.position(view.tree.source, offset)
                    found.append(types.InlayHint(place, text, tooltip=tooltip, padding_left=True))
    return found


def _of(view: View, item: ast.Item) -> Iterator[tuple[int, str, str]]:
    match item:
        case ast.ProcessDefinition():
            for ports in item.ports:
                yield from _period(view, item, ports)
            if item.communication is not None:
                for declaration in declarations(item.communication.declarations):
                    yield from _declared(view, item, declaration)
        case ast.EnvironmentDefinition():
            for declaration in declarations(item.declarations):
                yield from _declared(view, item, declaration)
        case _:  # Nothing is inferred about other definitions.
            pass


def _period(view: View, owner: ast.ProcessDefinition, ports: ast.Ports) -> Iterator[tuple[int, str, str]]:
    """The values of a period that is written with names."""
    if ports.sampling is None or isinstance(ports.sampling.period, ast.Duration):
        return
    found = view.facts.stated_periods(owner, ports.names[0].name.text)
    if found:
        values = " or ".join(str(sampling) for sampling in found)
        yield ports.sampling.span.end, f"= {values}", "the sample periods in this program"


def _declared(
    view: View, owner: ast.ProcessDefinition | ast.EnvironmentDefinition, item: ast.Declaration
) -> Iterator[tuple[int, str, str]]:
    match item:
        case ast.Instance():
            periods = view.facts.samples(owner, item)
            if periods:
                values = " or ".join(duration(period) for period in periods)
                yield item.span.end, f"@ {values}", "how often the submodel runs"
        case ast.Connection() | ast.Channel():
            flow = view.facts.channel(owner, item)
            if item.kind is None and flow.kinds:
                yield item.span.end, " or ".join(flow.kinds), "the inferred kind of the channel"
        case ast.Variable() | ast.RepeatedDeclarations():
            pass
