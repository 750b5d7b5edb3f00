"""Random small programs around a linear law and a linear plant: the verdict of the margins has to agree with a run.

A longer search: ``python -m tests.analyses.margins.random_turns COUNT [SEED]``.
"""

from __future__ import annotations

import random
import sys

import numpy

from cspdiag.analyses.margins.linear import NotLinearError
from cspdiag.api import LoadedProgram, ProgramError
from cspdiag.base import SourceFile
from cspdiag.base.errors import CspdiagError

PLANT = """
submodel Plant {{
  in  u    : double
  out y, z : double
  state x : double = 0.1
  state s : double = 0.05
  der x = (25 * u - {leak} * x) / 1<s>
  der s = (10 * x - 10 * s) / 1<s>
  y = x
  z = {measured}
}}
"""

PROGRAM = """
submodel Law {{
  in  a, b : double
  out u    : double
  state i : double = 0
  next i = 0.5 * i + {ki} * a
  u = -({ka}) * a - ({kb}) * b - i
}}

process Carrier {{
  in  y : double @ {slow}
  out c : double

  communication {{
    var w : double = 0
  }}

  composition {{ mu (y ? w ; c ! {gain} * w) }}
}}

process Controller {{
  in  y, z : double @ 10 ms
  in  c    : double
  out u    : double @ {output}

  communication {{
    law : Law
    var v : double = 0
    var w : double = 0
    var q : double = 0

    {a}   -> law.a
    {b}   -> law.b
    {law_u} -> {label} u
  }}

  composition {{ {composition} }}
}}

process Top {{
  in  y, z : double @ 10 ms
  in  r    : double @ {slow}
  out u    : double @ {output}

  communication {{
    controller : Controller
    carrier    : Carrier

    y            -> controller.y
    z            -> controller.z
    r            -> carrier.y
    carrier.c    -> {kind} controller.c
    controller.u -> u
  }}

  composition {{ {parallel} }}
}}

environment Bench for Top {{
  plant : Plant

  u       -> plant.u
  plant.y -> y, r
  plant.z -> z
}}
"""


def generated(chance: random.Random) -> str:
    """A random program."""
    with_carrier = chance.random() < 0.35
    parts = [chance.choice(STATEMENTS) for _ in range(chance.choice((0, 1, 1, 2, 2, 3)))]
    parts.insert(chance.randint(0, len(parts)), "law")
    body = " ; ".join(parts)
    if with_carrier:
        taken = chance.choice(("c ? q -> skip", "c ? v -> skip", "c ? v -> w := 2 * v", "c ? v -> u ! v"))
        order = chance.choice(("[]>", "[]>", "[]"))
        first = next((port for port in "yz" if parts[0].startswith(f"{port} ?")), None)
        branch = None if first is None else f"{first} -> {body}"
        body = f"{taken} {order} {branch}" if branch is not None else f"c ? q ; {body}"
        if branch is not None and chance.random() < 0.5:
            body = f"{branch} {order} {taken}"
    loop = f"mu ({body})"
    if chance.random() < 0.2:
        loop = chance.choice(WRAPPERS).format(loop=loop, body=body)
    values = {
        "ka": chance.choice((0.2, 1, 3, 6)), "kb": chance.choice((0, 0.5, 3, 8)), "ki": chance.choice((0, 0, 0.2)),
        "leak": chance.choice((0, 2, 20, -1)), "measured": chance.choice(("x", "s", "0.5 * x")),
        "slow": chance.choice(("10 ms", "10 ms", "20 ms", "5 ms")), "gain": chance.choice((1, 2, -1)),
        "output": chance.choice((*["10 ms"] * 6, "10 ms immediate", "10 ms offset 3 ms", "5 ms")),
        "a": chance.choice("yyzvw"), "b": chance.choice("zvwqv"), "composition": loop, "law_u": "law.u",
        "label": chance.choice(("", "", "p : double ->")), "kind": chance.choice(("", "", "", "buffer 1 ->")),
        "parallel": chance.choice(("controller || carrier", "controller ||> carrier", "carrier ||> controller")),
    }  # fmt: skip
    text = PROGRAM
    if not with_carrier:
        start, end = text.index("process Carrier"), text.index("process Controller")
        text = text[:start] + text[end:]
        for line in (
            "  in  c    : double\n", "    carrier    : Carrier\n", "    r            -> carrier.y\n",
            "    carrier.c    -> {kind} controller.c\n", "  in  r    : double @ {slow}\n",
        ):  # fmt: skip
            text = text.replace(line, "")
        text = text.replace("{parallel}", "controller").replace("-> y, r", "-> y")
    else:
        text = text.replace("plant.y -> y, r", "plant.y -> y\n  plant.y -> r")
    return (PLANT + text).format(**values)


