"""Runs a network on the reference semantics, which is slow and shares nothing with the runtime."""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import ExitStack
from time import perf_counter
from typing import TYPE_CHECKING

from cspdiag.base.errors import CspdiagError
from cspdiag.network.ir.external import external_bodies
from cspdiag.network.ir.network import CoreNetwork, Environment, Network
from cspdiag.runtime.kernel.exceptions import EnvironmentFailure, Fault, ProcessError, Timeout
from cspdiag.runtime.kernel.stopping import Stopped, stopping
from cspdiag.runtime.outcome import Ending, Outcome
from cspdiag.semantics.equations.parameters import Change
from cspdiag.semantics.execute import execute
from cspdiag.semantics.scheduler import Scheduler
from cspdiag.semantics.trace import Execution
from cspdiag.simulate.deadlock.report import deadlock_report
from cspdiag.simulate.record.recorder import Recorder
from cspdiag.simulate.record.stored.inputs import replace_plant
from cspdiag.simulate.result import Run
from cspdiag.simulate.run.execute import chosen_environment, noted
from cspdiag.simulate.run.whereabouts import Whereabouts

if TYPE_CHECKING:
    from cspdiag.simulate.record.stored.inputs import RecordedInputs
    from cspdiag.simulate.record.streamed.recording import Recording

_ENDINGS: dict[str, Ending] = {
    "terminated": "terminated",
    "deadlock": "deadlock",
    "time limit": "time limit",
    "failed": "failed",
}


class NoMeaningError(CspdiagError):
    """The program has parts to which the reference semantics gives no meaning; the message is one line."""


def simulate(
    network: CoreNetwork,
    *,
    environment: str | None,
    until: int | None,
    recorder: Recorder,
    recording: Recording | None = None,
    inputs: RecordedInputs | None = None,
    changes: Iterable[tuple[int, str, tuple[int, ...], object]] = (),
) -> Run:
    """Run a network in virtual time, up to ``until`` nanoseconds.

    A signal ends the run with an outcome. Raises NoEnvironmentError, and NoMeaningError for bodies in other languages.
    """
    chosen = chosen_environment(network, environment)
    _refuse_other_languages(network, chosen)
    began = perf_counter()
    worlds: list[Scheduler] = []
    watching = ExitStack()

    def make(*arguments: object, **named: object) -> Scheduler:
        worlds.append(Scheduler(*arguments, **named))  # type: ignore[arg-type]
        if inputs is not None and worlds[0].outside is not None:
            replace_plant(worlds[0].outside, inputs)
        watching.enter_context(noted(recorder, recording, worlds[0].outside))
        return worlds[0]

    name = None if chosen is None else chosen.name
    try:
        with stopping.raising(), watching:
            done = execute(
                network, name, until, scheduler=make, observer=recorder, changes=(Change(*change) for change in changes)
            )
    except Stopped as stopped:
        outcome = Outcome("stopped", worlds[0].now if worlds else 0, signal=stopped.signal)
    else:
        outcome = outcome_of(done, name or "", network)
        if outcome.ended == "deadlock":
            assert worlds[0].main is not None
            waiting = Whereabouts(network).waiting(worlds[0].main)
            outcome.deadlock = deadlock_report(outcome.time, waiting, network, recorder)
    outcome.wall_time = perf_counter() - began
    return Run(network, chosen, outcome, recorder)


def _refuse_other_languages(network: CoreNetwork, environment: Environment | None) -> None:
    for body in external_bodies(network.classes, [] if environment is None else [environment]):
        raise NoMeaningError(f"-O reference cannot run `{body.target}`, a body in another language: run it with -O0")


def outcome_of(done: Execution, environment: str, network: Network) -> Outcome:
    """How a run ended, with its failure as the exception that the runtime raises."""
    outcome = Outcome(_ENDINGS[done.ending.ended], done.ending.time, _error(done, environment, Whereabouts(network)))
    outcome.missed = dict(done.missed)
    return outcome


def _error(done: Execution, environment: str, places: Whereabouts) -> Exception | None:
    if done.failure is None:
        return None
    place, line = places.origin(done.failure)
    match done.ending.error:
        case "EnvironmentFailure":
            return EnvironmentFailure(environment, Fault(done.reason), line)
        case "Fault":
            return Fault(done.reason, place)
        case "Timeout":
            error: ProcessError = Timeout(done.reason)
        case declared:  # An exception that the program declares.
            error = type(declared or "", (ProcessError,), {})()
    error.place = place
    return error
