"""The largest sample period with a required margin.

A period is a constant of the text, and the coefficients of the laws may depend on it. So the network is built again for
every period that is tried, and the loop is cut open in it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Literal

from cspdiag.analyses.margins.margin import margins, stability
from cspdiag.analyses.margins.open_loop import OpenLoop
from cspdiag.base.record import record
from cspdiag.network.ir.expressions import LiteralValue
from cspdiag.network.ir.network import CoreNetwork, ProcessClass

Variant = Callable[[Mapping[str, int]], "OpenLoop | None"]
"""A loop with constants set, in nanoseconds; None if the program then has no such loop."""

DOUBLINGS = 6
"""Periods up to 2^6 times longer or shorter are tried."""
DIGITS = 4
"""The number of significant digits of the result."""
LARGEST_MARGIN, LARGEST_DECIBELS = 1e9, 180.0
"""The largest margin that can be required, and the largest gain in dB."""


@record
class RequiredMargin:
    """The margin that is required: a number of degrees, a factor of gain, seconds of delay, or only stability."""

    kind: Literal["phase", "gain", "delay", "stable"]
    value: float

    def excess(self, loop: OpenLoop) -> float:
        """How much more margin a loop has: from -1 (it is unstable) over 0 (exactly enough) to 1 (at least twice as
        much).
        """
        if self.kind == "stable":
            return stability(loop)
        if stability(loop) <= 0:
            return -1.0
        found = margins(loop)
        remaining = {"phase": abs(found.phase), "gain": found.gain, "delay": found.delay}[self.kind]
        return min(remaining / self.value, 2.0) - 1


def parse_margin(text: str) -> RequiredMargin:
    """The margin in a text: ``30deg``, ``6dB``, ``2``, ``5ms`` or ``stable``. Raises ValueError."""
    compact = text.replace(" ", "")
    if compact == "stable":
        return RequiredMargin("stable", 0.0)
    for suffix, kind, scale in (
        ("deg", "phase", 1.0),
        ("us", "delay", 1e-6),
        ("ms", "delay", 1e-3),
        ("s", "delay", 1.0),
    ):
        if compact.endswith(suffix):
            return RequiredMargin(kind, scale * _positive(compact.removesuffix(suffix), text))  # type: ignore[arg-type]
    if compact.endswith("dB"):
        decibels = _positive(compact.removesuffix("dB"), text)
        return RequiredMargin("gain", 10 ** (_limited(decibels, LARGEST_DECIBELS, text) / 20))
    return RequiredMargin("gain", _positive(compact, text))


def _positive(number: str, text: str) -> float:
    try:
        value = float(number)
    except ValueError:
        value = -1.0
    return _limited(value, LARGEST_MARGIN, text)


def _limited(value: float, most: float, text: str) -> float:
    if not 0 < value <= most:
        raise ValueError(f"a margin is 30deg, 6dB, a factor of gain, a delay such as 5ms, or stable, not {text!r}")
    return value


def period_constants(network: CoreNetwork, loop: OpenLoop) -> dict[str, int]:
    """The constants of the text that give the period of the loop's own law, with their values in nanoseconds; empty if
    the period is a number in the text.
    """
    top = network.class_named(network.top)
    assert isinstance(top, ProcessClass)
    nets = {
        net.path.partition(".")[2]
        for net in network.nets
        for path, _ in (*net.readers, *net.writers)
        if path == loop.cut.law
    }
    found: dict[str, int] = {}
    for port in top.ports:
        period = port.period
        if isinstance(period, LiteralValue) and period.name is not None and isinstance(period.value, int):
            is_own = port.name in nets or any(name.startswith(f"{port.name}[") for name in nets)
            if is_own and period.value == round(loop.period * 1e9):
                found[period.name] = period.value
    return found


def largest_period(variant: Variant, constants: Mapping[str, int], required: RequiredMargin) -> int | None:
    """The largest period in nanoseconds up to which the loop has the required margin; None if it does at no period
    tried.

    All constants are scaled together. Between the periods that are tried the margin is assumed to decrease, as it does
    for sampled loops. The root is found by the method of Alefeld, Potra and Shi (1995), which needs few periods.
    """
    present = max(constants.values())
    grain = 10 ** max(0, len(str(present)) - DIGITS)
    known: dict[int, float] = {}

    def excess(period: float) -> float:
        whole = round(period / grain) * grain
        if whole not in known:
            loop = variant({name: value * whole // present for name, value in constants.items()})
            known[whole] = -1.0 if loop is None else required.excess(loop)
        return known[whole]

    bounds = _bounds(excess, present)
    if bounds is None:
        return None
    kept, lost = bounds
    if kept < lost:
        from scipy.optimize import toms748  # type: ignore[import-untyped]

        # Exactly enough counts as kept: the sign has to differ at the bounds.
        toms748(lambda period: excess(period) or 1e-12, kept, lost, xtol=grain / 2)
    least_lost = min((period for period, remaining in known.items() if remaining < 0 and period >= kept), default=lost)
    return max(period for period, remaining in known.items() if remaining >= 0 and period <= least_lost)


def _bounds(excess: Callable[[int], float], present: int) -> tuple[int, int] | None:
    """A period with the margin and a longer one without it; the same period twice if no longer one lacks it."""
    if excess(present) >= 0:
        kept = present
        for longer in (present * 2**k for k in range(1, DOUBLINGS + 1)):
            if excess(longer) < 0:
                return kept, longer
            kept = longer
        return kept, kept
    lost = present
    for _ in range(DOUBLINGS):
        shorter = lost // 2
        if shorter < 1000:
            return None
        if excess(shorter) >= 0:
            return shorter, lost
        lost = shorter
    return None
