"""How much the suite tries: a part of what `make hunt` does, which sets the environment variable THOROUGH."""

from __future__ import annotations

import os
from collections.abc import Iterable
from typing import TypeVar

THOROUGH = bool(os.environ.get("THOROUGH"))

Value = TypeVar("Value")


def usual_or_thorough(usual: int, thorough: int) -> int:
    """How many programs to try, or how many answers of a kind to expect."""
    return thorough if THOROUGH else usual


def at_levels(values: Iterable[Value]) -> list[tuple[Value, int]]:
    """Every value with both levels of optimization if the tests are thorough, or else with each in turn."""
    return [
        (value, level) for number, value in enumerate(values) for level in (0, 1) if THOROUGH or number % 2 == level
    ]
