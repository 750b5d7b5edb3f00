"""The rules for definitions, one module per family; each is a function of the resolved program and the report."""

from __future__ import annotations

from cspdiag.diagnostics import Report
from cspdiag.model.program import Program


def check(program: Program, report: Report) -> None:
    """Report everything that is wrong with the definitions of a program, each by itself."""
