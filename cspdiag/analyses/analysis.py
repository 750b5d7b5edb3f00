"""What an analysis is."""

from __future__ import annotations

from collections.abc import Callable

from cspdiag.base import Report
from cspdiag.base.record import record
from cspdiag.model.program import Program
from cspdiag.network.ir.network import CoreNetwork


@record
class Analysis:
    """A pass over the finished network.

    ``concerns`` says cheaply whether a program gives it anything to report; ``run`` reports what it finds.
    """

    concerns: Callable[[Program], bool]
    run: Callable[[CoreNetwork, Report], None]
