"""The interface of an analysis."""

from __future__ import annotations

from collections.abc import Callable

from cspdiag.base import Report
from cspdiag.base.record import record
from cspdiag.model.program import Program
from cspdiag.network.analyse import Analysis as Checked
from cspdiag.network.ir.network import CoreNetwork


@record
class Analysis:
    """An analysis of the finished network.

    ``concerns`` is a quick test of whether it may find anything, by the results of the checks; ``run`` reports what it
    finds.
    """

    concerns: Callable[[Program, Checked], bool]
    run: Callable[[CoreNetwork, Report], None]
