"""Whether a run is native, for those who leave it open: the results are the same, to the bit."""

from __future__ import annotations

from typing import Final

from cspdiag.base.record import record
from cspdiag.codegen import target_errors
from cspdiag.network.ir.network import CoreNetwork
from cspdiag.pipeline import Reader
from cspdiag.simulate.native.build import CompilerError
from cspdiag.simulate.native.run import NativeProgram, build_program

AS_NATIVE: Final = "as a native program"


@record
class NotNative:
    """Why a program runs in Python: ``reason`` is one line."""

    reason: str

    @property
    def shown(self) -> str:
        """For the summary of the run."""
        return f"in Python: {self.reason}"


def native_if_possible(
    network: CoreNetwork,
    read: Reader,
    *,
    level: int,
    environment: str | None,
    real_time: bool = False,
    measured: bool = False,
) -> NativeProgram | NotNative:
    """The native program, or why there is none: no C compiler, bodies and devices in Python, what C cannot express.

    Raises NoEnvironmentError.
    """
    try:
        return build_program(
            network, read, level=level, environment=environment, real_time=real_time, measured=measured
        )
    except (CompilerError, target_errors()) as problem:
        return NotNative(str(problem).partition("\n")[0])
