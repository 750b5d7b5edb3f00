"""Builds the network from its drivers."""

from __future__ import annotations

from collections.abc import Mapping

from .line import Line
from .runtime import Driver, EventOutput, Network

PORTS: tuple[str, ...] = ("done",)


def build(drivers: Mapping[str, Driver]) -> Network:
    """Connect the outermost process to its drivers, one for each name in `PORTS`."""
    done = EventOutput[int]("Line.done", driver=drivers["done"], safe=0)
    return Network(Line("Line", done=done), ports=(done,))