CHAIN = """
submodel First {{
  in  a : double
  out u : double
  state i : double = 0
  next i = 0.5 * i + {ki} * a
  u = -({ka}) * a - i
}}
submodel Second {{ in c, z : double  out u : double  u = {gain} * c - ({kb}) * z }}
process Outer {{
  in  y : double @ {period}
  out c : double
  communication {{
    law : First
    var v : double = 0
    {a} -> law.a
    law.u -> {written}
  }}
  composition {{ {outer} }}
}}
process Inner {{
  in  c : double
  in  z : double @ 10 ms
  out u : double @ {output}
  communication {{
    law : Second
    var v : double = 0
    var w : double = 0
    {c} -> law.c
    {z} -> law.z
    law.u -> u
  }}
  composition {{ {inner} }}
}}
process Top {{
  in  y : double @ {period}
  in  z : double @ 10 ms
  out u : double @ {output}
  communication {{
    outer : Outer
    inner : Inner
    y       -> outer.y
    outer.c -> inner.c
    z       -> inner.z
    inner.u -> u
  }}
  composition {{ {parallel} }}
}}
environment Bench for Top {{ plant : Plant  u -> plant.u  plant.y -> y  plant.z -> z }}
"""

OUTER = (
    ("y", "c", "mu law"), ("v", "c", "mu (y ? v ; law)"), ("y", "o : double", "mu (law ; c ! 2 * o)"),
    ("v", "o : double", "mu (y ? v ; law ; c ! o + v)"),
    ("y", "o : double", "mu (law ; if o > 0 then c ! o else c ! -o)"),
)  # fmt: skip
"""The inputs of the law, its output, and the composition."""

INNER = (
    ("c", "z", "mu law"), ("v", "z", "mu (c ? v ; law)"), ("v", "z", "mu (law ; c ? v)"),
    ("v", "w", "mu (z ? w ; c ? v ; law)"), ("v", "w", "mu (z ? w ; law ; c ? v)"),
    ("v", "z", "mu (c ? v -> skip []> z -> law)"), ("v", "z", "mu (z -> law []> c ? v -> skip)"),
    ("w", "z", "mu (c ? v -> w := 3 * v []> z -> law)"), ("v", "z", "mu (c ? v -> skip [] z -> law)"),
    ("v", "w", "mu (z ? w -> law []> c ? v -> skip)"),
)  # fmt: skip


def chained(chance: random.Random) -> str:
    """A random program with two laws in parallel processes, one of which writes for the other."""
    a, written, outer = chance.choice(OUTER)
    c, z, inner = chance.choice(INNER)
    return (PLANT + CHAIN).format(
        measured="s", a=a, written=written, outer=outer, c=c, z=z, inner=inner,
        ki=chance.choice((0, 0.2)), ka=chance.choice((0.3, 1, 3, 6)), kb=chance.choice((0, 1, 3)),
        gain=chance.choice((0.5, 1, 2)), leak=chance.choice((0, 2, 20, -1)),
        period=chance.choice(("10 ms", "10 ms", "20 ms", "5 ms")),
        output=chance.choice(("10 ms", "10 ms immediate", "10 ms offset 2 ms")),
        parallel=chance.choice(("outer || inner", "inner || outer", "outer ||> inner", "inner ||> outer")),
    )  # fmt: skip


