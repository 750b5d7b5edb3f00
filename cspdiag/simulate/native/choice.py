"""Whether a run is native, for those who leave it open: the results are the same, to the bit."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Final

from cspdiag.base.record import record
from cspdiag.codegen import target_errors
from cspdiag.network.ir.network import CoreNetwork
from cspdiag.pipeline import Reader
from cspdiag.simulate.native.build import CompilerError
from cspdiag.simulate.native.run import NativeProgram, build_program
from cspdiag.simulate.result import Run

if TYPE_CHECKING:
    from cspdiag.simulate.record.stored.inputs import RecordedInputs

_AS_NATIVE: Final = "as a native program"


@record
class NotNative:
    """Why a program runs in Python: ``reason`` is one line."""

    reason: str


def native_if_possible(
    network: CoreNetwork,
    read: Reader,
    *,
    level: int,
    environment: str | None,
    real_time: bool = False,
    measured: bool = False,
    inputs: RecordedInputs | None = None,
) -> NativeProgram | NotNative:
    """The native program, or why there is none: no C compiler, bodies and devices in Python, what C cannot express.

    Raises NoEnvironmentError.
    """
    try:
        return build_program(
            network, read, level=level, environment=environment, real_time=real_time, measured=measured, inputs=inputs
        )
    except (CompilerError, target_errors()) as problem:
        return NotNative(str(problem).partition("\n")[0])


def run_either(
    program: NativeProgram | NotNative, natively: Callable[[NativeProgram], Run], in_python: Callable[[], Run]
) -> Run:
    """The run of a native program, or in Python if there is none; ``Run.chosen_target`` says which."""
    if isinstance(program, NotNative):
        run = in_python()
        run.chosen_target = f"in Python: {program.reason}"
    else:
        run = natively(program)
        run.chosen_target = _AS_NATIVE
    return run
