"""``cspdiag sweep``: run a program with many values, and tabulate what is measured."""

from __future__ import annotations

import time
from argparse import ArgumentParser, ArgumentTypeError, Namespace
from contextlib import closing, nullcontext
from typing import TYPE_CHECKING

from cspdiag.base.sources import read_source
from cspdiag.cli.support.failure import FINE, INTERRUPTED, UNSUCCESSFUL, NoResultError, UsageError, require_package
from cspdiag.cli.support.files.written import file_path, require_different, require_file
from cspdiag.cli.support.numbers import add_real
from cspdiag.cli.support.terminal import say, show_diagnostics, write_out

if TYPE_CHECKING:
    from pathlib import Path

    from cspdiag.sweep.partial import PartialTable
    from cspdiag.sweep.plan import Plan
    from cspdiag.sweep.table import Sweep

EXAMPLE = (
    "cspdiag sweep models/jiwy/jiwy.csp --set pan.inertia=0.8e-3:1.2e-3:5 --measure 'peak(control_horizontal)'\n"
    "cspdiag sweep models/jiwy/jiwy.csp --set panGains.kp=1:4:20 --measure 'rms(pan.speed)' -o kp.csv --plot kp.svg"
)

_PICTURES = (".svg", ".png", ".pdf")


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("file", metavar="FILE", help="a program; - reads standard input")
    parser.add_argument("--environment", metavar="NAME", help="the environment to run in (default: the first)")
    parser.add_argument("--for", metavar="TIME", dest="until", help="end each run at this time, such as 20s or 500ms")
    parser.add_argument(
        "--set", action="append", default=[], metavar="NAME=VALUES", dest="settings",
        help="a parameter (gains.kp), an instance's parameter (pan.inertia) or a constant (Tsh), with a range "
        "FIRST:LAST:COUNT, a range in equal ratios FIRST:LAST:COUNT:log, a list A,B,C or one value; may be given "
        "again: all combinations are run",
    )  # fmt: skip
    parser.add_argument(
        "--measure", action="append", default=[], metavar="MEASURE", dest="measures",
        help="max, min, peak, mean, rms, last or integral of a port or a state of the environment: 'rms(pan.speed)'; "
        "of a difference, or its absolute value: 'integral(abs(a - b))'; settling(SIGNAL, TARGET, TOLERANCE), "
        "overshoot(SIGNAL, TARGET); may be given again",
    )  # fmt: skip
    add_real(parser)
    parser.add_argument(
        "--target", choices=("auto", "c", "python"), default="auto",
        help="natively if possible (default), natively, or in Python",
    )  # fmt: skip
    parser.add_argument(
        "--workers", type=_count, metavar="N", help="processes that make runs (default: one for each processor)"
    )
    parser.add_argument(
        "--dask", metavar="ADDRESS", help="make the runs on a Dask cluster, at the address of its scheduler"
    )
    parser.add_argument("-o", "--output", type=file_path, metavar="FILE", help="the table, as .csv or .parquet")
    parser.add_argument("--plot", type=file_path, metavar="FILE", help="a figure, as .svg, .png or .pdf")
    parser.add_argument("--resume", action="store_true", help="continue a sweep that was interrupted, with the same -o")
    parser.add_argument("--quiet", action="store_true", help="no summary and no progress")


def _count(text: str) -> int:
    if not text.isascii() or not text.isdecimal() or not 1 <= int(text[:9]) <= 1024 or len(text) > 4:
        raise ArgumentTypeError(f"expected a number of processes from 1 to 1024, not {text!r}")
    return int(text)


