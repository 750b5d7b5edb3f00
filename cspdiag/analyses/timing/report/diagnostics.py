"""The timing report as a diagnostic at the assertion that requests it."""

from __future__ import annotations

from cspdiag.analyses.diagnostics.timing import NoTimingBound, NotSchedulable
from cspdiag.analyses.timing.report.render_text import time
from cspdiag.analyses.timing.result import LoopTiming, TimingReport
from cspdiag.base import Diagnostic, Span


def diagnostic_of(report: TimingReport, span: Span) -> Diagnostic | None:
    """The diagnostic at ``span``; None if the program is schedulable."""
    if report.is_schedulable:
        return None
    if report.missing:
        first = report.missing[0]
        places = {part.span: f"`{part.definition}` does not say its `wcet`" for part in report.missing}
        advice = (
            f"write it in the head: `{first.kind} {first.definition} wcet 100 us {{`, with the longest time that it "
            "computes"
        )
        return NoTimingBound(
            span, report.process, report.reason, tuple((words, place) for place, words in places.items()), advice
        )
    if report.refusals:
        reasons = tuple(dict.fromkeys((part.reason, part.span) for part in report.refusals))
        return NoTimingBound(span, report.process, report.reason, reasons, report.refusals[0].help)
    advice = "shorten execution times or steps, or lengthen periods; `cspdiag verify --timing` shows what adds up"
    if report.advice is not None:
        advice = f"these priorities meet every deadline: `{' ||> '.join(report.advice)}`"
    if report.is_schedulable is None:
        bounds = tuple(
            ("no bound" if loop.response is None else f"up to {time(loop.response)} of {time(loop.period)}", loop.span)
            for loop in report.loops
            if not loop.is_met
        )
        return NoTimingBound(span, report.process, report.reason, bounds, advice)
    late = tuple((loop.name, time(loop.period), _longest(loop), loop.span) for loop in report.loops if not loop.is_met)
    return NotSchedulable(span, report.process, report.reason, late, advice)


def _longest(loop: LoopTiming) -> str:
    """How long a loop may take, in words."""
    if loop.response is None:
        return "forever longer"
    return "as long" if loop.response == loop.period else time(loop.response)
