"""The run of ``cspdiag run`` on the target that was asked for, watched from the terminal."""

from __future__ import annotations

from argparse import Namespace
from contextlib import nullcontext
from typing import TYPE_CHECKING

from cspdiag.base.sources import read_source
from cspdiag.cli.support.failure import NoResultError, UsageError
from cspdiag.cli.support.runs.requested import Given, RequestedRun

if TYPE_CHECKING:
    from cspdiag.model.types import Type
    from cspdiag.network.ir.network import CoreNetwork
    from cspdiag.simulate.native.run import NativeProgram, Observed
    from cspdiag.simulate.result import Run


def simulate(arguments: Namespace, network: CoreNetwork, until: int | None, given: Given) -> Run:
    """Run a program as the options say, with progress and what stands still shown.

    Raises NoEnvironmentError, UsageError for what the reference semantics does not have, and NoResultError for a target
    that cannot be built.
    """
    from cspdiag.cli.support.runs.endless import EndlessRun
    from cspdiag.cli.support.runs.placed import shown_groups
    from cspdiag.cli.support.runs.progress import Progress
    from cspdiag.cli.support.runs.standstill import Standstill
    from cspdiag.codegen import target_errors
    from cspdiag.simulate.native.build import CompilerError
    from cspdiag.simulate.native.values import NoEnumeratorError
    from cspdiag.simulate.record.recorder import Recorder
    from cspdiag.simulate.record.streamed.parameters import record_parameters
    from cspdiag.simulate.run.execute import BodyError

    outputs = (arguments.record, arguments.serve, arguments.trace, arguments.plot, arguments.json)
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
            return _simulate_on_reference(RequestedRun(arguments, network, until, recorder, given, ()))
    progress = None
    if not arguments.quiet:
        progress = Progress(recorder, shown_groups(arguments, network))
    standstill = None
    # In real time it continues.
    if not arguments.quiet and not arguments.real_time:
        standstill = Standstill(recorder, network.class_named(network.top).definition, _fmus(arguments, network))
    watchers = [watcher for watcher in (progress, standstill, endless) if watcher is not None]
    run = RequestedRun(arguments, network, until, recorder, given, watchers)
    try:
        with progress or nullcontext(), standstill or nullcontext(), endless or nullcontext():
            return _SIMULATIONS[arguments.target](run)
    except (BodyError, CompilerError, NoEnumeratorError, target_errors()) as problem:
        raise NoResultError(str(problem)) from None


def _fmus(arguments: Namespace, network: CoreNetwork) -> list[str]:
    """The files of the FMUs that the environment has."""
    from cspdiag.network.ir.external import file_of_fmu, fmu_calls
    from cspdiag.simulate.run.execute import chosen_environment

    environment = chosen_environment(network, arguments.environment)
    return [] if environment is None else [file_of_fmu(call.external) for call in fmu_calls(environment)]


def _recorded_ports(arguments: Namespace, network: CoreNetwork) -> dict[str, Type] | None:
    """The external ports, if nothing but their recording is wanted of a run of generated code."""
    recorded = arguments.record is not None or arguments.serve is not None
    whole = any(path is not None for path in (arguments.trace, arguments.plot, arguments.json))
    if not recorded or whole or arguments.level == "reference":
        return None
    return {f"{network.top}.{port.name}": port.type for port in network.external_ports}


def _simulate_on_reference(run: RequestedRun) -> Run:
    from cspdiag.simulate.run.reference import NoMeaningError, simulate

    try:
        return simulate(
            run.network,
            environment=run.arguments.environment,
            until=run.until,
            recorder=run.recorder,
            recording=run.given.recording,
            inputs=run.given.inputs,
            changes=run.given.changes,
        )
    except NoMeaningError as problem:
        raise UsageError(str(problem)) from None


def _simulate_in_python(run: RequestedRun) -> Run:
    from cspdiag import pipeline
    from cspdiag.cli.support.runs.placed import observed, placed
    from cspdiag.cli.support.runs.standstill import ProgramInThread
    from cspdiag.runtime.kernel.stopping import stopping
    from cspdiag.simulate.run.execute import simulate

    arguments = run.arguments
    with stopping.raising():
        files = pipeline.generate(
            run.network,
            read_source,
            level=arguments.level if arguments.place is None else 0,
            traced=arguments.trace is not None,
            observed=True,
            probed=run.probed,
        )
    with placed(run, files) as part:
        return simulate(
            run.network,
            files,
            environment=arguments.environment,
            until=run.until,
            real_time=arguments.real_time,
            recorder=run.recorder,
            probe_variables=run.probed and part is None,
            measured=run.measured and part is None,
            on_start=lambda running: run.started(
                running, ProgramInThread(running) if part is None else observed(running)
            ),
            changes=run.given.changes,
            recording=run.given.recording,
            inputs=run.given.inputs,
            part=part,
        )


def _simulate_native(run: RequestedRun) -> Run:
    from cspdiag.simulate.native.boards import BOARDS
    from cspdiag.simulate.native.run import simulate

    arguments = run.arguments
    return simulate(
        run.network,
        read_source,
        level=arguments.level,
        environment=arguments.environment,
        until=run.until,
        real_time=arguments.real_time,
        recorder=run.recorder,
        on_start=lambda running: run.started(running, running),
        observed=_observed(run),
        measured=run.measured,
        board=None if arguments.on is None else BOARDS[arguments.on],
        recording=run.given.recording,
        inputs=run.given.inputs,
        changes=run.given.changes,
        live=run.given.live,
    )


def _simulate_on_either(run: RequestedRun) -> Run:
    from cspdiag.simulate.native.choice import NotNative, native_if_possible, run_either

    program: NativeProgram | NotNative = NotNative(reason="a plot shows the variables inside processes")
    if not run.probed:
        program = native_if_possible(
            run.network,
            read_source,
            level=run.arguments.level,
            environment=run.arguments.environment,
            real_time=run.arguments.real_time,
            measured=run.measured,
            inputs=run.given.inputs,
        )
    return run_either(
        program,
        lambda program: program.run(
            until=run.until,
            recorder=run.recorder,
            on_start=lambda running: run.started(running, running),
            observed=_observed(run),
            recording=run.given.recording,
            inputs=run.given.inputs,
            changes=run.given.changes,
            live=run.given.live,
        ),
        lambda: _simulate_in_python(run),
    )


_SIMULATIONS = {"python": _simulate_in_python, "c": _simulate_native, "auto": _simulate_on_either}


def _observed(run: RequestedRun) -> Observed:
    """What a native program reports."""
    if run.arguments.trace is not None:
        return "all"
    if run.probed or run.arguments.json is not None:
        return "ports"
    return "signals" if run.records else "none"
