"""How much the suite tries: a part of what `make hunt` does, which sets the environment variable THOROUGH."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from typing import TypeVar

THOROUGH = bool(os.environ.get("THOROUGH"))

Value = TypeVar("Value")
Way = TypeVar("Way")


def usual_or_thorough(usual: int, thorough: int) -> int:
    """How many programs to try, or how many answers of a kind to expect."""
    return thorough if THOROUGH else usual


def in_turn(values: Iterable[Value], ways: Sequence[Way]) -> list[tuple[Value, Way]]:
    """Every value in each way if the tests are thorough, or else in one of them in turn."""
    return [
        (value, way)
        for number, value in enumerate(values)
        for place, way in enumerate(ways)
        if THOROUGH or number % len(ways) == place
    ]


def at_levels(values: Iterable[Value]) -> list[tuple[Value, int]]:
    """Every value with both levels of optimization if the tests are thorough, or else with each in turn."""
    return in_turn(values, (0, 1))
