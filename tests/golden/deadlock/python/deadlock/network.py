"""Builds the network from its drivers."""

from __future__ import annotations

from collections.abc import Mapping

from .runtime import Driver, Network
from .symmetric_table import SymmetricTable

PORTS: tuple[str, ...] = ()


def build(drivers: Mapping[str, Driver]) -> Network:
    """Connect the outermost process to its drivers, one for each name in `PORTS`."""
    return Network(SymmetricTable("SymmetricTable"))
