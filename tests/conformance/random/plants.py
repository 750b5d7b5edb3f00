"""Random plants: some linear, in one block or in several, some not, in steps or in sub-steps."""

from __future__ import annotations

from random import Random

TERMS = (
    "{state}", "-{state}", "{c} * {state}", "{c} * {state}", "{state} / {c}", "{c} * ({state} - {other})",
    "-(gain * {state})", "moved", "s[{index}]", "{state} * {c} / gain",
)  # fmt: skip
HELD = ("{c}", "u", "-u", "{c} * u", "double(count) / {c}", "abs(u)", "(if count > 2 then {c} else u)", "u / (u + {c})")
OTHERS = ("sin({state})", "time * {c}<1/s>", "u * {state}", "(if {state} > 0 then {c} else u)")
"""What makes a derivative, and those that belong to it, not linear."""


def plant(seed: int) -> str:
    """The submodel `Plant`, which is linear in three of four programs."""
    draw = Random(f"plant {seed}")
    states = ["x", *(f"x{number}" for number in range(1, draw.randint(1, 5)))]
    groups = draw.randint(1, 2)
    curved = draw.random() < 0.25

    def term(state: str, forms: tuple[str, ...]) -> str:
        near = [other for other in states if states.index(other) % groups == states.index(state) % groups]
        c = draw.choice(["2.0", "0.5", "-3.25", "100.0", "-800.0", "1e-3"])
        state, other, index = draw.choice(near), draw.choice(near), draw.randint(0, 1)
        return draw.choice(forms).format(state=state, other=other, c=c, index=index)

    def slope(state: str) -> str:
        parts = [term(state, TERMS) for _ in range(draw.randint(0, 3))]
        parts += [term(state, HELD)] if draw.random() < 0.6 else []
        parts += [term(state, OTHERS)] if curved and draw.random() < 0.5 else []
        draw.shuffle(parts)
        return draw.choice([" + ", " - "]).join(parts) or "0.0"

    lines = [f"  state {name} : double = {draw.choice(['1', '-0.0', '0', '0.3'])}" for name in states]
    lines += [f"  der {name} = {slope(name)}" for name in states]
    step = draw.choice(["", "", " step 300 us", " step 1 ms"])
    return f"""exception Overheated
exception Jammed

submodel Plant(gain: double = {draw.choice(["4", "-0.5"])}){step} {{
  in  u     : double
  in  count : int
  out y, z  : double
  out press : int
  out turn  : int

{chr(10).join(lines)}
  state n : int       = 0
  state k : double    = 0
  state s : double[2] = [1, 2]
  let moved = {draw.choice(states)} - 2 * s[0] + k
  der s  = [u - s[0], s[0] - {draw.choice(["s[1]", states[-1]])}]
  next n = n + 1
  next k = -k + 0.25
  y     = x
  z     = 2 * {states[-1]} + s[1]
  press = n / 3
  turn  = (n + count) / 2
}}
"""
