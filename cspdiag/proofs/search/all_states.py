"""Every reachable state: by vectors of numpy (``breadth_first``), or, where there is no numpy, as in a browser, one
after the other (``one_by_one``), with the same answers.
"""

from __future__ import annotations

from functools import cache
from importlib.util import find_spec

from cspdiag.proofs.transitions.systems.system import System
from cspdiag.proofs.verdict import Limits, Verdict


@cache
def has_vectors() -> bool:
    """Whether numpy is installed."""
    return find_spec("numpy") is not None


def deadlock_free(system: System, limits: Limits) -> Verdict:
    """Whether no state is reachable in which nothing is possible and a process has not ended."""
    if has_vectors():
        from cspdiag.proofs.search import breadth_first

        return breadth_first.deadlock_free(system, limits)
    from cspdiag.proofs.search import one_by_one

    return one_by_one.deadlock_free(system, limits)


def knot_free(system: System, limits: Limits) -> Verdict:
    """Whether no state is reachable in which some processes wait for each other forever, whatever the others do."""
    if has_vectors():
        from cspdiag.proofs.search import breadth_first

        return breadth_first.knot_free(system, limits)
    from cspdiag.proofs.search import one_by_one

    return one_by_one.knot_free(system, limits)