STATEMENTS = (
    "y ? v", "z ? v", "z ? w", "v := 0.5 * v", "w := v", "w := 2 * v - w", "q := v * v", "u ! 2 * v", "u ! -v", "u ! 0",
    "v := 0", "wait 3 ms", "if v > 0 then w := 1 else w := -1", "reset law", "skip", "law", "q := -w", "v := w",
    "if v > 5 then u ! 0", "while w > 1 do w := 0.5 * w", "w := max(v, -v)", "y ? w", "(y ? v || z ? w)",
)  # fmt: skip

WRAPPERS = (
    "{loop} catch Timeout -> u ! 0", "{loop} interrupt after 10 s -> u ! 0", "mu ({loop} until v > 100)", "mu {loop}",
    "mu (({body}) catch Timeout -> skip)", "mu (({body}) interrupt after 2 ms -> skip)", "law ; {loop}",
    "seq k < 3 : ({body}) ; {loop}", "{loop} until v > 1e300",
)  # fmt: skip

SAMPLES = 400
SHORTEST = 190
"""The number of samples of an input of 20 ms, without those before the first and after the last."""
BEYOND = 1e100


def contradiction(text: str) -> tuple[bool, str | None]:
    """Whether the margins give a verdict on a program, and how a run contradicts it."""

    def program(start: str) -> LoadedProgram:
        changed = text.replace("state x : double = 0.1", f"state x : double = {start}")
        return LoadedProgram(SourceFile(name="random.csp", text=changed))

    report = program("0.1").margins()
    if not report.loops or report.refusals:
        return False, None
    # The slowest loop is the one opened with all the others closed inside it.
    margins = max(report.loops, key=lambda loop: loop.opened.period).margins
    if abs(margins.radius - 1) < 0.03:
        return False, None
    try:
        # The difference of two runs, so that contributions of constants to both cancel out.
        runs = [program(start).run(until=f"{SAMPLES * 10} ms")["y"] for start in ("0.1", "0.2")]
    except CspdiagError:
        # A value beyond the range of numbers is a fault.
        return True, "a fault" if margins.is_stable else None
    signal = numpy.abs(runs[1][: len(runs[0])] - runs[0][: len(runs[1])])
    if max(signal) > BEYOND:
        # A fault may end such a run early.
        return True, "it grows beyond all bounds" if margins.is_stable else None
    if len(runs[0]) != len(runs[1]) or len(signal) < SHORTEST:
        return True, f"a run ends after {len(signal)} samples"
    quarter = len(signal) // 4
    early, late = float(max(signal[quarter : 2 * quarter])), float(max(signal[-quarter:]))
    decays = not late > max(0.7 * early, 1e-9)
    if decays != margins.is_stable:
        return True, f"stable: {margins.is_stable}, radius {margins.radius}, but from {early} to {late}"
    return True, None


def search(count: int, seed: int) -> tuple[int, list[str]]:
    """The number of ``count`` programs that have a verdict, and the programs whose verdicts contradict their runs."""
    chance = random.Random(seed)
    verdicts, wrong = 0, []
    for _ in range(count):
        text = chance.choice((generated, chained))(chance)
        try:
            has_verdict, problem = contradiction(text)
        except (ProgramError, NotLinearError):
            continue
        verdicts += has_verdict
        if problem is not None:
            wrong.append(f"{problem}\n{text}")
    return verdicts, wrong


if __name__ == "__main__":
    found, wrong = search(int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 0)
    print(f"{found} verdicts, {len(wrong)} contradicted by a run")
    print("\n\n".join(wrong[:4]))
