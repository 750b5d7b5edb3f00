"""Runs a network: the generated Python of ``-O0``, imported from memory, against its environment."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from cspdiag.base.errors import CspdiagError
from cspdiag.codegen.python.plain.external import bodies
from cspdiag.network.ir.external import devices_in_c, file_of_fmu, fmu_calls
from cspdiag.network.ir.network import CoreNetwork, DriverInstance, Environment
from cspdiag.runtime.kernel.exceptions import kind_and_text
from cspdiag.runtime.kernel.parameters import Change
from cspdiag.runtime.kernel.stopping import stopping
from cspdiag.simulate.deadlock.report import deadlock_report
from cspdiag.simulate.deadlock.waiting import WaitingRecord
from cspdiag.simulate.record.recorder import Recorder
from cspdiag.simulate.result import Run
from cspdiag.simulate.run.measure import measure
from cspdiag.simulate.run.package import LoadedPackage
from cspdiag.simulate.run.probes import probe

if TYPE_CHECKING:
    from cspdiag.runtime import Network as RunningNetwork
    from cspdiag.runtime import Outcome
    from cspdiag.runtime.deadlock.reports import WaitingProcess
    from cspdiag.runtime.outside.instants import Environment as PythonEnvironment
    from cspdiag.simulate.record.stored.inputs import RecordedInputs
    from cspdiag.simulate.record.streamed.recording import Recording


class NoEnvironmentError(CspdiagError, LookupError):
    """The program has ports to the outside and nothing to connect them to."""


class BodyError(CspdiagError):
    """A Python module that the program names cannot be imported, or its class cannot be instantiated; the message is
    one line.
    """


def chosen_environment(network: CoreNetwork, name: str | None) -> Environment | None:
    """The environment of that name, or the first; None for a program without ports and environments.

    Raises NoEnvironmentError, with a message for people, if there is no such environment.
    """
    names = [environment.name for environment in network.environments]
    if name is not None:
        if name not in names:
            known = f"there are: {', '.join(names)}" if names else "the program has none"
            raise NoEnvironmentError(f"no environment `{name}` for `{network.top}`; {known}")
        return network.environments[names.index(name)]
    if network.environments:
        return network.environments[0]
    if network.external_ports:
        ports = ", ".join(f"`{port.name}`" for port in network.external_ports)
        raise NoEnvironmentError(
            f"`{network.top}` has no environment to run in: say what its ports {ports} are connected to "
            f"with `environment NAME for {network.top} {{ ... }}`"
        )
    return None


def _refuse_devices_in_c(environment: Environment) -> None:
    """Raises NoEnvironmentError for an environment that only native programs have."""
    for driver in devices_in_c(environment):
        advice = "run it with --target c, or choose another environment with --environment"
        raise NoEnvironmentError(f"{device_in_c_refusal(driver)}: {advice}")


def device_in_c_refusal(driver: DriverInstance) -> str:
    """What is wrong with a driver that is written in C, and its place."""
    return f"{driver.external.span}: the driver `{driver.definition}` is written in C, which Python cannot call"


def built(
    network: CoreNetwork, chosen: Environment | None, package: LoadedPackage
) -> tuple[Any, PythonEnvironment | None]:
    """The network of a loaded package and its environment. Raises NoEnvironmentError for an environment that only
    native programs have, BodyError, and Stopped if a signal arrives.
    """
    if chosen is not None:
        _refuse_devices_in_c(chosen)
        if fmu_calls(chosen):
            from cspdiag.fmu.ends import present

            present.lose = stopping.lose
    try:
        with stopping.raising():
            plant = package.module("environments").ENVIRONMENTS[chosen.name]() if chosen is not None else None
            given = {"parameters": plant.parameters} if plant is not None and network.parameters else {}
            return package.module("network").build(plant.drivers if plant is not None else {}, **given), plant
    except BaseException as problem:
        if not bodies(network) or stopping.ends_run(problem):
            raise
        raise BodyError(_account_of_fmu(problem, chosen) or account_of(problem)) from problem


def _account_of_fmu(problem: BaseException, environment: Environment | None) -> str:
    """What is wrong with an FMU, and where the text names it; empty for another problem."""
    from cspdiag.fmu.description import FmuError

    if not isinstance(problem, FmuError):
        return ""
    bodies = [] if environment is None else [call.external for call in fmu_calls(environment)]
    places = (f"{body.span}: " for body in bodies if problem.message.startswith(os.path.abspath(file_of_fmu(body))))
    return f"{next(places, '')}{problem.message}\n  help: {problem.advice}"


def simulate(
    network: CoreNetwork,
    files: Mapping[str, str],
    *,
    environment: str | None = None,
    until: int | None = None,
    real_time: bool = False,
    recorder: Recorder | None = None,
    probe_variables: bool = False,
    measured: bool = False,
    on_start: Callable[[RunningNetwork], None] | None = None,
    recording: Recording | None = None,
    inputs: RecordedInputs | None = None,
    changes: Iterable[Change] = (),
    on_environment: Callable[[object], None] | None = None,
    part: Callable[[RunningNetwork, LoadedPackage], RunningNetwork] | None = None,
) -> Run:
    """Run the generated package ``files`` of ``network``.

    ``until`` is a time limit in nanoseconds. ``recording`` is given the values of the external ports while the run goes
    on; the caller finishes it. ``inputs``: what the environment gives instead of what it computes. ``probe_variables``
    also records the values of variables that have a unit, ``measured`` how long laws compute. ``changes`` are those of
    parameters of the program. ``on_start`` is passed the running network, whose ``now`` is the present instant, and
    ``on_environment`` its environment, before the run. ``part`` makes the network of one place out of the whole.
    Signals and what the program raises end the run with an outcome, not with an exception. Raises NoEnvironmentError
    and BodyError, and Stopped if a signal arrives before the run.
    """
    chosen = chosen_environment(network, environment)
    recorder = recorder if recorder is not None else Recorder()
    package = LoadedPackage(network.name, files)
    try:
        running, plant = built(network, chosen, package)
        running.parameters.plan(changes)
        if inputs is not None and plant is not None:
            from cspdiag.simulate.record.stored.inputs import replace_environment

            replace_environment(plant, inputs)
        if on_environment is not None and plant is not None:
            on_environment(plant)
        if part is not None:
            running = part(running, package)
        if probe_variables:
            probe(running, network, recorder)
        if measured:
            measure(running, recorder)
        if on_start is not None:
            on_start(running)
        with noted(recorder, recording, plant):
            outcome = running.run(
                environment=plant,
                until=until,
                real_time=real_time,
                on_miss=chosen.on_miss if chosen is not None else "timeout",
                observer=recorder,
            )
        for change, why in running.parameters.refused:
            recorder.refused.append((change.time, change.parameter, why))
        explain(outcome, network, recorder)
    finally:
        package.close()
    return Run(network, chosen, outcome, recorder)


def explain(outcome: Outcome, network: CoreNetwork, recorder: Recorder) -> None:
    """Make the report of a deadlock say, by the text of the program, which process waits for which."""
    if outcome.deadlock is not None:
        waiting = [_record(process) for process in outcome.deadlock.waiting]
        outcome.deadlock = deadlock_report(outcome.deadlock.time, waiting, network, recorder)


@contextmanager
def noted(recorder: Recorder, recording: Recording | None, environment: object) -> Iterator[None]:
    """Inside, while ``environment`` advances, a recording is given what a recorder notes."""
    if recording is None or environment is None:
        yield
        return
    from cspdiag.simulate.record.streamed.notes import NotedPorts

    with NotedPorts(recorder, recording) as notes:
        notes.watch(environment)
        yield
    notes.take(None)


def _record(process: WaitingProcess) -> WaitingRecord:
    return WaitingRecord(
        path=process.path,
        place=process.place or "",
        waits=process.waits,
        channels=process.channels,
        missing=process.missing,
    )


def account_of(problem: BaseException) -> str:
    """What went wrong in a module that the program names, and at which line of it."""
    if isinstance(problem, SyntaxError):
        return f"{_module(problem.filename or '')}:{problem.lineno}: {problem.msg}"
    traceback = problem.__traceback__
    place = ""
    while traceback is not None:
        file = traceback.tb_frame.f_code.co_filename
        if file.startswith("<_cspdiag_") and "/external/" in file:
            place = f"{_module(file)}:{traceback.tb_lineno}: "
        traceback = traceback.tb_next
    return f"{place}{kind_and_text(problem)}"


def _module(origin: str) -> str:
    """``law.py`` of ``<_cspdiag_oven_1>/external/law.py``."""
    return origin.partition(">/")[2].removeprefix("external/")
