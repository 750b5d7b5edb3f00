"""Docstrings of generated classes."""

from __future__ import annotations

import textwrap

from cspdiag.codegen.python.text.layout import LINE_LENGTH
from cspdiag.model.types import TimeType
from cspdiag.network.ir.expressions import Expression
from cspdiag.network.ir.network import ClassParameter, Port, ProcessClass, SubmodelClass


def class_doc(class_: ProcessClass | SubmodelClass, place: str, kind: str) -> str:
    """The doc comment, the place in the text, the parameters and the ports of a class."""
    rows = [sentence(class_.doc) if class_.doc else f"The {kind} {class_.definition}.", "", f"Source: {place}"]
    if class_.parameters:
        rows += ["", "Parameters:", *(f"    {_parameter(item)}" for item in class_.parameters)]
    if class_.ports:
        rows += ["", "Ports:", *(f"    {_port(port)}" for port in class_.ports)]
    return "\n".join(rows)


def sentence(doc: str) -> str:
    """A doc comment in paragraphs that fit the line length; the first ends in a full stop."""
    paragraphs = [" ".join(part.split()) for part in doc.strip().split("\n\n")]
    if paragraphs[0][-1:] not in ".!?:":
        paragraphs[0] += "."
    return "\n\n".join(
        textwrap.fill(part, LINE_LENGTH - 8, break_long_words=False, break_on_hyphens=False) for part in paragraphs
    )


def _parameter(item: ClassParameter) -> str:
    if item.name == "sample" and item.derived:
        return "sample: the sample period in seconds."
    unit = ", in nanoseconds" if isinstance(item.type, TimeType) else ""
    unit += ", which may change" if item.tunable else ""
    return _with_doc(f"{item.name}: {item.type}{unit}", item.doc)


def _port(port: Port) -> str:
    size = f"[{port.size}]" if port.size is not None else ""
    period = f" @ {_period(port.period)}" if port.period is not None else ""
    return _with_doc(f"{port.name}{size}: {port.direction}, {port.type}{period}", port.doc)


def _with_doc(text: str, doc: str | None) -> str:
    return f"{text}. {' '.join(doc.split())}" if doc else f"{text}."


def _period(period: Expression) -> str:
    return " ".join(period.span.text.split()) if period.span is not None else str(getattr(period, "name", "?"))
