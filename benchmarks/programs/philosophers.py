"""The philosophers of ``networks/philosophers.csp`` as a transition system."""

from __future__ import annotations

from pathlib import Path

from cspdiag.base.sources import read_source
from cspdiag.pipeline import build
from cspdiag.proofs.transitions import transition_system
from cspdiag.proofs.transitions.systems.system import System

PROGRAM = str(Path(__file__).parents[1] / "networks/philosophers.csp")


def table(number: int) -> System:
    """``count`` philosophers, one of whom takes the forks in the opposite order."""
    built = build(read_source(PROGRAM), read_source, top="Table", settings={"number": str(number)})
    assert built.network is not None
    return transition_system(built.network)
