"""The largest sample period that still leaves a margin.

A period is a constant of the text, on which the laws depend too: their coefficients follow it. So the program is compiled again for every period that
is looked at.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Literal

from cspdiag.analyses.margins.margin import Margins
from cspdiag.analyses.margins.system import OpenLoop
from cspdiag.network.expressions import LiteralValue
from cspdiag.network.ir import Network, ProcessClass

Measure = Callable[[Mapping[str, int]], "Margins | None"]
"""The margins of a loop with constants set, in nanoseconds; None where the program has no such loop then."""

LARGEST_FACTOR = 64
RESOLUTION = 200
"""The answer is found to this part of the present period."""


@dataclass(frozen=True)
class Wanted:
    """What must be left: so many degrees, a factor of gain, seconds of delay, or merely stability."""

    kind: Literal["phase", "gain", "delay", "stable"]
    value: float

    def is_left(self, margins: Margins) -> bool:
        """Whether a loop has as much."""
        if not margins.is_stable:
            return False
        found = {"phase": margins.phase, "gain": margins.gain, "delay": margins.delay, "stable": 1.0}[self.kind]
        return abs(found) >= self.value if self.kind == "phase" else found >= self.value


def wanted(text: str) -> Wanted:
    """``30deg``, ``6dB``, ``2``, ``5ms`` or ``stable``. Raises ValueError."""
    compact = text.replace(" ", "")
    if compact == "stable":
        return Wanted("stable", 0.0)
    for suffix, kind, scale in (
        ("deg", "phase", 1.0),
        ("us", "delay", 1e-6),
        ("ms", "delay", 1e-3),
        ("s", "delay", 1.0),
    ):
        if compact.endswith(suffix):
            return Wanted(kind, scale * _positive(compact.removesuffix(suffix), text))  # type: ignore[arg-type]
    if compact.endswith("dB"):
        return Wanted("gain", 10 ** (_positive(compact.removesuffix("dB"), text) / 20))
    return Wanted("gain", _positive(compact, text))


def _positive(number: str, text: str) -> float:
    try:
        value = float(number)
    except ValueError:
        value = -1.0
    if not 0 < value < 1e9:
        raise ValueError(f"a margin is 30deg, 6dB, a factor of gain, a delay such as 5ms, or stable, not {text!r}")
    return value


def period_constants(network: Network, loop: OpenLoop) -> dict[str, int]:
    """The constants of the text that say the period of the loop's own law, with their values in nanoseconds; empty where it is a number in the text."""
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


def largest_period(measure: Measure, constants: Mapping[str, int], wanted: Wanted) -> int | None:
    """The largest period in nanoseconds up to which the loop keeps what is wanted; None where no period that was looked at does.

    All constants are scaled together. Between the periods that are looked at the margin is taken to fall, as that of a sampled loop does.
    """
    present = max(constants.values())

    def is_left(period: int) -> bool:
        found = measure({name: value * period // present for name, value in constants.items()})
        return found is not None and wanted.is_left(found)

    bounds = _bounds(is_left, present)
    if bounds is None:
        return None
    kept, lost = bounds
    resolution = max(1000, present // RESOLUTION)
    while lost - kept > resolution:
        middle = (kept + lost) // 2 // 1000 * 1000
        if is_left(middle):
            kept = middle
        else:
            lost = middle
    return kept


def _bounds(is_left: Callable[[int], bool], present: int) -> tuple[int, int] | None:
    """A period that keeps the margin and a longer one that does not."""
    if is_left(present):
        kept = present
        for longer in _doubled(present):
            if not is_left(longer):
                return kept, longer
            kept = longer
        return kept, kept
    lost = present
    for _ in range(6):
        shorter = lost // 2
        if shorter < 1000:
            return None
        if is_left(shorter):
            return shorter, lost
        lost = shorter
    return None


def _doubled(present: int) -> Iterator[int]:
    factor = 2
    while factor <= LARGEST_FACTOR:
        yield present * factor
        factor *= 2
