"""The philosophers of ``networks/philosophers.csp`` as a transition system."""

from __future__ import annotations

from pathlib import Path

from cspdiag.analyses.transitions import transition_system
from cspdiag.analyses.transitions.system import System
from cspdiag.pipeline import build
from cspdiag.sources import read_source

PROGRAM = str(Path(__file__).parents[1] / "networks/philosophers.csp")


def table(number: int) -> System:
    """So many philosophers, one of whom takes the forks the other way round."""
    built = build(read_source(PROGRAM), read_source, top="Table", settings={"number": str(number)})
    assert built.network is not None
    return transition_system(built.network)
