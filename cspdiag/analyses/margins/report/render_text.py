"""Margins as a table of text."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence

from cspdiag.analyses.margins.loops import AnalysedLoop, LoopReport
from cspdiag.base import Span
from cspdiag.base.render.snippet import on_one_line
from cspdiag.model.constants.durations import rounded


def table(report: LoopReport, periods: Mapping[str, tuple[int | None, str]] | None = None) -> str:
    """The report as text, with a line break at its end; ``periods`` gives for each loop the largest period in
    nanoseconds, and its constant.
    """
    return "\n".join(_lines(report, periods or {})) + "\n"


def _lines(report: LoopReport, periods: Mapping[str, tuple[int | None, str]]) -> Iterator[str]:
    if not report.loops:
        yield f"no loop goes through `{report.environment}` that has margins"
    else:
        head = ("loop", "period", "closed loop", "gain", "", "phase", "delay", "modulus", "crossover")
        rows = [head, *(_row(loop) for loop in report.loops)]
        if periods:
            rows = [
                (*row, "largest period") if k == 0 else (*row, _period(periods, row[0])) for k, row in enumerate(rows)
            ]
        yield from _aligned(rows)
        yield ""
        yield from _explained(report)
    for refusal in report.refusals:
        yield ""
        yield f"`{refusal.law.partition('.')[2]}` has no margins: {refusal.reason}"
        if refusal.span is not None:
            yield f"  --> {_place(refusal.span)}"


def _row(loop: AnalysedLoop) -> tuple[str, ...]:
    found = loop.margins
    gain = "any" if math.isinf(found.gain) else f"{found.gain:.3g}"
    decibels = "" if math.isinf(found.gain) or found.gain <= 0 else f"{20 * math.log10(found.gain):.1f} dB"
    return (
        loop.opened.cut.name, rounded(loop.opened.period * 1e9), "stable" if found.is_stable else "UNSTABLE",
        gain, decibels, "any" if math.isinf(found.phase) else f"{found.phase:.1f} deg",
        "none" if not found.is_stable else "any" if math.isinf(found.delay) else rounded(found.delay * 1e9),
        f"{found.modulus:.2f}", "none" if found.crossover is None else f"{found.crossover:.4g} rad/s",
    )  # fmt: skip


def _period(periods: Mapping[str, tuple[int | None, str]], name: str) -> str:
    if name not in periods:
        return ""
    period, constant = periods[name]
    return f"none ({constant})" if period is None else f"{rounded(period)} ({constant})"


def _explained(report: LoopReport) -> Iterator[str]:
    yield (
        f"about rest in `{report.environment}`, with the sampling, the latch of each output and one law after another "
        "as they run"
    )
    points = {name: value for loop in report.loops for name, value in loop.point.items()}
    if points:
        listed = ", ".join(f"{name} = {value:g}" for name, value in points.items())
        yield f"but in motion, since at rest the plant does not answer: {listed} (--at NAME=VALUE chooses)"
    low = [loop for loop in report.loops if loop.margins.lowest_gain > 0]
    for loop in low:
        yield (
            f"`{loop.opened.cut.name}` is unstable also when its gain falls below {loop.margins.lowest_gain:.3g} times "
            "what it is"
        )
    drifting = [loop.opened.cut.name for loop in report.loops if loop.margins.drifts]
    if drifting:
        yield (
            f"beside {_listed(drifting)} something drifts that the loop does not see, as an angle does whose speed is "
            "controlled"
        )
    wider = [loop for loop in report.loops if len(loop.opened.laws) > 1]
    for loop in wider:
        inner = ", ".join(f"`{law.partition('.')[2]}`" for law in loop.opened.laws[1:])
        yield f"within `{loop.opened.cut.name}` the loop of {inner} is closed"
    simplified: dict[str, dict[str, None]] = {}
    for loop in report.loops:
        for part in loop.simplifications:
            simplified.setdefault("" if part.span is None else _place(part.span), {})[part.what] = None
    if simplified:
        yield "what is not linear:"
        yield from (f"  {place}: {'; '.join(whats)}" for place, whats in simplified.items())


def _listed(names: Sequence[str]) -> str:
    return ", ".join(f"`{name}`" for name in names[:4]) + (f" and {len(names) - 4} more" if len(names) > 4 else "")


def _place(span: Span) -> str:
    return f"{on_one_line(span.source.name)}:{span.line}:{span.column}"


def _aligned(rows: Sequence[tuple[str, ...]]) -> Iterator[str]:
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    for row in rows:
        yield "  ".join(
            cell.ljust(width) if k in (0, 2) else cell.rjust(width)
            for k, (cell, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
