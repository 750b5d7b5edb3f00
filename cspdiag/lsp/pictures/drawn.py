"""What is drawn for an editor: a diagram, with the places in the text that its elements represent."""

from __future__ import annotations

import json
import sys
from base64 import b64encode
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, get_args

from cspdiag.base.errors import CspdiagError
from cspdiag.base.parent import lines_of_input
from cspdiag.base.record import record
from cspdiag.base.sources import given_source
from cspdiag.base.span import SourceFile, Span
from cspdiag.draw.elements.communication import Drawn
from cspdiag.draw.elements.diagram import Box, CommunicationDiagram
from cspdiag.draw.layout import engine
from cspdiag.draw.output.formats import FORMATS, rendered
from cspdiag.draw.output.svg import embedded_svg, identifiers
from cspdiag.draw.pictures import PictureOptions, Pictures, Which
from cspdiag.draw.scene.palette import Scheme
from cspdiag.draw.scene.shapes import Scene
from cspdiag.editing.positions import Encoding
from cspdiag.lsp.positions import Positions
from cspdiag.pipeline import Checked, check


@record
class Request:
    """A diagram of a program, of which all files are given as ``texts``, None for those that could not be read.

    It is that of ``process``, or else of the definition around ``offset``, or else of the outermost process. With
    ``format`` (``svg``, ``png``, ``pdf``) it is wanted as a file, in the colours of ``scheme``.
    """

    main: str
    texts: Mapping[str, str | None]
    encoding: Encoding = "utf-16"
    process: str | None = None
    offset: int | None = None
    which: Which = "both"
    format: str | None = None
    scheme: str = "auto"


def serve() -> None:
    """Answer each line of the standard input, a request as JSON, by one line of the standard output, until the input
    ends.
    """
    output = sys.stdout
    # Whatever the compiler prints does not belong to an answer.
    sys.stdout = sys.stderr
    engine.start()
    for line in lines_of_input():
        output.write(json.dumps(answer(Request(**json.loads(line)))) + "\n")
        output.flush()


def answer(request: Request) -> dict[str, Any]:
    """The diagram as an object of JSON; ``problem`` says why there is none."""

    def read(name: str) -> SourceFile:
        return given_source(name, request.texts)

    unknown = _unknown(request)
    if unknown is not None:
        return {"problem": unknown}
    checked = check(read(request.main), read)
    try:
        return _drawn(request, checked)
    except CspdiagError as problem:
        return {"problem": str(problem)}


def _unknown(request: Request) -> str | None:
    """What a request has that is none of the values there are."""
    allowed: tuple[tuple[str, object, Sequence[str]], ...] = (
        ("which", request.which, get_args(Which)),
        ("format", request.format, FORMATS),
        ("scheme", request.scheme, [scheme.value for scheme in Scheme]),
    )
    for name, value, values in allowed:
        if value is not None and value not in values:
            return f"`{name}` is {', '.join(values[:-1])} or {values[-1]}, not {json.dumps(value)}"
    return None


def _drawn(request: Request, checked: Checked) -> dict[str, Any]:
    if checked.readable is None:
        return {"problem": "the program cannot be read"}
    pictures = Pictures(checked.readable, checked.report.diagnostics, checked.analysis)
    definition = _chosen(pictures, request)
    if definition is None:
        syntax = "the text has mistakes in its syntax, and without what has them "
        wanted = "process" if request.process is None else f"`{request.process}`"
        return {"problem": f"{'' if checked.program is not None else syntax}there is no {wanted} to draw"}
    scene = pictures.scene(definition, PictureOptions(which=request.which))
    if request.format is not None:
        return {"data": b64encode(rendered([scene], request.format, request.scheme)).decode()}
    positions = Positions(request.encoding)
    return {
        "name": definition.name.text,
        "svg": embedded_svg(scene),
        # Of a text with mistakes in its syntax, the definitions with mistakes are left out.
        "whole": checked.program is not None,
        "parts": list(_parts(scene, pictures, definition, positions)),
        "definitions": [{"name": each.name.text, **_place(each.span, positions)} for each in pictures.drawn()],
    }


def _chosen(pictures: Pictures, request: Request) -> Drawn | None:
    if request.process is not None:
        return pictures.named(request.process)
    at = request.offset
    if at is not None:
        for definition in pictures.drawn():
            if definition.span.start <= at <= definition.span.end:
                return definition
    return pictures.outermost()


def _parts(scene: Scene, pictures: Pictures, definition: Drawn, positions: Positions) -> Iterator[dict[str, Any]]:
    """The elements of a picture: identifier in the SVG, key, places in the text, and the definition of an instance that
    has a diagram, too.
    """
    places: dict[str, tuple[Span, ...]] = {}
    inside: dict[str, str] = {}
    communication = pictures.communication(definition)
    places |= {element.key: element.spans for element in communication.elements()}
    places |= _ports(communication)
    for vertex in communication.vertices:
        if isinstance(vertex, Box) and pictures.named(vertex.definition) is not None:
            inside[vertex.key] = vertex.definition
    composition = pictures.composition(definition)
    if composition is not None:
        places |= {f"step-{element.key}": element.spans for element in composition.elements()}
    for identifier, key in identifiers(scene).items():
        found = [_place(span, positions) for span in places.get(key, ())]
        if found:
            yield {"id": identifier, "key": key, "places": found, "inside": inside.get(key)}


def _ports(diagram: CommunicationDiagram) -> dict[str, tuple[Span, ...]]:
    return {f"{box.key}|{port.key}": port.spans for box in diagram.boxes for port in box.ports}


def _place(span: Span, positions: Positions) -> dict[str, Any]:
    found = positions.range(span)
    return {
        "file": span.file,
        "range": {
            "start": {"line": found.start.line, "character": found.start.character},
            "end": {"line": found.end.line, "character": found.end.character},
        },
    }
