"""Sessions of native programs."""

from __future__ import annotations

from importlib.util import find_spec
from typing import TYPE_CHECKING

from cspdiag.codegen import target_errors
from cspdiag.network.ir.external import external_bodies
from cspdiag.simulate.native.build import CompilerError, find_compiler
from cspdiag.simulate.run.execute import chosen_environment
from cspdiag.studio.engine.failure import RequestError

if TYPE_CHECKING:
    from cspdiag.network.ir.network import CoreNetwork
    from cspdiag.pipeline import Reader
    from cspdiag.simulate.record.stored.inputs import RecordedInputs
    from cspdiag.simulate.steered.run import SteeredRun


_IN_PYTHON = "run it in Python: what happens is the same"


def _runs_in_python(network: CoreNetwork, environment: str | None) -> bool:
    """Whether nothing is written in C."""
    chosen = chosen_environment(network, environment)
    bodies = external_bodies(network.classes, () if chosen is None else (chosen,))
    return not any(body.language == "c" for body in bodies)


def why_not_native() -> str | None:
    """Why no program can run as native code; None if it can."""
    if find_spec("numpy") is None:
        return "what a native program reports is read by numpy, which is not installed: pip install numpy"
    try:
        find_compiler()
    except CompilerError as problem:
        return str(problem).partition("\n")[0]
    return None


def native_run(
    network: CoreNetwork,
    read: Reader,
    environment: str | None,
    until: int | None,
    *,
    real_time: bool,
    inputs: RecordedInputs | None,
) -> SteeredRun:
    """The program, built and at time 0, or begun if it runs in ``real_time``. Raises RequestError for one that C cannot
    express or that cannot be built.
    """
    from cspdiag.simulate.native.run import build_program
    from cspdiag.simulate.steered.run import SteeredRun

    try:
        program = build_program(network, read, level=1, environment=environment, real_time=real_time, inputs=inputs)
    except (CompilerError, target_errors()) as problem:
        raise RequestError(str(problem), _IN_PYTHON if _runs_in_python(network, environment) else None) from problem
    return SteeredRun(program, until, inputs)
