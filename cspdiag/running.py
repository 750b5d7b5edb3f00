"""How the Python interface runs a network: in Python, natively, by the reference semantics, or many times."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import closing
from functools import partial
from typing import TYPE_CHECKING, TypeAlias

from cspdiag import pipeline
from cspdiag.arguments import Setting, changes_of
from cspdiag.base.errors import ArgumentError, file_errors
from cspdiag.live import Tuning

if TYPE_CHECKING:
    from cspdiag.model.program import Program
    from cspdiag.network.ir.network import CoreNetwork
    from cspdiag.simulate.native.run import NativeProgram
    from cspdiag.simulate.result import Run
    from cspdiag.sweep.plan import Request
    from cspdiag.sweep.table import Sweep

Tune: TypeAlias = "Tuning | Mapping[str | float, Mapping[str, Setting]]"
"""Changes of parameters: by the time in the run, as a text or in seconds, new values by name; or from another
thread.
"""


def run_network(
    network: CoreNetwork,
    program: Program,
    read: pipeline.Reader,
    environment: str | None,
    until: int | None,
    tune: Tune | None,
    target: str,
    level: int,
    *,
    real_time: bool,
) -> Run:
    """Run the network of a program as ``target`` says: "python", "c" or "auto"; ``until`` is in nanoseconds. Raises as
    ``LoadedProgram.run`` does.
    """
    from cspdiag.simulate.native import run as native
    from cspdiag.simulate.native.choice import native_if_possible, run_either
    from cspdiag.simulate.run import execute

    live = tune if isinstance(tune, Tuning) else None
    changes = [] if tune is None or live is not None else changes_of(program, tune)
    on_start = None if live is None else partial(live.attach, program)
    with file_errors():
        if target == "c":
            return native.simulate(
                network, read, level=level, environment=environment, until=until, real_time=real_time,
                changes=changes, live=live is not None, on_start=on_start,
            )  # fmt: skip

        def in_python() -> Run:
            files = pipeline.generate(network, read, level=level, traced=True, observed=True)
            return execute.simulate(
                network, files, environment=environment, until=until, real_time=real_time, changes=changes,
                on_start=on_start,
            )  # fmt: skip

        if target == "python":
            return in_python()

        def natively(found: NativeProgram) -> Run:
            return found.run(until=until, changes=changes, live=live is not None, on_start=on_start)

        native_program = native_if_possible(network, read, level=level, environment=environment, real_time=real_time)
        return run_either(native_program, natively, in_python)


def run_on_reference(
    network: CoreNetwork, program: Program, environment: str | None, until: int | None, tune: Tune | None
) -> Run:
    """Run the network of a program by the reference semantics; ``until`` is in nanoseconds. Raises as
    ``LoadedProgram.run`` does.
    """
    from cspdiag.simulate.record.recorder import Recorder
    from cspdiag.simulate.run import reference

    if isinstance(tune, Tuning):
        raise ArgumentError("a `Tuning` is for a program that runs in Python: give the changes by their times")
    changes = [] if tune is None else changes_of(program, tune)
    return reference.simulate(network, environment=environment, until=until, recorder=Recorder(), changes=changes)


def measured_runs(request: Request, read: pipeline.Reader, target: str, workers: int | None, dask: str | None) -> Sweep:
    """Make the runs of a sweep, in as many processes as there are processors or ``workers``, or on the cluster at the
    address ``dask``. Raises as ``LoadedProgram.sweep`` does, and ``InvalidProgramError`` for a program with errors.
    """
    from cspdiag.sweep.execute import Jobs, make_runs, processors, source_of_runs
    from cspdiag.sweep.plan import plan_sweep
    from cspdiag.sweep.table import Sweep

    with file_errors():
        plan = plan_sweep(request, read)
        if plan.never_ends:
            raise ArgumentError("the program never ends by itself: say with `until` when each run ends")
        jobs = Jobs(plan, read, target)
        runs = range(len(plan.grid))
        count = min(workers or processors(), len(runs))
        with source_of_runs(dask, count) as source, closing(make_runs(plan, runs, jobs, source)) as found:
            results = dict(found)
    return Sweep(plan.grid, plan.measures, results, jobs.made)