def run(arguments: Namespace) -> int:
    """Plan, run, tabulate; exit code 0 if every run has a row, and at least one has not failed."""
    from cspdiag.sweep.plan import InvalidProgramError

    _check_outputs(arguments)
    try:
        plan = _planned(arguments)
    except InvalidProgramError as problem:
        show_diagnostics(problem.diagnostics, arguments.color)
        return UNSUCCESSFUL
    show_diagnostics(plan.warnings, arguments.color)
    _require_end(plan)
    if arguments.plot is not None and not (plan.measures.measures and any(len(a.values) > 1 for a in plan.grid.axes)):
        raise UsageError("--plot shows measures over values: it needs a --measure, and a --set with several values")
    if plan.variants > 1 and arguments.target != "python" and not arguments.quiet:
        say(_several_programs(plan))
    sweep = _swept(arguments, plan)
    if sweep is None:
        return INTERRUPTED
    if arguments.output is None:
        from cspdiag.sweep.table import text_lines

        write_out("".join(f"{line}\n" for line in text_lines(sweep)))
    if sweep.failure is not None:
        say(f"cspdiag: no run has succeeded, the first one for this reason: {sweep.failure}")
        return UNSUCCESSFUL
    return FINE


def _several_programs(plan: Plan) -> str:
    """Why a sweep needs several programs."""
    structural = " and ".join(f"`{name}`" for name in plan.structural_names)
    compiled = " and ".join(f"`{name}`" for name in plan.compiled_names)
    if not structural:
        # Values that make no difference together, such as two factors of one constant, share a program.
        count = f"{'up to ' if len(plan.compiled_names) > 1 else ''}{plan.variants} programs are built"
        return f"{count}, one for each value of {compiled}: what can be a `parameter` needs one only"
    others = f"other ones for some values of {structural}, on which the environment's equations depend"
    each = f"one for each value of {compiled}, and " if compiled else ""
    return f"{plan.variants} programs are built, {each}{others}"


def _check_outputs(arguments: Namespace) -> None:
    """Refuse what could not be written, before the work instead of after it."""
    from cspdiag.sweep.table import ENDINGS

    require_file("-o", arguments.output, ENDINGS)
    require_file("--plot", arguments.plot, _PICTURES)
    require_different({"the program": arguments.file, "-o": arguments.output, "--plot": arguments.plot})
    if arguments.resume and arguments.output is None:
        raise UsageError("--resume continues a sweep with -o FILE, next to which its results are")
    if arguments.output is not None and arguments.output.suffix == ".parquet":
        require_package("-o FILE.parquet", "pyarrow", "parquet")
    if arguments.plot is not None:
        require_package("--plot", "matplotlib", "plot")


def _planned(arguments: Namespace) -> Plan:
    from cspdiag.cli.support.runs.sweep_progress import PlanProgress
    from cspdiag.network.lower.program import SelectionError
    from cspdiag.settings import SettingError, parse_time_limit, split_settings
    from cspdiag.simulate.run.execute import NoEnvironmentError
    from cspdiag.sweep.measures import MeasureError
    from cspdiag.sweep.plan import Request, plan_sweep

    try:
        request = Request(
            source=read_source(arguments.file),
            given=split_settings(arguments.settings),
            measures=arguments.measures,
            environment=arguments.environment,
            until=None if arguments.until is None else parse_time_limit(arguments.until),
            real=arguments.real or "double",
        )
        if arguments.quiet:
            return plan_sweep(request, read_source)
        with closing(PlanProgress()) as progress:
            return plan_sweep(request, read_source, progress.planned)
    except (SettingError, SelectionError, MeasureError, NoEnvironmentError) as problem:
        raise UsageError(str(problem)) from None


def _require_end(plan: Plan) -> None:
    """Refuse runs that never end."""
    if plan.never_ends:
        name = plan.first.class_named(plan.first.top).definition
        raise UsageError(f"{name} never ends by itself: say when each run ends, such as --for 20s")


