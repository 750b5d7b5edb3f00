"""The parameters of the program, which may change while it runs."""

from __future__ import annotations

from .runtime import Parameter, ProgramParameters, double, duration, integer, ms, record, s
from .types import ServoGains


class Parameters(ProgramParameters):
    """The parameters of Jiwy; each begins with its value in the text."""

    def __init__(self) -> None:
        super().__init__()
        # Servo of the horizontal joint; the first four are published.
        # jiwy.csp:11
        self.panGains = Parameter[ServoGains](
            "panGains",
            ServoGains(kp=2.6, tauD=50 * ms, beta=0.17, tauI=9 * s, friction=0.25, tolerance=0.004),
            record(
                ServoGains, double, integer(duration), double, integer(duration), double, double
            ),
        )
        # Servo of the vertical joint.
        # jiwy.csp:15
        self.tiltGains = Parameter[ServoGains](
            "tiltGains",
            ServoGains(
                kp=1.6, tauD=50 * ms, beta=0.001, tauI=10500 * ms, friction=0.165, tolerance=0.015
            ),
            record(
                ServoGains, double, integer(duration), double, integer(duration), double, double
            ),
        )
