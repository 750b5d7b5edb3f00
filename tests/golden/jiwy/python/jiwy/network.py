"""Builds the network from its drivers."""

from __future__ import annotations

from collections.abc import Mapping

from .jiwy import Jiwy
from .parameters import Parameters
from .runtime import (
    Driver,
    EventInput,
    Network,
    SampledInput,
    SampledOutput,
    double,
    int64,
    integer,
    ms,
)

PORTS: tuple[str, ...] = (
    "joystick_horizontal",
    "joystick_vertical",
    "joystick_buttons",
    "feedback_horizontal",
    "feedback_vertical",
    "control_horizontal",
    "control_vertical",
)


def build(drivers: Mapping[str, Driver], parameters: Parameters | None = None) -> Network:
    """Connect the outermost process to its drivers, one for each name in `PORTS`."""
    parameters = parameters or Parameters()
    joystick_horizontal = SampledInput[float](
        "Jiwy.joystick_horizontal",
        period=2 * ms,
        driver=drivers["joystick_horizontal"],
        accepts=double,
    )
    joystick_vertical = SampledInput[float](
        "Jiwy.joystick_vertical", period=1 * ms, driver=drivers["joystick_vertical"], accepts=double
    )
    joystick_buttons = EventInput[int](
        "Jiwy.joystick_buttons",
        driver=drivers["joystick_buttons"],
        kind="broadcast",
        accepts=integer(int64),
    )
    feedback_horizontal = SampledInput[float](
        "Jiwy.feedback_horizontal",
        period=2 * ms,
        driver=drivers["feedback_horizontal"],
        accepts=double,
    )
    feedback_vertical = SampledInput[float](
        "Jiwy.feedback_vertical", period=1 * ms, driver=drivers["feedback_vertical"], accepts=double
    )
    control_horizontal = SampledOutput[float](
        "Jiwy.control_horizontal", period=2 * ms, driver=drivers["control_horizontal"], safe=0.0
    )
    control_vertical = SampledOutput[float](
        "Jiwy.control_vertical", period=1 * ms, driver=drivers["control_vertical"], safe=0.0
    )
    return Network(
        Jiwy(
            "Jiwy",
            panGains=parameters.panGains,
            tiltGains=parameters.tiltGains,
            joystick_horizontal=joystick_horizontal,
            joystick_vertical=joystick_vertical,
            joystick_buttons=joystick_buttons,
            feedback_horizontal=feedback_horizontal,
            feedback_vertical=feedback_vertical,
            control_horizontal=control_horizontal,
            control_vertical=control_vertical,
        ),
        ports=(
            joystick_horizontal,
            joystick_vertical,
            joystick_buttons,
            feedback_horizontal,
            feedback_vertical,
            control_horizontal,
            control_vertical,
        ),
        parameters=parameters,
    )
