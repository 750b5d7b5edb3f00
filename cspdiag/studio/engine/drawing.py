"""``draw``: a diagram as SVG, with what its elements represent in the text and in runs."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence

from cspdiag.base.errors import CspdiagError
from cspdiag.base.span import Span
from cspdiag.draw.deadlock.marks import definition_at, may_carry
from cspdiag.draw.elements.communication import Drawn
from cspdiag.draw.elements.composition import Activity, CompositionDiagram, Inside
from cspdiag.draw.elements.diagram import Arrow, Box, CommunicationDiagram, Element, ParentPort, Sink, Store
from cspdiag.draw.layout.graph import LayoutError
from cspdiag.draw.output.svg import embedded_svg, identifiers
from cspdiag.draw.pictures import PictureOptions, Pictures
from cspdiag.editing.view import View
from cspdiag.pipeline import Checked, compile_network
from cspdiag.studio.engine.data import Data, place_of
from cspdiag.studio.engine.failure import RequestError

_INDEX = re.compile(r"\[[^\]]*\]")
DEEPEST = 6
MOST_CHANNELS = 4000
"""Of larger programs the channels of relationships are not looked up."""


def draw(view: View, params: Data) -> Data:
    """A diagram of a process or of an environment; a program with mistakes is drawn as far as it can be read.

    Raises RequestError if there is nothing to draw, and LayoutError and MissingToolError if it cannot be laid out.
    """
    which = params.get("view", "communication")
    if which not in ("communication", "composition"):
        raise RequestError("`view` is communication or composition")
    depth = params.get("depth", 1)
    if not isinstance(depth, int) or not 1 <= depth <= DEEPEST:
        raise RequestError(f"`depth` is a whole number from 1 to {DEEPEST}")
    checked = view.checked
    if checked.readable is None:
        raise RequestError("the program cannot be read")
    fewer = checked.fewer
    analysis = fewer.checked.analysis if fewer is not None else checked.analysis
    pictures = Pictures(checked.readable, view.diagnostics, analysis)
    path, definition = _chosen(pictures, params.get("of"))
    options = PictureOptions(which="communication" if which == "communication" else "composition", depth=depth)
    try:
        scene = pictures.scene(definition, options)
    except LayoutError as problem:
        raise RequestError(str(problem)) from None
    found: dict[str, Data] = {}
    composition = pictures.composition(definition, depth)
    if which == "communication" or composition is None:
        channels = _channels(checked) if path.partition(".")[0] == _top(pictures) else []
        for key, element in _parts(pictures.communication(definition, depth), path, channels, ""):
            found.setdefault(key, element)
    else:
        found = dict(_steps(composition, path))
    elements = [{"id": identifier, **found[key]} for identifier, key in identifiers(scene).items() if key in found]
    return {
        "svg": embedded_svg(scene),
        "of": path,
        "name": definition.name.text,
        "place": place_of(definition.span),
        "whole": checked.program is not None,
        "elements": elements,
        "definitions": [each.name.text for each in pictures.drawn()],
    }


def _top(pictures: Pictures) -> str:
    found = pictures.outermost()
    return "" if found is None else found.name.text


def _chosen(pictures: Pictures, of: object) -> tuple[str, Drawn]:
    """What is drawn, and its path in runs: ``of`` is the name of a definition, or the path of an instance."""
    if of is None:
        outermost = pictures.outermost()
        if outermost is None:
            raise RequestError("there is no process to draw")
        return outermost.name.text, outermost
    if not isinstance(of, str):
        raise RequestError("`of` is the name of a process or of an environment, or the path of an instance")
    parts = of.split(".")
    found = pictures.named(of) if len(parts) == 1 else definition_at(pictures.program, parts)
    if found is None:
        raise RequestError(f"there is no process or environment `{of}` to draw")
    return of, found


def _channels(checked: Checked) -> Sequence[str]:
    """The channels of the outermost process by their full names, if the program has no errors."""
    try:
        network = checked.network or compile_network(checked)
    except CspdiagError:
        return []
    return [] if network is None or len(network.nets) > MOST_CHANNELS else [net.path for net in network.nets]


def _parts(
    diagram: CommunicationDiagram, path: str, channels: Sequence[str], prefix: str
) -> Iterator[tuple[str, Data]]:
    """The elements of a diagram by the key that they have in the picture."""
    own = _own_channels(path, channels)
    for element in diagram.elements():
        yield prefix + element.key, _described(element, path, own)
    for box in diagram.boxes:
        for port in box.ports:
            name = f"{box.key}{'' if port.key.startswith('[') else '.'}{port.key}"
            yield f"{prefix}{box.key}|{port.key}", {"kind": "port", "name": name, "places": _places(port.spans)}
        if box.inside is not None:
            yield from _parts(box.inside, f"{path}.{box.key}", channels, f"{prefix}{box.key}/")


def _own_channels(path: str, channels: Sequence[str]) -> Mapping[str, str]:
    """The channels that the process at a path owns, or that begin at its instances: full names by names inside it. An
    element of an array has all of them.
    """
    depth = path.count(".") + 1
    found = {}
    for channel in channels:
        parts = channel.split(".")
        if _INDEX.sub("", ".".join(parts[:depth])) == _INDEX.sub("", path):
            found[channel] = ".".join(parts[depth:])
    return found


def _described(element: Element, path: str, channels: Mapping[str, str]) -> Data:
    described: Data = {"name": element.key, "doc": element.doc, "places": _places(element.spans)}
    match element:
        case Box():
            described |= {
                "kind": "process" if element.kind == "unknown" else element.kind,
                "path": f"{path}.{element.key}",
                "definition": element.definition,
                "array": element.size is not None,
                "unfolded": element.inside is not None,
            }
        case ParentPort():
            described |= {"kind": "port", "direction": element.direction, "type": element.type}
            described["channels"] = _named(element.key, channels)
        case Arrow():
            described |= {
                "kind": "channel",
                "name": element.label or element.key,
                "type": element.type,
                "kinds": list(element.kinds),
                "channels": [full for full, name in channels.items() if may_carry(element, name)],
            }
        case Store():
            described |= {"kind": element.form, "type": element.type, "channels": _named(element.key, channels)}
        case Sink():
            described["kind"] = "sink"
        case _:  # There are no others with a meaning of their own in runs.
            described["kind"] = "value"
    return described


def _named(key: str, channels: Mapping[str, str]) -> list[str]:
    return [full for full, name in channels.items() if _INDEX.sub("", name) == key]


def _steps(diagram: CompositionDiagram, path: str) -> Iterator[tuple[str, Data]]:
    """The elements of a composition diagram by the key that they have in the picture."""
    around = {f"{path}": ""}
    for element in diagram.elements():
        kind = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", type(element).__name__).lower()
        described: Data = {"kind": kind, "name": element.key, "doc": element.doc, "places": _places(element.spans)}
        holder = max((each for each in around if _is_inside(element.key, around[each])), key=len)
        if isinstance(element, Activity | Inside):
            described["name"] = element.text
            if isinstance(element, Inside) or element.form == "run":
                described |= {"path": f"{holder}.{element.text}", "definition": element.definition}
            else:
                described["form"] = element.form
            if isinstance(element, Inside):
                around[f"{holder}.{element.text}"] = element.key
        yield f"step-{element.key}", described


def _is_inside(key: str, around: str) -> bool:
    return not around or key.startswith(f"{around}.")


def _places(spans: Sequence[Span]) -> list[Data]:
    return [place_of(span) for span in spans]
