"""``cspdiag verify --timing``: response times, latencies and the schedule of the sampled loops."""

from __future__ import annotations

import shlex
import time
from argparse import Namespace
from collections.abc import Sequence
from fractions import Fraction
from math import ceil
from typing import TYPE_CHECKING, Literal, cast

from cspdiag.base.files.json_text import read_json
from cspdiag.base.record import record
from cspdiag.base.render.snippet import on_one_line, printable
from cspdiag.base.sources import read_source, require_ordinary_file
from cspdiag.cli.support.failure import FINE, UNSUCCESSFUL, UsageError
from cspdiag.cli.support.files.output import replace_text
from cspdiag.cli.support.files.written import require_different, require_file
from cspdiag.cli.support.proofs.answers import refused, rendered_answers
from cspdiag.cli.support.terminal import put, say, show_diagnostics, write_out

if TYPE_CHECKING:
    from cspdiag.analyses.timing.result import TimingReport
    from cspdiag.analyses.timing.tasks.measured import Measured
    from cspdiag.network.ir.network import CoreNetwork
    from cspdiag.pipeline import Built


def run_timing(arguments: Namespace) -> int:
    """Analyse the program, report the results, draw the schedule; exit code 0 if every deadline is proved to be met."""
    _check_options(arguments)
    factor = Fraction(str(arguments.wcet_factor or 1))
    measured = NOTHING if arguments.wcet_from is None else measured_times(str(arguments.wcet_from), factor)
    built = _built(arguments)
    if built.network is None:
        return refused(built.checked.report.diagnostics, arguments)
    began = time.monotonic()
    report = _report(arguments, built.network, measured)
    seconds = time.monotonic() - began
    _print_report(arguments, built, report, seconds)
    _draw(arguments, report)
    return FINE if report.is_schedulable else UNSUCCESSFUL


def _check_options(arguments: Namespace) -> None:
    """Refuse, before the work, options that could not be carried out after it."""
    require_file("--gantt", arguments.gantt, (".svg",))
    require_different({"the program": arguments.file, "--wcet-from": arguments.wcet_from, "--gantt": arguments.gantt})
    spin = arguments.engine if arguments.engine != "cspdiag" else None
    unused = {
        "--method": arguments.method,
        "--engine": spin,
        "--trace-out": arguments.trace_out,
        "--draw": arguments.draw,
        "--json": arguments.json,
    }
    for option, value in unused.items():
        if value is not None:
            raise UsageError(f"{option} belongs to proofs: --timing proves no assertions (leave one of them out)")


def _draw(arguments: Namespace, report: TimingReport) -> None:
    if arguments.gantt is None:
        return
    if report.missing:
        reason = "not all execution times are known"
        say(f"cspdiag: {reason}, so {on_one_line(arguments.gantt)} was not written")
        return
    from cspdiag.analyses.timing.report.gantt import gantt_svg

    replace_text(str(arguments.gantt), gantt_svg(report))
    if not arguments.quiet:
        say(f"wrote {on_one_line(arguments.gantt)}")


def _print_report(arguments: Namespace, built: Built, report: TimingReport, seconds: float) -> None:
    match arguments.format:
        case "json":
            from cspdiag.analyses.timing.report.render_json import render

            show_diagnostics(built.checked.report.diagnostics, arguments.color)
            write_out(render(report))
        case "text":
            from cspdiag.analyses.timing.report.render_text import table

            show_diagnostics(built.checked.report.diagnostics, arguments.color)
            write_out("" if arguments.quiet and report.is_schedulable else printable(table(report)))
        case _:  # The others are formats of answers and diagnostics.
            from cspdiag.proofs.answers.question import schedulability_of
            from cspdiag.proofs.answers.schedulable import answer_of

            assert built.network is not None
            assert built.checked.program is not None
            process = built.network.class_named(built.network.top).definition
            question = schedulability_of(built.checked.program, process)
            stdout, stderr = rendered_answers(
                [answer_of(question, report, seconds)], built.checked.report.diagnostics, arguments
            )
            write_out(stdout)
            put(stderr)


def _built(arguments: Namespace) -> Built:
    from cspdiag import pipeline
    from cspdiag.network.lower.program import SelectionError
    from cspdiag.settings import SettingError, split_settings

    try:
        settings = split_settings(arguments.settings)
        built = pipeline.build(
            read_source(arguments.file), read_source, top=arguments.process, settings=settings, real=arguments.real
        )
    except (SettingError, SelectionError) as problem:
        raise UsageError(str(problem)) from None
    return built


def _report(arguments: Namespace, network: CoreNetwork, measured: MeasuredTimes) -> TimingReport:
    from cspdiag.analyses.timing.report.timing import timing_report
    from cspdiag.analyses.timing.tasks.measured import times_of_laws

    report = timing_report(network, times_of_laws(network, measured.steps), kernel=measured.kernel)
    if measured.steps and not report.measured:
        raise UsageError(
            f"--wcet-from {arguments.wcet_from}: none of its names is a law of {network.top}, a process that "
            "runs laws, or one that is written by hand"
        )
    return report


@record
class MeasuredTimes:
    """The longest ``steps`` of laws and processes, and the longest work of the ``kernel`` at an instant, in
    nanoseconds.
    """

    steps: Sequence[Measured]
    kernel: int


NOTHING = MeasuredTimes((), 0)
"""Nothing was measured."""


def measured_times(path: str, factor: Fraction = Fraction(1)) -> MeasuredTimes:
    """The longest execution times in a trace, multiplied by a factor.

    A trace is what ``run --real-time --trace out.json`` writes, or any JSON object with ``executionTimes``: an object
    from paths to times in seconds, or to objects with ``longest``, and ``what`` was measured. ``kernelTime`` may be
    that of the kernel. Raises UsageError if there are no execution times, OSError if the file cannot be read.
    """
    from cspdiag.analyses.timing.tasks.measured import Measured

    how = f"write it with cspdiag run --real-time --target c --trace {shlex.quote(path)}, or with -O0"
    try:
        require_ordinary_file(path)
        with open(path, encoding="utf-8") as file:
            content = read_json(file.read())
    except UnicodeDecodeError:
        raise UsageError(f"{path}: is not text, so not JSON: {how}") from None
    except ValueError as problem:
        raise UsageError(f"{path}: is not JSON ({problem}): {how}") from None
    times = content.get("executionTimes") if isinstance(content, dict) else None
    if not isinstance(times, dict) or not times:
        raise UsageError(f"{path}: has no execution times: {how}")
    found: list[Measured] = []
    for name, entry in times.items():
        seconds, what = (entry.get("longest"), entry.get("what")) if isinstance(entry, dict) else (entry, "law")
        if what not in ("law", "process", "thread"):
            raise UsageError(f"{path}: what was measured of {name} is a law, a process or a thread, not {what!r}")
        longest = _nanoseconds(seconds, factor, f"{path}: the execution time of {name}")
        found.append(Measured(name, max(1, longest), cast("Literal['law', 'process', 'thread']", what)))
    return MeasuredTimes(found, _nanoseconds(content.get("kernelTime", 0), factor, f"{path}: `kernelTime`"))


def _nanoseconds(seconds: object, factor: Fraction, what: str) -> int:
    """A time, rounded up; tenths of nanoseconds are errors of floating-point numbers."""
    if isinstance(seconds, bool) or not isinstance(seconds, int | float) or not 0 <= seconds < 1e9:
        raise UsageError(f"{what} is not a number of seconds")
    return ceil(Fraction(round(seconds * 1e10), 10) * factor)
