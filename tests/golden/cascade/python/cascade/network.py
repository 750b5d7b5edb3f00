"""Builds the network from its drivers."""

from __future__ import annotations

from collections.abc import Mapping

from .cascade import Cascade
from .runtime import Driver, Network, SampledInput, SampledOutput, double, ms, us

PORTS: tuple[str, ...] = ("reference", "speed", "current", "voltage")


def build(drivers: Mapping[str, Driver]) -> Network:
    """Connect the outermost process to its drivers, one for each name in `PORTS`."""
    reference = SampledInput[float](
        "Cascade.reference", period=1 * ms, driver=drivers["reference"], accepts=double
    )
    speed = SampledInput[float](
        "Cascade.speed", period=1 * ms, driver=drivers["speed"], accepts=double
    )
    current = SampledInput[float](
        "Cascade.current", period=100 * us, driver=drivers["current"], accepts=double
    )
    voltage = SampledOutput[float](
        "Cascade.voltage", period=100 * us, driver=drivers["voltage"], safe=0.0
    )
    return Network(
        Cascade("Cascade", reference=reference, speed=speed, current=current, voltage=voltage),
        ports=(reference, speed, current, voltage),
    )
