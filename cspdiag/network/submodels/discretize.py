"""Discretization of transfer functions and state spaces for a sample period.

Results are coefficients in the increment ``d = z - 1``: they stay accurate when the sample period is short, where those
in ``z`` cancel (Middleton and Goodwin, Digital Control and Estimation, 1990, chapter 3). ``tustin``, ``euler`` and
``backward`` substitute a rational function of ``d`` for ``s``; ``zoh`` is computed by python-control. numpy and
python-control are imported only where they are needed.
"""

from __future__ import annotations

from collections.abc import Sequence
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    import numpy

Method = Literal["tustin", "zoh", "euler", "backward"]

Polynomial = list[float]
"""Coefficients from the highest power down to the constant."""

Matrix = Sequence[Sequence[float]]


def missing_package(method: Method, *, is_statespace: bool) -> str | None:
    """The package that a discretization needs and that is not there, as in a browser; None if nothing is missing."""
    needs_numpy = is_statespace or method in ("zoh", "euler")
    needed = {"numpy": needs_numpy, "control": method == "zoh"}
    return next((name for name, is_needed in needed.items() if is_needed and find_spec(name) is None), None)


def transfer_coefficients(
    numerator: Sequence[float], denominator: Sequence[float], method: Method, sample: float
) -> tuple[Polynomial, Polynomial]:
    """Coefficients b_0 ... b_n and a_1 ... a_n of the difference equation in ``d`` of a proper transfer function.

    ``numerator`` and ``denominator`` are polynomials in s, from the highest power down; the first coefficient of the
    denominator is not zero. ``sample`` is in seconds. y = (b_0 dⁿ + ... + b_n) / (dⁿ + a_1 dⁿ⁻¹ + ... + a_n) u.
    """
    order = len(denominator) - 1
    # With the sample period as the unit of time, all coefficients of a fast sampled system are small.
    padded = [0.0] * (order + 1 - len(numerator)) + list(numerator)
    top, bottom = ([c * sample**k for k, c in enumerate(polynomial)] for polynomial in (padded, denominator))
    if method == "zoh":
        return _zero_order_hold(top, bottom)
    above, below = (_substituted(polynomial, method) for polynomial in (top, bottom))
    lead = below[0]
    return [c / lead for c in above], [c / lead for c in below[1:]]


def _substituted(polynomial: Polynomial, method: Method) -> Polynomial:
    """The polynomial with s = p(d) / q(d), times q(d)ⁿ, for a sample period of 1."""
    p, q = {"tustin": ([2.0, 0.0], [1.0, 2.0]), "backward": ([1.0, 0.0], [1.0, 1.0])}.get(
        method, ([1.0, 0.0], [0.0, 1.0])
    )
    order = len(polynomial) - 1
    result = [0.0] * (order + 1)
    for k, coefficient in enumerate(polynomial):
        term = [coefficient]
        for factor in [p] * (order - k) + [q] * k:
            term = _product(term, factor)
        for position, value in enumerate(term[-(order + 1) :]):
            result[position + order + 1 - len(term[-(order + 1) :])] += value
    return result


def _product(left: Polynomial, right: Polynomial) -> Polynomial:
    result = [0.0] * (len(left) + len(right) - 1)
    for i, a in enumerate(left):
        for k, b in enumerate(right):
            result[i + k] += a * b
    return result


def _zero_order_hold(top: Polynomial, bottom: Polynomial) -> tuple[Polynomial, Polynomial]:
    import numpy

    order = len(bottom) - 1
    if order == 0:
        return [top[0] / bottom[0]], []
    b = [c / bottom[0] for c in top]
    a = [c / bottom[0] for c in bottom]
    # Controllable canonical form, with its states scaled so that the entries next to the coefficients are 1.
    dynamics = numpy.eye(order, k=1)
    dynamics[-1, :] = [-c for c in a[:0:-1]]
    entrance = numpy.zeros((order, 1))
    entrance[-1, 0] = 1.0
    outlet = numpy.array([[b[order - k] - a[order - k] * b[0] for k in range(order)]])
    increment, effect = _held(dynamics, entrance, 1.0)
    # Faddeev and LeVerrier: coefficients of det(dI - F) and of C adj(dI - F) G.
    share = numpy.eye(order)
    above, below = [b[0]], []
    for k in range(1, order + 1):
        along = increment @ share
        below.append(float(-numpy.trace(along) / k))
        above.append(float((outlet @ share @ effect).item()) + below[-1] * b[0])
        share = along + below[-1] * numpy.eye(order)
    return above, below


def _held(
    dynamics: numpy.ndarray[Any, Any], entrance: numpy.ndarray[Any, Any], sample: float
) -> tuple[numpy.ndarray[Any, Any], numpy.ndarray[Any, Any]]:
    """The increment of the state over a sample with the input held: (exp(A·T) - I, its integral times B)."""
    import control  # type: ignore[import-untyped]
    import numpy

    order, width = entrance.shape
    system = control.ss(dynamics, entrance, numpy.eye(order), numpy.zeros((order, width)))
    sampled = control.sample_system(system, sample, method="zoh")
    return sampled.A - numpy.eye(order), sampled.B


def statespace_increments(
    a: Matrix, b: Matrix, c: Matrix, d: Matrix, method: Method, sample: float
) -> tuple[tuple[tuple[float, ...], ...], ...]:
    """F, G, C, D of x' = x + F·x + G·u, y = C·x + D·u for the state space A (nxn), B (nxm), C (pxn), D (pxm)."""
    import numpy

    dynamics, entrance, outlet, direct = (numpy.array(matrix, dtype=float) for matrix in (a, b, c, d))
    if method == "zoh":
        increment, effect = _held(dynamics, entrance, sample)
    else:
        # The generalized bilinear transformation; the state is that before the present input is added.
        weight = {"tustin": 0.5, "euler": 0.0, "backward": 1.0}[method]
        inverse = numpy.linalg.inv(numpy.eye(len(dynamics)) - weight * sample * dynamics)
        increment, effect = inverse @ dynamics * sample, inverse @ entrance * sample
        direct = direct + weight * outlet @ effect
        outlet = outlet @ inverse
    return tuple(tuple(tuple(map(float, row)) for row in matrix) for matrix in (increment, effect, outlet, direct))


def spectral_radius(denominator: Sequence[float], sample: float) -> tuple[bool, float]:
    """Whether a denominator in s is stable, and the largest |z| of its poles after discretization by euler."""
    import numpy

    poles = numpy.roots(numpy.array(denominator, dtype=float))
    if len(poles) == 0:
        return True, 0.0
    return bool((poles.real < 0).all()), float(abs(1 + poles * sample).max())
