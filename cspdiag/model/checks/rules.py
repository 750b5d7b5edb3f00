"""All checks of definitions, one module per family; each is a function of the resolved program and the report."""

from __future__ import annotations

from cspdiag.base import Report
from cspdiag.model.checks.compositions import check_compositions
from cspdiag.model.checks.constants import check_constants
from cspdiag.model.checks.equations import check_equations
from cspdiag.model.checks.ports import check_ports
from cspdiag.model.checks.relationships import check_relationships
from cspdiag.model.program import Program
from cspdiag.model.remembered import ALWAYS, Checks

CHECKS = (
    check_ports,
    check_relationships,
    check_compositions,
    check_equations,
)


def check(program: Program, report: Report, checks: Checks = ALWAYS) -> None:
    """Report everything that is wrong with the definitions of a program, each considered separately."""
    check_constants(program, report, checks)
    for family in CHECKS:
        family(program, report)
