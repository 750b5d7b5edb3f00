"""The timing report as tables of text."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from decimal import ROUND_CEILING, ROUND_FLOOR
from math import ceil

from cspdiag.analyses.timing.refusal import Refusal
from cspdiag.analyses.timing.result import LoopTiming, TimingReport
from cspdiag.analyses.timing.task import ONCE
from cspdiag.analyses.timing.threads.graph import Missing
from cspdiag.base.render.snippet import on_one_line
from cspdiag.model.constants.durations import rounded

_ROWS_SHOWN = 200
_NAMES_SHOWN = 5


def table(report: TimingReport) -> str:
    """The report as text, with a line break at its end."""
    return "\n".join(_lines(report)) + "\n"


def _lines(report: TimingReport) -> Iterator[str]:
    unknown = "REFUSED" if report.missing or report.refusals else "NOT PROVED"
    verdict = {True: "SCHEDULABLE", False: "NOT SCHEDULABLE", None: unknown}[report.is_schedulable]
    yield f"{verdict}: {report.process}: {report.reason}"
    if report.is_schedulable and not report.loops:
        yield f"  = help: give the inputs that `{report.process}` samples a period, `in x : double @ 1 ms`"
    if report.missing:
        yield ""
        yield from _missing(report.missing)
    for refusal in report.refusals:
        yield ""
        yield from _refusal(refusal)
    if report.loops:
        yield ""
        yield from _aligned(_loop_rows(report.loops))
        yield ""
        yield from _summary(report)
    if report.chains:
        yield ""
        rows = [("from", "through", "to", "reaction", "age")]
        rows += [
            (c.source, ", ".join(c.loops), c.sink, _bound(c.reaction), _bound(c.age))
            for c in report.chains[:_ROWS_SHOWN]
        ]
        yield from _aligned(rows, right=2)
        if len(report.chains) > _ROWS_SHOWN or not report.are_all_chains:
            more = "at least " if not report.are_all_chains else ""
            yield f"and {more}{len(report.chains) - len(rows) + 1} chains more"
        yield "reaction: from a change of the input to the first output that reflects it"
        yield "age: of a sample, when an output that is based on it is handed over"
        for refusal in dict.fromkeys(c.unbounded for c in report.chains[:_ROWS_SHOWN] if c.unbounded is not None):
            yield ""
            yield from _refusal(refusal)


def _refusal(refusal: Refusal) -> Iterator[str]:
    yield f"`{refusal.subject}`: {refusal.reason}"
    yield f"  --> {on_one_line(refusal.span.source.name)}:{refusal.span.line}:{refusal.span.column}"
    yield f"  = help: {refusal.help}"


def _bound(nanoseconds: int | None) -> str:
    return "no bound" if nanoseconds is None else upper(nanoseconds)


def _loop_rows(loops: Sequence[LoopTiming]) -> list[tuple[str, ...]]:
    levels = sorted({loop.priority for loop in loops})
    head = ["loop", "period", "work", "load", "step", "blocking", "response", "slack", "latency", "jitter", "outputs"]
    if len(levels) > 1:
        head.insert(1, "priority")
    rows = [tuple(head)]
    for loop in loops[:_ROWS_SHOWN]:
        row = [
            loop.name, time(loop.period), upper(loop.work), _share(loop.utilization), upper(loop.step),
            upper(loop.blocking), _bound(loop.response),
            "none" if loop.slack is None else lower(loop.slack),
            _interval(loop.latency) if loop.latency is not None else "no bound" if loop.outputs else "",
            "" if loop.jitter is None else upper(loop.jitter), ", ".join(loop.outputs),
        ]  # fmt: skip
        if len(levels) > 1:
            row.insert(1, str(levels.index(loop.priority) + 1))
        rows.append(tuple(row))
    return rows


def _interval(latency: tuple[int, int]) -> str:
    shortest, longest = latency
    # Of one time that four digits do not show exactly, both bounds are given.
    least, most = lower(shortest), upper(longest)
    return most if least == most else f"{least} to {most}"


def _summary(report: TimingReport) -> Iterator[str]:
    if len(report.loops) > _ROWS_SHOWN:
        yield f"and {len(report.loops) - _ROWS_SHOWN} loops more"
    yield (
        f"the processor is used up to {_share(report.utilization)}; everything repeats after {time(report.hyperperiod)}"
    )
    waiting = [loop for loop in report.loops if loop.partners]
    for loop in waiting:
        yield (
            f"`{loop.name}` waits within a sample for {', '.join(f'`{partner}`' for partner in loop.partners)}: their "
            "work is part of it"
        )
    free = [f"`{loop.name}`" for loop in report.loops if not loop.work]
    if free:
        more = f" and {len(free) - _NAMES_SHOWN} more" if len(free) > _NAMES_SHOWN else ""
        compute = "computes" if len(free) == 1 else "compute"
        names = f"{', '.join(free[:_NAMES_SHOWN])}{more}"
        yield f"what {names} {compute} counts as zero: a process states its time by `wcet`"
    if not all(loop.is_met for loop in report.loops):
        yield from _advice(report)
    if report.measured:
        count = len(report.measured)
        of = f"`{report.measured[0]}`" if count == 1 else f"{count} laws and processes"
        of += f" and of the kernel, {upper(report.kernel)} at each instant," if report.kernel else ""
        yield f"execution times of {of} were measured: a longest one seen is no proof that none is longer"
    yield "times count from the nominal release, the tick; a step runs until its process waits, and nothing preempts it"


def _advice(report: TimingReport) -> Iterator[str]:
    if report.advice is not None:
        yield f"with these priorities every deadline would be met: {' ||> '.join(report.advice)}"
    elif report.is_overloaded:
        yield "more work than time: no order of priorities helps"
    else:
        yield "no order of priorities is known that meets every deadline with these steps"
    if report.is_edf_feasible is not None:
        yield f"earliest deadline first would {'' if report.is_edf_feasible else 'not '}meet every deadline"


def _missing(missing: Sequence[Missing]) -> Iterator[str]:
    by_definition: dict[tuple[str, int], list[Missing]] = {}
    for part in missing:
        by_definition.setdefault((part.span.source.name, part.span.line), []).append(part)
    for parts in by_definition.values():
        first = parts[0]
        more = f" (and {len(parts) - 1} more)" if len(parts) > 1 else ""
        yield f"`{first.leaf}`{more} does not say its worst-case execution time"
        yield f"  --> {on_one_line(first.span.source.name)}:{first.span.line}:{first.span.column}"
        yield (
            f"  = help: write it in the head, `{first.kind} {first.definition}(...) wcet 100 us {{`, or give measured "
            "times with `cspdiag verify --timing --wcet-from`"
        )


def time(nanoseconds: int) -> str:
    """A duration with four digits: ``1.25 ms``."""
    if nanoseconds >= ONCE:
        return "once"
    return rounded(nanoseconds)


def upper(nanoseconds: int) -> str:
    """An upper bound with four digits, not less than it is."""
    return rounded(nanoseconds, ROUND_CEILING)


def _share(share: float) -> str:
    """A share of the processor, rounded up."""
    return f"{ceil(round(1000 * share, 6)) / 10:.1f} %"


def lower(nanoseconds: int) -> str:
    """A lower bound with four digits, not more than it is."""
    return rounded(nanoseconds, ROUND_FLOOR)


def _aligned(rows: Sequence[tuple[str, ...]], right: int | None = None) -> Iterator[str]:
    """The rows with aligned columns: the first and the last to the left, the rest to the right; with ``right`` only
    that number of the last columns is aligned to the right.
    """
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    last = len(widths) - 1
    for row in rows:
        cells = []
        for k, (cell, width) in enumerate(zip(row, widths, strict=True)):
            to_right = 0 < k < last if right is None else k > last - right
            cells.append(cell.rjust(width) if to_right else cell.ljust(width))
        yield "  ".join(cells).rstrip()
