"""Ticks: the instants at which a sample period begins, counted in nanoseconds from the start of the program."""

from __future__ import annotations


def is_tick(instant: int, period: int) -> bool:
    """Whether a period begins at an instant."""
    return instant % period == 0


def latest_tick(instant: int, period: int) -> int:
    """The last tick up to an instant, which may be one itself."""
    return instant - instant % period


def next_tick(instant: int, period: int) -> int:
    """The first tick later than an instant."""
    return latest_tick(instant, period) + period
