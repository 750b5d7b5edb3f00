"""A run as the options of ``cspdiag run`` ask for it."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Sequence
from typing import TYPE_CHECKING, Protocol

from cspdiag.base.record import record

if TYPE_CHECKING:
    from cspdiag.cli.support.runs.standstill import ObservedProgram
    from cspdiag.cli.support.runs.tuned import Tuning
    from cspdiag.live import RunningProgram
    from cspdiag.network.ir.network import CoreNetwork
    from cspdiag.runtime.kernel.parameters import Change
    from cspdiag.simulate.record.recorder import Recorder
    from cspdiag.simulate.record.stored.inputs import RecordedInputs
    from cspdiag.simulate.record.streamed.recording import Recording


class Watcher(Protocol):
    """Shows what a run does while it continues."""

    def attach(self, program: ObservedProgram) -> None:
        """The program runs."""
        ...


@record
class Given:
    """Where a run takes its inputs and changes of parameters from, and where its values go, if that was asked for."""

    recording: Recording | None
    inputs: RecordedInputs | None
    tuning: Tuning | None

    __hash__ = object.__hash__

    @property
    def changes(self) -> Sequence[Change]:
        """The changes of parameters that are known before the run."""
        if self.tuning is not None:
            return self.tuning.changes
        return () if self.inputs is None else self.inputs.parameter_changes

    @property
    def live(self) -> bool:
        """Whether more changes may come while it runs."""
        return self.tuning is not None and self.tuning.live


@record
class RequestedRun:
    """What is to run, until when (in nanoseconds), what it is given, and who watches it."""

    arguments: Namespace
    network: CoreNetwork
    until: int | None
    recorder: Recorder
    given: Given
    watchers: Sequence[Watcher]

    __hash__ = object.__hash__

    def started(self, running: RunningProgram, observed: ObservedProgram) -> None:
        """The program runs: changes of parameters reach it, and watchers see it."""
        if self.given.tuning is not None:
            self.given.tuning.attach(running)
        for watcher in self.watchers:
            watcher.attach(observed)

    @property
    def records(self) -> bool:
        """Whether the values of the ports go to a file or to a client."""
        return self.arguments.record is not None or self.arguments.serve is not None

    @property
    def measured(self) -> bool:
        """Whether execution times are wanted: traces of real-time runs contain them."""
        trace = self.arguments.trace
        return bool(self.arguments.real_time and trace is not None and trace.suffix == ".json")

    @property
    def probed(self) -> bool:
        """Whether the variables inside processes are wanted: plots show them."""
        return self.arguments.plot is not None
