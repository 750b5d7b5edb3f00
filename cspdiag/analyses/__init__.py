"""Analyses of the finished network: one to a file, and one entry in ANALYSES."""

from __future__ import annotations

from typing import TYPE_CHECKING

from cspdiag.analyses.analysis import Analysis
from cspdiag.analyses.load import LOAD
from cspdiag.base import Report
from cspdiag.model.program import Program

if TYPE_CHECKING:
    from cspdiag.network.analyse import Analysis as Checked
    from cspdiag.network.ir.network import CoreNetwork

__all__ = ["ANALYSES", "Analysis", "analyse"]

ANALYSES: dict[str, Analysis] = {"load": LOAD}


def analyse(program: Program, checked: Checked, report: Report) -> CoreNetwork | None:
    """Run the analyses that concern a program without errors; only for them is it lowered. Returns the network, if any.

    ``checked`` is the result of the checks of its processes, with the same report.
    """
    concerned = [analysis for analysis in ANALYSES.values() if analysis.concerns(program, checked)]
    if not concerned:
        return None
    from cspdiag.network.lower.program import SelectionError, lower

    try:
        network = lower(program, None, None, {}, report, checked=checked)
    except SelectionError:
        return None
    if network is not None:
        for analysis in concerned:
            analysis.run(network, report)
    return network