def _swept(arguments: Namespace, plan: Plan) -> Sweep | None:
    """The whole table, which is written; None if the sweep was interrupted."""
    from cspdiag import __version__
    from cspdiag.sweep.partial import PartialTable, ResumeError

    if arguments.output is None or (arguments.output.exists() and not arguments.output.is_file()):
        sweep = _with_results(arguments, plan, None)
        if sweep is not None and arguments.output is not None:
            _write(sweep, arguments.output)
        return sweep
    try:
        partial = PartialTable(plan, arguments.output, resume=arguments.resume, version=__version__)
    except ResumeError as problem:
        raise UsageError(str(problem)) from None
    with partial:
        if partial.damaged:
            _say_damaged(partial)
        sweep = _with_results(arguments, plan, partial)
        if sweep is not None:
            _write(sweep, arguments.output)
            partial.remove()
    return sweep


def _say_damaged(partial: PartialTable) -> None:
    count = len(partial.damaged)
    runs = "the line is damaged, and its run is" if count == 1 else f"{count} lines are damaged, and their runs are"
    say(f"cspdiag: {partial.path}:{partial.damaged[0]}: {runs} made again")


def _write(sweep: Sweep, path: Path) -> None:
    try:
        sweep.write(path)
    except OSError as problem:
        raise OSError(problem.errno, problem.strerror, problem.filename or str(path)) from None


def _with_results(arguments: Namespace, plan: Plan, partial: PartialTable | None) -> Sweep | None:
    from cspdiag.base.errors import MissingPackageError
    from cspdiag.cli.support.runs.sweep_progress import SweepProgress
    from cspdiag.codegen import target_errors
    from cspdiag.model.wording import counted
    from cspdiag.simulate.native.build import CompilerError
    from cspdiag.sweep.cluster import ClusterError
    from cspdiag.sweep.execute import Jobs, make_runs, processors, source_of_runs
    from cspdiag.sweep.table import Sweep

    results = dict(partial.known if partial is not None else {})
    missing = [run for run in range(len(plan.grid)) if run not in results]
    progress = None if arguments.quiet else SweepProgress(len(plan.grid), len(results))
    jobs = Jobs(plan, read_source, arguments.target)
    began = time.monotonic()
    shown = nullcontext() if progress is None else closing(progress)
    workers = min(arguments.workers or processors(), max(1, len(missing)))
    try:
        with shown, source_of_runs(arguments.dask, workers) as source:
            found = make_runs(
                plan, missing, jobs, source,
                on_build=lambda number: progress.building(number, plan.variants) if progress is not None else None,
            )  # fmt: skip
            with closing(found):
                for run, result in found:
                    results[run] = result
                    if partial is not None:
                        partial.add(run, result)
                    if progress is not None:
                        progress.done()
    except KeyboardInterrupt:
        _say_interrupted(len(results), len(plan.grid), partial)
        return None
    except (CompilerError, ClusterError, MissingPackageError, target_errors()) as problem:
        raise NoResultError(f"{problem}{_kept(len(results), len(plan.grid), partial)}") from None
    sweep = Sweep(plan.grid, plan.measures, results, jobs.made)
    if arguments.plot is not None:
        sweep.plot(arguments.plot)
    if not arguments.quiet:
        seconds = time.monotonic() - began - jobs.seconds
        built = f" after {jobs.seconds:.3g} s of compiling" if jobs.compiled else ""
        say(f"{counted(len(missing), 'run')} in {seconds:.3g} s{built}, {sweep.made}: {sweep.summary()}")
    return sweep


def _kept(done: int, total: int, partial: PartialTable | None) -> str:
    """What is not lost of a sweep that cannot continue."""
    if partial is None or not done:
        return ""
    return f"\n  {done} of {total} runs are in {partial.path}: --resume makes the others"


def _say_interrupted(done: int, total: int, partial: PartialTable | None) -> None:
    if not done:
        say("cspdiag: interrupted before the first run")
    elif partial is None:
        say(f"cspdiag: interrupted after {done} of {total} runs; with -o FILE, they would be kept for --resume")
    else:
        where = f"in {partial.path}; --resume makes the others"
        say(f"cspdiag: interrupted after {done} of {total} runs, which are {where}")
