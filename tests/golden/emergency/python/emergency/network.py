"""Builds the network from its drivers."""

from __future__ import annotations

from collections.abc import Mapping

from .runtime import (
    Driver,
    EventInput,
    EventOutput,
    Network,
    SampledInput,
    SampledOutput,
    double,
    enumeration,
    ms,
)
from .spindle import Spindle
from .types import Button

PORTS: tuple[str, ...] = ("panel", "feedback", "control", "brake", "halted")


def build(drivers: Mapping[str, Driver]) -> Network:
    """Connect the outermost process to its drivers, one for each name in `PORTS`."""
    panel = EventInput[Button](
        "Spindle.panel", driver=drivers["panel"], accepts=enumeration(Button)
    )
    feedback = SampledInput[float](
        "Spindle.feedback", period=2 * ms, driver=drivers["feedback"], accepts=double
    )
    control = SampledOutput[float](
        "Spindle.control", period=2 * ms, driver=drivers["control"], safe=0.0
    )
    brake = SampledOutput[bool]("Spindle.brake", period=2 * ms, driver=drivers["brake"], safe=True)
    halted = EventOutput[bool]("Spindle.halted", driver=drivers["halted"], safe=False)
    return Network(
        Spindle(
            "Spindle", panel=panel, feedback=feedback, control=control, brake=brake, halted=halted
        ),
        ports=(panel, feedback, control, brake, halted),
    )
