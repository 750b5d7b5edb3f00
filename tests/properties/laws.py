"""Control laws of random programs: states of all kinds, integration, operators with memory, arrays, faults."""

from __future__ import annotations

from dataclasses import dataclass

DEFINITIONS = """submodel Single {
  in  a : double
  out p : double

  state s : double = 0
  next s = 0.5 * s + a
  p = s + a
}

submodel Scaled(k: double = 2, low: double = -4) {
  in  a : double
  out p : double

  let half = k / 2
  let most = max(half, 3)
  p = limit(half * a, low, most) + sign(a) * 0.125
}

submodel Rounded(step_: double) {
  in  a : double
  out p : double

  p = quantize(a, step_) + deadzone(a, 0.5) + pre(a, 0.25) - delay(a, 3, 1) + round(a) * floor(a / 3)
}

submodel Smooth(tau: time = 3 ms) {
  in  a : double
  out p : double

  let rate = derivative(a) * 1 ms
  p = lag(a, tau) + rate + transfer([1], [4 ms, 1], a)
}

submodel Swing(k: double = 1) {
  in  a : double
  out p : double

  state x : double = 0.5
  state v : double = 0
  der x = v / 10 ms
  der v = (k * a - x - 0.2 * v) / 10 ms
  p = x + 0.01 * v
}

submodel Drift step 400 us method = euler {
  in  a : double
  out p : double

  state x : double = 0
  let slope = if x > 2 then -1 else a
  der x = slope / 5 ms
  p = x
}

submodel Count(most: int = 90) {
  in  a : double
  out p : double

  state n : int8 = int8(0)
  state k : int  = 1
  next n = if a > 0.5 then n + int8(30) else int8(0)
  next k = if k > most then 0 else k * 3 - int(n) / k
  p = double(k) / 10 + double(n)
}

submodel Moded {
  in  a : double
  out p : double

  state mode : Mode   = Mode.idle
  state last : Pose   = Pose(x = 0.5, n = 0)
  state seen : int[3] = [0, 0, 7]
  state high : bool   = false
  next mode = if a > 1 then Mode.run else if high then Mode.halt else mode
  next last = Pose(x = a, n = last.n + 1)
  next seen = [seen[1], seen[2], last.n % 5]
  next high = not high and last.x < a
  p = if mode == Mode.run then last.x else double(seen[0] + seen[2])
}

submodel Nested {
  in  a : double
  out p : double

  first  : Single
  second : Scaled(k = 3)
  first.a  = a - 0.5
  second.a = first.p
  p = second.p + sqrt(abs(first.p))
}

submodel Risky {
  in  a : double
  out p : double

  p = 1 / (a - 0.5) + log(a) + exp(2 * a)
}

submodel Double {
  in  a, b : double
  out p, q : double

  state s : double = 1
  next s = limit(s - a, -9, 9)
  p = s + b
  q = 0.5 * a
}

submodel Offset {
  in  a, b : double
  in  c    : double = 0.75
  out p, q : double

  p = atan2(a, c)
  q = b * c
}

submodel Mixed {
  in  a[2] : double
  out p[2] : double

  p[0] = a[0] + 2 * a[1]
  p[1] = min(a[0], a[1])
}
"""


@dataclass(frozen=True)
class LawForm:
    """A definition with its arguments, and the names of its ends."""

    text: str
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    sampled: bool = False
    """Whether it needs to know its sample period."""


ONE = ("a",), ("p",)
TWO = ("a", "b"), ("p", "q")

LAWS = (
    LawForm("Single", *ONE),
    LawForm("Mixed", ("a[0]", "a[1]"), ("p[0]", "p[1]")),
    LawForm("Scaled", *ONE),
    LawForm("Scaled(k = 5, low = -1)", *ONE),
    LawForm("Rounded(step_ = 0.25)", *ONE),
    LawForm("Smooth", *ONE, sampled=True),
    LawForm("Smooth(tau = 5 ms)", *ONE, sampled=True),
    LawForm("Swing", *ONE, sampled=True),
    LawForm("Swing(k = 3)", *ONE, sampled=True),
    LawForm("Drift", *ONE, sampled=True),
    LawForm("Count", *ONE),
    LawForm("Count(most = 20)", *ONE),
    LawForm("Moded", *ONE),
    LawForm("Nested", *ONE),
    LawForm("Risky", *ONE),
    LawForm("Double", *TWO),
    LawForm("Offset", *TWO),
    LawForm("Mixed", ("a[0]", "a[1]"), ("p[0]", "p[1]")),
    LawForm("Mixed", ("a[1]", "a[0]"), ("p[1]", "p[0]")),
)
"""From the simplest one, to which failures shrink."""
