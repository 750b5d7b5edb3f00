"""The inputs of a run from a recording in a file."""

from __future__ import annotations

from typing import TYPE_CHECKING

from cspdiag.simulate.record.stored.described import head_of
from cspdiag.simulate.record.stored.inputs import RecordedInputs, recorded_inputs
from cspdiag.simulate.record.stored.open_recording import open_recording
from cspdiag.simulate.record.stored.parameters import parameters_signal
from cspdiag.simulate.record.stored.recording import InputsError
from cspdiag.simulate.run.execute import chosen_environment

if TYPE_CHECKING:
    from cspdiag.network.ir.network import CoreNetwork

ENDINGS = (".csv", ".npz", ".mcap", ".parquet")
"""Of recordings that are files."""


class NoInputsError(InputsError):
    """The program, or its environment, takes no inputs from a recording."""


def inputs_of(network: CoreNetwork, environment: str | None, path: str) -> RecordedInputs:
    """The inputs in the recording at ``path``, for a run in the environment of that name, or in the first.

    Raises NoEnvironmentError, NoInputsError, InputsError for a recording that does not fit, RecordingError,
    MissingPackageError, and OSError.
    """
    chosen = chosen_environment(network, environment)
    if chosen is None:
        raise NoInputsError("a recording is for programs with ports: this one has none")
    if chosen.drivers:
        raise NoInputsError(f"{chosen.name} has devices; choose an environment that is only simulated")
    parameters = parameters_signal(network)
    signals = (*head_of(network, chosen).ports, *(() if parameters is None else (parameters,)))
    return recorded_inputs(network, chosen, open_recording(path, signals))
