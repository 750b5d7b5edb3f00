"""The run of ``cspdiag run`` on the target that was asked for, watched from the terminal."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Callable, Sequence
from contextlib import nullcontext
from typing import TYPE_CHECKING

from cspdiag.base.record import record
from cspdiag.base.sources import read_source
from cspdiag.cli.support.failure import NoResultError, UsageError

if TYPE_CHECKING:
    from cspdiag.cli.support.runs.standstill import ObservedProgram
    from cspdiag.cli.support.runs.tuned import Tuning
    from cspdiag.live import RunningProgram
    from cspdiag.model.types import Type
    from cspdiag.network.ir.network import CoreNetwork
    from cspdiag.runtime.kernel.parameters import Change
    from cspdiag.runtime.network import Network
    from cspdiag.simulate.native.run import NativeProgram, NativeRun, Observed
    from cspdiag.simulate.record.recorder import Recorder
    from cspdiag.simulate.record.stored.inputs import RecordedInputs
    from cspdiag.simulate.record.streamed.recording import Recording
    from cspdiag.simulate.result import Run


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

    def attach(self, running: RunningProgram) -> None:
        """The program runs."""
        if self.tuning is not None:
            self.tuning.attach(running)


def simulate(arguments: Namespace, network: CoreNetwork, until: int | None, given: Given) -> Run:
    """Run a program as the options say, with progress and what stands still shown.

    Raises UsageError for an environment that is not there, NoResultError for a target that cannot be built.
    """
    from cspdiag.cli.support.runs.endless import EndlessRun
    from cspdiag.cli.support.runs.progress import Progress
    from cspdiag.cli.support.runs.standstill import Standstill
    from cspdiag.codegen import target_errors
    from cspdiag.simulate.native.build import CompilerError
    from cspdiag.simulate.record.modes import mode_groups
    from cspdiag.simulate.record.recorder import Recorder
    from cspdiag.simulate.record.streamed.parameters import record_parameters
    from cspdiag.simulate.run.execute import BodyError, NoEnvironmentError

    outputs = (arguments.record, arguments.serve, arguments.trace, arguments.plot)
    recorder = Recorder(
        communications=any(path is not None for path in outputs), ports=_recorded_ports(arguments, network)
    )
    if given.recording is not None:
        record_parameters(given.recording, network, recorder)
    endless = EndlessRun(network) if until is None and not arguments.quiet else None
    if arguments.level == "reference":
        with endless or nullcontext():
            if endless is not None:
                endless.attach()
            return _simulate_on_reference(arguments, network, until, recorder, given)
    simulate = _SIMULATIONS[arguments.target]
    progress = None
    if not arguments.quiet:
        progress = Progress(recorder, mode_groups(network))
    standstill = None
    # In real time it continues.
    if not arguments.quiet and not arguments.real_time:
        standstill = Standstill(recorder, network.class_named(network.top).definition)
    watchers = [watcher for watcher in (progress, standstill, endless) if watcher is not None]

    def attach(running: ObservedProgram) -> None:
        for watcher in watchers:
            watcher.attach(running)

    try:
        with progress or nullcontext(), standstill or nullcontext(), endless or nullcontext():
            return simulate(arguments, network, until, recorder, given, attach)
    except NoEnvironmentError as problem:
        raise UsageError(str(problem)) from None
    except (BodyError, CompilerError, target_errors()) as problem:
        raise NoResultError(str(problem)) from None


def _recorded_ports(arguments: Namespace, network: CoreNetwork) -> dict[str, Type] | None:
    """The external ports, if nothing but their recording is wanted of a run of generated code."""
    if not _is_recorded(arguments) or arguments.trace is not None or arguments.plot is not None:
        return None
    if arguments.level == "reference":
        return None
    return {f"{network.top}.{port.name}": port.type for port in network.external_ports}


def _simulate_on_reference(
    arguments: Namespace, network: CoreNetwork, until: int | None, recorder: Recorder, given: Given
) -> Run:
    from cspdiag.simulate.run.execute import NoEnvironmentError
    from cspdiag.simulate.run.reference import NoMeaningError, simulate

    try:
        return simulate(
            network,
            environment=arguments.environment,
            until=until,
            recorder=recorder,
            recording=given.recording,
            inputs=given.inputs,
            changes=given.changes,
        )
    except (NoEnvironmentError, NoMeaningError) as problem:
        raise UsageError(str(problem)) from None


def _simulate_in_python(
    arguments: Namespace,
    network: CoreNetwork,
    until: int | None,
    recorder: Recorder,
    given: Given,
    on_start: Callable[[ObservedProgram], None],
) -> Run:
    from cspdiag import pipeline
    from cspdiag.cli.support.runs.standstill import ProgramInThread
    from cspdiag.runtime.kernel.stopping import stopping
    from cspdiag.simulate.run.execute import simulate

    with stopping.raising():
        files = pipeline.generate(
            network,
            read_source,
            level=arguments.level if arguments.place is None else 0,
            traced=arguments.trace is not None,
            observed=True,
            probed=arguments.plot is not None,
        )

    if arguments.place is not None:
        from cspdiag.cli.support.runs.placed import simulate_in_place

        return simulate_in_place(arguments, network, files, until, recorder, given.changes, given.recording, on_start)

    def started(running: Network) -> None:
        given.attach(running)
        on_start(ProgramInThread(running))

    return simulate(
        network,
        files,
        environment=arguments.environment,
        until=until,
        real_time=arguments.real_time,
        recorder=recorder,
        probe_variables=arguments.plot is not None,
        measured=_is_measured(arguments),
        on_start=started,
        changes=given.changes,
        recording=given.recording,
        inputs=given.inputs,
    )


def _simulate_native(
    arguments: Namespace,
    network: CoreNetwork,
    until: int | None,
    recorder: Recorder,
    given: Given,
    on_start: Callable[[ObservedProgram], None],
) -> Run:
    from cspdiag.simulate.native.boards import BOARDS
    from cspdiag.simulate.native.run import simulate

    def started(running: NativeRun) -> None:
        given.attach(running)
        on_start(running)

    return simulate(
        network,
        read_source,
        level=arguments.level,
        environment=arguments.environment,
        until=until,
        real_time=arguments.real_time,
        recorder=recorder,
        on_start=started,
        observed=_observed(arguments),
        measured=_is_measured(arguments),
        board=None if arguments.on is None else BOARDS[arguments.on],
        recording=given.recording,
        inputs=given.inputs,
        changes=given.changes,
        live=given.live,
    )


def _simulate_on_either(
    arguments: Namespace,
    network: CoreNetwork,
    until: int | None,
    recorder: Recorder,
    given: Given,
    on_start: Callable[[ObservedProgram], None],
) -> Run:
    from cspdiag.simulate.native.choice import NotNative, native_if_possible, run_either

    program: NativeProgram | NotNative = NotNative(reason="a plot shows the variables inside processes")
    if arguments.plot is None:
        program = native_if_possible(
            network,
            read_source,
            level=arguments.level,
            environment=arguments.environment,
            real_time=arguments.real_time,
            measured=_is_measured(arguments),
            inputs=given.inputs,
        )

    def started(running: NativeRun) -> None:
        given.attach(running)
        on_start(running)

    return run_either(
        program,
        lambda program: program.run(
            until=until,
            recorder=recorder,
            on_start=started,
            observed=_observed(arguments),
            recording=given.recording,
            inputs=given.inputs,
            changes=given.changes,
            live=given.live,
        ),
        lambda: _simulate_in_python(arguments, network, until, recorder, given, on_start),
    )


_SIMULATIONS = {"python": _simulate_in_python, "c": _simulate_native, "auto": _simulate_on_either}


def _observed(arguments: Namespace) -> Observed:
    """What a native program reports."""
    if arguments.trace is not None:
        return "all"
    if arguments.plot is not None:
        return "ports"
    return "signals" if _is_recorded(arguments) else "none"


def _is_recorded(arguments: Namespace) -> bool:
    """Whether the values of the ports go to a file or to a client."""
    return arguments.record is not None or arguments.serve is not None


def _is_measured(arguments: Namespace) -> bool:
    """Whether execution times are wanted: traces of real-time runs contain them."""
    return bool(arguments.real_time and arguments.trace is not None and arguments.trace.suffix == ".json")
