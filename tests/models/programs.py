"""The models of the repository, compiled and run."""

from __future__ import annotations

from pathlib import Path

import cspdiag
from cspdiag.simulate.result import Run

MODELS = Path(__file__).parents[2] / "models"

LIBRARIES = {"jiwy/laws.csp", "jiwy/plant.csp", "dining/table.csp"}
"""Files that contain only definitions."""

DURATIONS = {"jiwy/jiwy.csp": "8 s", "cascade/cascade.csp": "100 ms"}
"""How long programs are run that would otherwise take long, or never end; the others end by themselves."""


def all_files() -> list[str]:
    """Names of the files below ``models/``, including libraries."""
    return sorted(path.relative_to(MODELS).as_posix() for path in MODELS.glob("*/*.csp"))


def programs() -> list[str]:
    """Names of the files that can be run."""
    return [name for name in all_files() if name not in LIBRARIES]


def run(
    name: str, *, environment: str | None = None, until: str | None = None, set: dict[str, str] | None = None
) -> Run:
    """Run a model in virtual time."""
    return cspdiag.load(MODELS / name).run(environment=environment, until=until, set=set or {})
