"""The interface of an analysis."""

from __future__ import annotations

from collections.abc import Callable

from cspdiag.base import Report
from cspdiag.base.record import record
from cspdiag.model.program import Program
from cspdiag.network.ir.network import CoreNetwork


@record
class Analysis:
    """An analysis of the finished network.

    ``concerns`` is a quick test of whether a program needs it; ``run`` reports what it finds.
    """

    concerns: Callable[[Program], bool]
    run: Callable[[CoreNetwork, Report], None]
