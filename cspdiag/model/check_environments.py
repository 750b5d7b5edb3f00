"""What environments say besides their relationships."""

from __future__ import annotations

from cspdiag.diagnostics import Report
from cspdiag.model.context import nearest
from cspdiag.model.diagnostics_arguments import UnknownOption
from cspdiag.model.program import Program
from cspdiag.syntax import ast

_ON_MISS = ("timeout", "count")


def check_environments(program: Program, report: Report) -> None:
    """Check the options of environments."""
    for definition in program.definitions.values():
        if isinstance(definition, ast.EnvironmentDefinition) and definition.on_miss is not None:
            option = definition.on_miss
            if option.text not in _ON_MISS:
                refused = UnknownOption(
                    option.span,
                    owner="what happens on a miss",
                    option=option.text,
                    options=_ON_MISS,
                    suggestion=nearest(option.text, _ON_MISS),
                )
                report.add(refused)
