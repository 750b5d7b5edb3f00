"""The parameters of a program, while a run is recorded."""

from __future__ import annotations

from typing import TYPE_CHECKING

from cspdiag.simulate.record.stored.parameters import ParameterValues

if TYPE_CHECKING:
    from cspdiag.network.ir.network import CoreNetwork
    from cspdiag.simulate.record.recorder import Recorder
    from cspdiag.simulate.record.streamed.recording import Recording


def record_parameters(recording: Recording, network: CoreNetwork, recorder: Recorder) -> None:
    """Give a recording that has the parameters of the program their first values, and those after each change."""
    if all(port.direction != "parameter" for port in recording.head.ports):
        return
    values = ParameterValues(network)

    def changed(time: int, parameter: str, path: tuple[int, ...], value: object) -> None:
        recording.add_parameters(time, values.change(parameter, path, value))

    recording.add_parameters(0, values.value)
    recorder.on_change = changed
