"""The timing report for machines. All times are integer nanoseconds."""

from __future__ import annotations

import json
from typing import Any

from cspdiag.analyses.timing.refusal import Refusal
from cspdiag.analyses.timing.result import TimingReport
from cspdiag.base.render.json import place


def as_json(report: TimingReport) -> dict[str, Any]:
    """The report as plain data."""
    return {
        "process": report.process,
        "schedulable": report.is_schedulable,
        "reason": report.reason,
        "late": None
        if report.witness is None
        else {"thread": report.witness.thread, "release": report.witness.release, "end": report.witness.end},
        "utilization": report.utilization,
        "hyperperiod": report.hyperperiod,
        "edf": report.is_edf_feasible,
        "advice": None if report.advice is None else list(report.advice),
        "loops": [
            {
                "name": loop.name,
                **place(loop.span),
                "period": loop.period,
                "priority": loop.priority,
                "work": loop.work,
                "utilization": loop.utilization,
                "step": loop.step,
                "blocking": loop.blocking,
                "response": loop.response,
                "start": loop.start,
                "slack": loop.slack,
                "met": loop.is_met,
                "latency": None if loop.latency is None else list(loop.latency),
                "jitter": loop.jitter,
                "outputs": list(loop.outputs),
                "partners": list(loop.partners),
            }
            for loop in report.loops
        ],
        "chains": [
            {
                "from": chain.source,
                "through": list(chain.loops),
                "to": chain.sink,
                "reaction": chain.reaction,
                "age": chain.age,
                "unbounded": None if chain.unbounded is None else _refusal(chain.unbounded),
            }
            for chain in report.chains
        ],
        "allChains": report.are_all_chains,
        "missing": [{"name": part.leaf, "definition": part.definition, **place(part.span)} for part in report.missing],
        "refusals": [_refusal(part) for part in report.refusals],
        "measured": list(report.measured),
        "kernel": report.kernel,
    }


def _refusal(part: Refusal) -> dict[str, Any]:
    return {"name": part.subject, "reason": part.reason, "help": part.help, **place(part.span)}


def render(report: TimingReport) -> str:
    """The report as text, with a line break at its end."""
    return json.dumps(as_json(report), indent=2) + "\n"
