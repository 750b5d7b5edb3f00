"""Programs of many elements of which fewer show that nothing is wrong."""

from __future__ import annotations

from cspdiag.base.record import node
from cspdiag.base.report import Report
from cspdiag.model.checks.rules import check as check_model
from cspdiag.model.names.resolve import resolve
from cspdiag.model.program import Program
from cspdiag.network.analyse import LARGEST_PROGRAM, Analysis
from cspdiag.network.check import check as check_network
from cspdiag.network.elaborate.fewer.alike import alike, keeps_values
from cspdiag.network.elaborate.fewer.varying import Varying


@node
class WithFewer:
    """A program with fewer elements in which nothing is wrong, and so nothing with all of them."""

    program: Program
    analysis: Analysis
    varying: Varying
    """What varies between the two."""


def clean_with_fewer(program: Program, sizes: dict[str, int]) -> WithFewer | None:
    """A program of many elements with these ``sizes`` in place of its own, by the names of the constants; None if they
    do not show that nothing is wrong with its processes.
    """
    report = Report()
    few = resolve(program.trees, {**program.overrides, **sizes}, report)
    check_model(few, report)
    varying = None if report.diagnostics else alike(program, few, LARGEST_PROGRAM)
    if varying is None:
        return None
    analysis = check_network(few, report)
    shapes = analysis.elaboration.shapes
    if report.diagnostics or any(map(keeps_values, (s for s in shapes if s.definition in varying.definitions))):
        return None
    return WithFewer(program=few, analysis=analysis, varying=varying)
