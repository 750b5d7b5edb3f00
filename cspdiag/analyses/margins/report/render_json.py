"""Margins as JSON: seconds, degrees, rad/s; infinite ones are null."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any

from cspdiag.analyses.margins.loops import LoopReport
from cspdiag.base.render.json import place


def as_json(report: LoopReport, periods: Mapping[str, tuple[int | None, str]] | None = None) -> dict[str, Any]:
    """The report as plain data."""
    loops = []
    for loop in report.loops:
        found = loop.margins
        entry: dict[str, Any] = {
            "name": loop.opened.cut.name,
            "laws": list(loop.opened.laws),
            "period": loop.opened.period,
            "stable": found.is_stable,
            "radius": found.radius,
            "gain": _finite(found.gain),
            "lowest_gain": found.lowest_gain,
            "phase": _finite(found.phase),
            "delay": _finite(found.delay),
            "modulus": _finite(found.modulus),
            "crossover": found.crossover,
            "phase_crossover": found.phase_crossover,
            "drifts": found.drifts,
            "point": dict(loop.point),
            "simplifications": [{"what": part.what, **place(part.span)} for part in loop.simplifications],
        }
        if periods and loop.opened.cut.name in periods:
            period, constant = periods[loop.opened.cut.name]
            entry["largest_period"] = {"constant": constant, "period": None if period is None else period / 1e9}
        loops.append(entry)
    refusals = [{"name": part.law, "reason": part.reason, **place(part.span)} for part in report.refusals]
    return {"environment": report.environment, "loops": loops, "refusals": refusals}


def render(report: LoopReport, periods: Mapping[str, tuple[int | None, str]] | None = None) -> str:
    """The report as text, with a line break at its end."""
    return json.dumps(as_json(report, periods), indent=2) + "\n"


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None
