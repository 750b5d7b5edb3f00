"""What can be said only of the finished network: one analysis a file, one row in ANALYSES."""

from __future__ import annotations

from cspdiag.analyses.analysis import Analysis
from cspdiag.analyses.load import LOAD
from cspdiag.diagnostics import Report
from cspdiag.model.program import Program

__all__ = ["ANALYSES", "Analysis", "analyse"]

ANALYSES: dict[str, Analysis] = {"load": LOAD}


def analyse(program: Program, report: Report) -> None:
    """Run every analysis that a program without errors gives rise to; only then is it lowered for them."""
    concerned = [analysis for analysis in ANALYSES.values() if analysis.concerns(program)]
    if not concerned:
        return
    from cspdiag.network.lower import SelectionError, lower

    try:
        network = lower(program, None, None, {}, report)
    except SelectionError:
        return
    if network is not None:
        for analysis in concerned:
            analysis.run(network, report)
