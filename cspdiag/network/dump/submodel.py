"""Control laws and the systems of environments as text."""

from __future__ import annotations

from collections.abc import Iterator

from cspdiag.model.constants.durations import duration
from cspdiag.network.dump.expression import expression_text
from cspdiag.network.ir.actions import RunLaw
from cspdiag.network.ir.equations import ExternalBody, ExternalCall, LinearBlock, SubmodelEquation
from cspdiag.network.ir.network import LocalChannel, Medium, Port, ProcessClass, SubmodelClass


def external_text(external: ExternalBody) -> str:
    """The text of an external body: ``python "plant.py:Joint"``."""
    return f'{external.language} "{external.target}"'


def doc_lines(doc: str | None) -> Iterator[str]:
    """The comment of a definition."""
    for line in (doc or "").splitlines():
        yield f"/// {line}".rstrip()


def port_text(port: Port) -> str:
    """The text of a port: ``in feedback : double<rad> @ T``."""
    size = "" if port.size is None else f"[{port.size}]"
    period = "" if port.period is None else f" @ {expression_text(port.period)}"
    return f"{port.direction} {port.name}{size} : {port.type}{period}{_media(port.media)}"


def _media(media: tuple[Medium, ...]) -> str:
    """The text of what a port of a specialized class is connected to, `` via sync, reads guarded``; for an array once
    if all are alike.
    """
    if not media:
        return ""
    alike = media[:1] if len(set(media)) == 1 else media
    return " via " + "; ".join(f"{m.kind}{guards_text(m)}" for m in alike)


def guards_text(place: Medium | LocalChannel) -> str:
    """The sides of a channel that alternatives guard."""
    return (", reads guarded" if place.guarded_reads else "") + (", writes guarded" if place.guarded_writes else "")


def submodel_body(law: SubmodelClass) -> Iterator[str]:
    """The lines inside the braces of a submodel class."""
    for port in law.ports:
        yield port_text(port)
    yield from memory_lines(law)
    yield from law_lines(law)


def memory_lines(owner: SubmodelClass | ProcessClass) -> Iterator[str]:
    """The constants and states of a control law."""
    for constant in owner.constants:
        yield f"constant {_equation(constant)}"
    for state in owner.states:
        kind = "continuous" if state.continuous else "discrete"
        yield f"state {state.name} : {state.type} = {expression_text(state.initial)} {kind}"


def law_lines(law: SubmodelClass | RunLaw) -> Iterator[str]:
    """The equations and next values of a control law."""
    for equation in law.equations:
        yield _equation(equation)
    for name, value in law.next_values:
        yield f"next {name} = {expression_text(value)}"
    for equation in law.derivative_equations:
        yield f"during the sample {_equation(equation)}"
    for name, value in law.derivatives:
        yield f"der {name} = {expression_text(value)}"
    for block in law.linear if isinstance(law, SubmodelClass) else ():
        yield from _linear_lines(block)
    if law.derivatives:
        step = "" if law.step is None else f" in steps of at most {duration(law.step)}"
        yield f"integrated by {law.method}{step}"


def _equation(equation: SubmodelEquation | ExternalCall) -> str:
    if isinstance(equation, SubmodelEquation):
        return f"{equation.name} : {equation.type} = {expression_text(equation.value)}"
    arguments = ", ".join(f"{name} = {expression_text(value)}" for name, value in equation.arguments)
    inputs = ", ".join(f"{name} = {expression_text(value)}" for name, value in equation.inputs)
    outputs = ", ".join(f"{name} : {kind}" for _, name, kind in equation.outputs)
    body = external_text(equation.external)
    return f"{outputs} = call {equation.name} : {equation.definition}({arguments}) {body} with {inputs}"


def _linear_lines(block: LinearBlock) -> Iterator[str]:
    """The states that move by a matrix, and their derivatives as sums."""
    for equation in block.equations:
        yield f"before the step {_equation(equation)}"
    for name, row, held in zip(block.states, block.matrix, block.held, strict=True):
        terms = [
            f"({expression_text(part)}) * {state}"
            for state, part in zip(block.states, row, strict=True)
            if part is not None
        ]
        terms += [] if held is None else [expression_text(held)]
        yield f"linear {name}: {' + '.join(terms) or '0'}"
