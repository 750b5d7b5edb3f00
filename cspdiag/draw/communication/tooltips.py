"""The tooltips of elements: what they are, their types, periods and doc comments, and their places in the text."""

from __future__ import annotations

from collections.abc import Iterable

from cspdiag.draw.elements.diagram import Arrow, Box, BoxPort, Element, FlowKind, ParentPort, Sink, Store, WrittenValue
from cspdiag.draw.elements.texts import place_in_file
from cspdiag.model.sampling import Sampling

WORDS: dict[FlowKind, str] = {
    "sync": "rendezvous",
    "var": "variable",
    "broadcast": "broadcast",
    "any": "any",
    "buffer": "buffer",
    "overwrite": "overwriting buffer",
    "sampled": "sampled",
    "event": "event",
    "constant": "constant",
    "discard": "discarded",
}
"""The names of the kinds."""


def box_tooltip(box: Box) -> str:
    """An instance, with its arguments and the doc comment of its definition."""
    size = f"[{box.size}]" if box.size else ""
    arguments = f"({', '.join(box.arguments)})" if box.arguments else ""
    return _lines(
        f"{box.kind} {box.key}{size} : {box.definition}{arguments}",
        f"runs every {_either(map(Sampling, box.samples))}" if box.samples else "",
        f"hand-written in {box.language}" if box.language else "",
        _words(box.doc),
        _words(box.definition_doc),
        _place(box),
    )


def port_tooltip(port: BoxPort) -> str:
    """A port of an instance."""
    default = f" = {port.default}" if port.default is not None else ""
    period = f" @ {port.period}" if port.period else ""
    state = "" if port.is_connected else "left to its default" if port.default is not None else "not connected"
    return _lines(
        f"{port.direction} {port.key} : {port.type}{default}{period}",
        f"every {_either(port.periods)}" if port.periods else "",
        state,
        _words(port.doc),
        _place(port),
    )


def parent_port_tooltip(port: ParentPort) -> str:
    """A port of the process that is drawn."""
    period = f" @ {port.period}" if port.period else ""
    return _lines(
        f"{port.direction} {port.key}{port.size or ''} : {port.type}{period}",
        f"every {_either(port.periods)}" if port.periods else "",
        "handed over at once" if port.immediate else "",
        f"safe value {port.safe}" if port.safe else "",
        f"default {port.default}" if port.default else "",
        _kinds(port.kinds),
        _words(port.doc),
        _place(port),
    )


def store_tooltip(store: Store) -> str:
    """A variable, a label or a channel."""
    initial = f" = {store.initial}" if store.initial else ""
    what = "variable" if store.form == "label" else store.form
    kinds = "" if store.form != "channel" else _kinds(store.kinds)
    return _lines(f"{what} {store.key} : {store.type}{initial}", kinds, _words(store.doc), _place(store))


def arrow_tooltip(arrow: Arrow) -> str:
    """A communication relationship, or a communication of the process itself."""
    ends = f"{', '.join(map(str, arrow.sources))} → {', '.join(map(str, arrow.sinks))}"
    named = f"{arrow.label or ''}{f' : {arrow.type}' if arrow.type else ''}".strip()
    capacity = f" {arrow.capacity}" if arrow.capacity else ""
    return _lines(
        named,
        ends,
        "read or written by the process itself" if arrow.by_composition else "",
        f"{_kinds(arrow.kinds)}{capacity}",
        f"every {_either(arrow.periods)}" if arrow.periods else "",
        f"for {', '.join(arrow.repeated)}" if arrow.repeated else "",
        _words(arrow.doc),
        _place(arrow),
    )


def value_tooltip(value: WrittenValue) -> str:
    """What the process itself writes."""
    return _lines(f"writes {value.text}", _words(value.doc), _place(value))


def sink_tooltip(sink: Sink) -> str:
    """What takes values that nobody uses."""
    return _lines("discarded", _place(sink))


def _lines(*parts: str) -> str:
    return "\n".join(part for part in parts if part)


def _words(doc: str | None) -> str:
    return " ".join(doc.split()) if doc else ""


def _kinds(kinds: Iterable[FlowKind]) -> str:
    return ", ".join(WORDS[kind] for kind in kinds)


def _either(periods: Iterable[Sampling]) -> str:
    return " or ".join(map(str, periods))


def _place(element: Element) -> str:
    return place_in_file(element.spans[0]) if element.spans else ""
