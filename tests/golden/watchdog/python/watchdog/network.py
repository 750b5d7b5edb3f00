"""Builds the network from its drivers."""

from __future__ import annotations

from collections.abc import Mapping

from .oven import Oven
from .runtime import Driver, EventInput, EventOutput, Network, double, int64, integer, record
from .types import Reading

PORTS: tuple[str, ...] = ("thermometer", "heater", "losses")


def build(drivers: Mapping[str, Driver]) -> Network:
    """Connect the outermost process to its drivers, one for each name in `PORTS`."""
    thermometer = EventInput[Reading](
        "Oven.thermometer",
        driver=drivers["thermometer"],
        accepts=record(Reading, integer(int64), double),
    )
    heater = EventOutput[float]("Oven.heater", driver=drivers["heater"], safe=0.0)
    losses = EventOutput[int]("Oven.losses", driver=drivers["losses"], safe=0)
    return Network(
        Oven("Oven", thermometer=thermometer, heater=heater, losses=losses),
        ports=(thermometer, heater, losses),
    )
