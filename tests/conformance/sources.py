"""The programs on which everything is compared."""

from __future__ import annotations

from pathlib import Path

from cspdiag import pipeline
from cspdiag.base import SourceFile
from cspdiag.base.render.text import render
from cspdiag.model.types import Real
from cspdiag.network.ir.network import CoreNetwork

ROOT = Path(__file__).parents[2]
LIBRARIES = {"models/jiwy/laws.csp", "models/jiwy/plant.csp", "models/dining/table.csp"}
"""Files without a program of their own."""
PYTHON_ONLY = {"models/jiwy_mujoco/contacts.csp"}
"""Files whose plants are written in Python, which neither C nor the reference can call."""


class InvalidProgramError(Exception):
    """A program with errors."""


def programs_in(folder: Path) -> list[str]:
    """The programs at any depth below a folder, as paths relative to the checkout if they are inside it."""
    paths = sorted(path.resolve() for path in folder.rglob("*.csp"))
    names = [(path.relative_to(ROOT) if path.is_relative_to(ROOT) else path).as_posix() for path in paths]
    return [name for name in names if name not in LIBRARIES | PYTHON_ONLY]


MODELS = programs_in(ROOT / "models")
PROGRAMS = programs_in(Path(__file__).parent / "programs")

JUST_AFTER = 1
"""Limits are between two instants, so it does not matter whether an instant at the limit still happens."""


def read(path: str) -> SourceFile:
    """A file of the checkout, or of any other folder."""
    return SourceFile(name=path, text=(ROOT / path).read_text(encoding="utf-8"))


def network_of(source: SourceFile, real: Real = "double") -> CoreNetwork:
    """The network of a program. Raises InvalidProgramError, with the diagnostics, if it has errors."""
    built = pipeline.build(source, read, real=real)
    if built.network is None:
        raise InvalidProgramError(render(built.checked.report.diagnostics))
    return built.network


def environments(network: CoreNetwork) -> list[str | None]:
    """The names of its environments without devices, which have no specification; or None to run without one."""
    return [environment.name for environment in network.environments if not environment.drivers] or [None]
