"""Stability and margins of a loop that is cut open.

The margins are computed by python-control; a loop is stable if every eigenvalue of the closed loop lies within the unit
circle (Franklin, Powell and Workman, Digital Control of Dynamic Systems, 1998).
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from cspdiag.analyses.margins.open_loop import OpenLoop, minimal
from cspdiag.base.record import record

if TYPE_CHECKING:
    import numpy

    Matrix = numpy.ndarray[tuple[int, ...], numpy.dtype[numpy.float64]]


GRID = 800
"""The number of frequencies at which the response is computed, up to half the sample frequency."""


@record
class Margins:
    """The margins of one loop; infinite where nothing limits them. A stable loop stays stable if

    - its gain is multiplied by less than ``gain`` and more than ``lowest_gain``;
    - its phase lags by less than ``phase`` degrees more, or by less than ``delay`` seconds at its most
      sensitive frequency.

    For an unstable loop, ``gain`` below 1 is the factor that would make it stable and ``phase`` what is missing.
    ``modulus`` is the distance of the Nyquist curve from -1, ``crossover`` and ``phase_crossover`` are in rad/s,
    ``radius`` is the largest absolute eigenvalue of the closed loop, and ``drifts`` means that a state outside the loop
    integrates without limit (an angle whose speed is controlled).
    """

    is_stable: bool
    radius: float
    gain: float
    lowest_gain: float
    phase: float
    delay: float
    modulus: float
    crossover: float | None
    phase_crossover: float | None
    drifts: bool


def stability(loop: OpenLoop) -> float:
    """How far the eigenvalues of the closed loop lie within the unit circle; at most 0 if it is not stable."""
    return _inside(_closed_radius(*minimal(loop))[0])


def margins(loop: OpenLoop) -> Margins:
    """Stability and margins of a loop."""
    import numpy

    a, b, c, d = minimal(loop)
    radius, drifts = _closed_radius(a, b, c, d)
    is_stable = _inside(radius) > 0
    response = frequency_response(loop)
    import control  # type: ignore[import-untyped]

    measured = (abs(response.values), numpy.degrees(numpy.unwrap(numpy.angle(response.values))), response.frequencies)
    gains, phases, moduli, gain_at, phase_at, _ = (
        numpy.atleast_1d(part) for part in control.stability_margins(measured, returnall=True, method="frd")
    )
    crossings = [(float(g), float(w)) for g, w in zip(gains, gain_at, strict=True) if g > 0]
    last = _at_half_the_sample_frequency(a, b, c, d)
    if last < 0:
        # At half the sample frequency the response is real: a crossing that lies on no grid.
        crossings.append((-1 / last, math.pi / loop.period))
    candidates = [part for part in crossings if (part[0] > 1) == is_stable]
    gain, phase_crossover = (
        (min(candidates) if is_stable else max(candidates)) if candidates else (math.inf if is_stable else 0.0, None)
    )
    lowest = max((g for g, _ in crossings if g < 1), default=0.0) if is_stable else 0.0
    lags = [(float((p + 180) % 360 - 180), float(w)) for p, w in zip(phases, phase_at, strict=True)]
    phase, crossover = min(lags, key=lambda part: abs(part[0]), default=(math.inf, None))
    delay = min((math.radians(p % 360) / w for p, w in lags), default=math.inf) if is_stable else 0.0
    modulus = float(min(moduli, default=math.inf)) if len(moduli) else float(min(abs(1 + response.values)))
    return Margins(is_stable, radius, gain, lowest, phase, delay, modulus, crossover, phase_crossover, drifts)


@record
class Response:
    """The frequency response of the open loop, with frequencies in rad/s and negative feedback."""

    frequencies: Any
    values: Any


def frequency_response(loop: OpenLoop) -> Response:
    """L(e^jwT) on a logarithmic grid up to half the sample frequency."""
    import numpy

    a, b, c, d = minimal(loop)
    nyquist = math.pi / loop.period
    frequencies = numpy.geomspace(nyquist * 1e-5, nyquist * (1 - 1e-6), GRID)
    points = numpy.exp(1j * frequencies * loop.period)
    if not len(a):
        return Response(frequencies, numpy.full(GRID, -complex(d)))
    shifted = points[:, None, None] * numpy.eye(len(a)) - a
    return Response(
        frequencies, -(c @ numpy.linalg.solve(shifted, numpy.broadcast_to(b, (GRID, *b.shape))))[:, 0, 0] - d
    )


def _at_half_the_sample_frequency(a: Matrix, b: Matrix, c: Matrix, d: float) -> float:
    """The response there, which is real; zero if a pole lies there, so that no gain makes it -1."""
    import numpy

    if not len(a):
        return -d
    try:
        return float((-(c @ numpy.linalg.solve(-numpy.eye(len(a)) - a, b)) - d).real[0, 0])
    except numpy.linalg.LinAlgError:
        return 0.0


def _inside(radius: float) -> float:
    """The distance from the unit circle, less what rounding may have added."""
    return 1 - 1e-9 - radius


def _closed_radius(a: Matrix, b: Matrix, c: Matrix, d: float) -> tuple[float, bool]:
    """The largest absolute eigenvalue of the closed loop, and whether one at 1 was ignored that the loop cannot observe
    or control.
    """
    import numpy

    if not len(a):
        return 0.0, False
    closed = a + b @ c / (1 - d)
    largest, drifts = 0.0, False
    identity = numpy.eye(len(a))
    scale = numpy.linalg.norm(a, 2)
    for value in numpy.linalg.eigvals(closed):
        if abs(value - 1) < 1e-6:
            unobservable = numpy.linalg.svd(numpy.vstack([value * identity - a, c]), compute_uv=False)[-1]
            uncontrollable = numpy.linalg.svd(numpy.hstack([value * identity - a, b]), compute_uv=False)[-1]
            if min(unobservable, uncontrollable) < 1e-6 * scale:
                drifts = True
                continue
        largest = max(largest, float(abs(value)))
    return largest, drifts
