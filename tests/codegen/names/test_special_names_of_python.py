"""Names that begin with two underscores: Python would add the class to ``__x``, and sets ``__class__`` itself."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import pytest

import cspdiag
from tests.codegen.names.test_nasty_names import PROGRAM, ROLES

SPECIAL = [
    "__debug__",
    "__class__",
    "__dict__",
    "__init__",
    "__slots__",
    "__new__",
    "__doc__",
    "__module__",
    "__builtins__",
    "__spec__",
    "__package__",
    "__name__",
    "__getattr__",
    "__annotations__",
    "__set_name__",
    "__main__",
]
"""Names that mean something to Python."""


def require_equal_runs(names: Mapping[str, str], folder: Path, level: int) -> None:
    """The program with these names for its roles does in generated Python what it does on the reference."""
    file = folder / "plant.csp"
    file.write_text(PROGRAM.format(**names))
    program = cspdiag.load(file)
    expected, run = program.run(until="20 ms", level="reference"), program.run(until="20 ms", level=level)
    for role in ("level", "event", "drive", "lamp"):
        assert (*run[names[role]],) == (*expected[names[role]],), role


@pytest.mark.parametrize("level", [0, 1])
def test_names_are_not_those_of_a_class(level: int, tmp_path: Path) -> None:
    require_equal_runs({role: f"__{role}" for role in ROLES}, tmp_path, level)


@pytest.mark.parametrize("level", [0, 1])
@pytest.mark.parametrize("first", range(0, len(ROLES), 4))
def test_names_that_python_sets_itself(first: int, level: int, tmp_path: Path) -> None:
    names = {role: f"{role[:1]}{number}q" for number, role in enumerate(ROLES)}
    require_equal_runs(names | dict(zip([*ROLES[first:], *ROLES[:first]], SPECIAL, strict=False)), tmp_path, level)
