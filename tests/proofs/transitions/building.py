"""Systems of programs that are written in a test."""

from __future__ import annotations

from cspdiag import pipeline
from cspdiag.base import SourceFile
from cspdiag.base.render.text import render
from cspdiag.proofs.transitions import transition_system
from cspdiag.proofs.transitions.systems.dump import dump
from cspdiag.proofs.transitions.systems.system import Component, System


def _nothing(path: str) -> SourceFile:
    raise FileNotFoundError(path)


def system_of(text: str, top: str | None = None) -> System:
    """The system of the outermost process of a text."""
    built = pipeline.build(SourceFile(name="test.csp", text=text), _nothing, top=top)
    assert built.network is not None, render(built.checked.report.diagnostics)
    return transition_system(built.network)


def component(system: System, name: str) -> Component:
    """The component with that name."""
    (found,) = (one for one in system.components if one.name == name)
    return found


def listing(system: System, name: str | None = None) -> str:
    """The text form of one component, or of all, without places."""
    lines = [line.split(" //")[0].rstrip() for line in dump(system).splitlines()]
    if name is not None:
        start = next(number for number, line in enumerate(lines) if line.split(" ", 1)[-1] == f"{name} {{")
        lines = lines[start + 1 : lines.index("}", start)]
    return "\n".join(line.strip() for line in lines)
