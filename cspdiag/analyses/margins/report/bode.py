"""A Bode plot of open loops with their margins.

Needs matplotlib (``pip install "cspdiag[plot]"``), which is imported when a plot is made.
"""

from __future__ import annotations

import io
import math
from collections.abc import Sequence
from typing import Any

from cspdiag.analyses.margins.loops import AnalysedLoop
from cspdiag.analyses.margins.margin import frequency_response

_COLOURS = ("#1f4e79", "#c0504d", "#4f8a3c", "#7f5fa0", "#b07d2b", "#3a8f99", "#555555", "#8a2d5c")
_DASHES = ((), (5, 1.5), (1, 1), (6, 1.5, 1, 1.5), (3, 1, 1, 1, 1, 1), (8, 3))
"""Curves can be distinguished in black and white, too."""
_STYLE = {
    "font.family": "DejaVu Sans", "font.size": 9, "axes.spines.top": False, "axes.spines.right": False,
    "axes.linewidth": 0.6, "lines.linewidth": 1.3, "legend.framealpha": 0.8, "legend.edgecolor": "none",
    "legend.fontsize": 8,
    "svg.hashsalt": "cspdiag",
}  # fmt: skip


def bode(loops: Sequence[AnalysedLoop], kind: str) -> bytes:
    """The plot as the content of a file: svg, png or pdf. Equal loops share a curve."""
    import matplotlib as mpl
    import numpy
    from matplotlib.figure import Figure
    from matplotlib.ticker import MultipleLocator

    with mpl.rc_context(_STYLE):  # type: ignore[arg-type]
        figure = Figure(figsize=(7.6, 5.6), layout="constrained")
        magnitude, phase = figure.subplots(2, 1, sharex=True)
        for number, (names, loop) in enumerate(_distinct(loops)):
            colour = _COLOURS[number % len(_COLOURS)]
            look: dict[str, Any] = {"color": colour, "linestyle": (0, _DASHES[number % len(_DASHES)])}
            response = frequency_response(loop.opened)
            size = numpy.maximum(abs(response.values), 1e-12)
            degrees = numpy.degrees(numpy.unwrap(numpy.angle(response.values)))
            degrees -= 360 * round((degrees[len(degrees) // 2] + 180) / 360)
            label = _label(names, loop)
            nyquist = response.frequencies[-1]
            shown = (response.frequencies > nyquist * 3e-4) & (response.frequencies < nyquist * 0.97)
            magnitude.plot(response.frequencies[shown], 20 * numpy.log10(size[shown]), label=label, **look)
            phase.plot(response.frequencies[shown], degrees[shown], **look)
            _mark(magnitude, phase, loop, response.frequencies, degrees, colour)
        magnitude.axhline(0, color="#888888", linewidth=0.7)
        phase.axhline(-180, color="#888888", linewidth=0.7)
        magnitude.set_xscale("log")
        magnitude.set_ylabel("open loop (dB)")
        phase.set_ylabel("phase (deg)")
        low, high = phase.get_ylim()
        phase.set_ylim(max(low, -720), high)
        phase.yaxis.set_major_locator(MultipleLocator(90 if high - max(low, -720) > 270 else 45))
        phase.set_xlabel("frequency (rad/s), each up to half its sample frequency")
        for axes in (magnitude, phase):
            axes.grid(visible=True, which="both", color="#e4e4e4", linewidth=0.5)
        legend = figure.legend(loc="outside lower left", handlelength=3.2)
        figure.set_figheight(5.2 + 0.2 * len(legend.get_lines()))
        file = io.BytesIO()
        metadata = {"Date": None} if kind == "svg" else {"CreationDate": None} if kind == "pdf" else {}
        figure.savefig(file, format=kind, dpi=150, metadata=metadata)
    return file.getvalue()


def _distinct(loops: Sequence[AnalysedLoop]) -> list[tuple[list[str], AnalysedLoop]]:
    found: dict[Any, tuple[list[str], AnalysedLoop]] = {}
    for loop in loops:
        key = (loop.opened.period, loop.margins)
        found.setdefault(key, ([], loop))[0].append(loop.opened.cut.name)
    return list(found.values())


def _label(names: Sequence[str], loop: AnalysedLoop) -> str:
    """The loop, the number of other loops that are equal, and its margins."""
    equal = f" and {len(names) - 1} equal" if len(names) > 1 else ""
    found = loop.margins
    if not found.is_stable:
        return f"{names[0]}{equal}: unstable"
    gain = "any gain" if math.isinf(found.gain) else f"{20 * math.log10(found.gain):.1f} dB"
    phase = "any phase" if math.isinf(found.phase) else f"{found.phase:.0f}°"
    return f"{names[0]}{equal}: {gain}, {phase}"


def _mark(magnitude: Any, phase: Any, loop: AnalysedLoop, frequencies: Any, degrees: Any, colour: str) -> None:
    """The phase margin as a line down to -180 degrees at its crossover, the gain margin as a line up to 0 dB."""
    import numpy

    found = loop.margins
    if found.crossover is not None and math.isfinite(found.phase):
        at = float(numpy.interp(found.crossover, frequencies, degrees))
        phase.plot(
            [found.crossover] * 2, [at - found.phase, at], color=colour, linewidth=2.4, alpha=0.6, solid_capstyle="butt"
        )
    if found.phase_crossover is not None and math.isfinite(found.gain) and found.gain > 0:
        level = -20 * math.log10(found.gain)
        magnitude.plot(
            [found.phase_crossover] * 2, [level, 0], color=colour, linewidth=2.4, alpha=0.6, solid_capstyle="butt"
        )
