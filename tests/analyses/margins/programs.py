"""Small loops whose margins are known."""

from __future__ import annotations

from cspdiag.analyses.margins.loops import AnalysedLoop, LoopReport, analyse_loops
from cspdiag.api import LoadedProgram
from cspdiag.base import SourceFile

INTEGRATOR = """
const T = 10 ms

submodel Law {{
  in  y : double
  out u : double
  u = -({gain}) * y
}}

process Main {{
  in  y : double @ T
  out u : double @ T {latch}

  communication {{
    law : Law

    y     -> law.y
    law.u -> u
  }}

  composition {{ mu law }}
}}

submodel Plant {{
  in  u : double
  out y : double
  state x : double = 1
  der x = u / 1<s>
  y = x
}}

environment Bench for Main {{
  plant : Plant

  u       -> plant.u
  plant.y -> y
}}
"""
"""An integrator under proportional control; both are linear."""

TWO_RATES = """
const Tfast = 1 ms
const Tslow = 5 ms

submodel Inner {{
  in  reference, y : double
  out u            : double
  u = 40 * (reference - y)
}}

submodel Outer {{
  in  y         : double
  out reference : double
  state i : double = 0
  next i = i - sample / 1<s> * y
  reference = {gain} * (i - y)
}}

process Fast {{
  in  reference : double
  in  y         : double @ Tfast
  out u         : double @ Tfast

  communication {{
    law : Inner
    var target : double = 0

    target -> law.reference
    y      -> law.y
    law.u  -> u
  }}

  composition {{
    mu (reference ? target -> skip []> y -> law)
  }}
}}

process Main {{
  in  speed : double @ Tfast
  in  angle : double @ Tslow
  out u     : double @ Tfast

  communication {{
    inner : Fast
    outer : Outer

    angle           -> outer.y
    outer.reference -> wanted : double -> inner.reference
    speed           -> inner.y
    inner.u         -> u
  }}

  composition {{ {order} }}
}}

submodel Plant {{
  in  u     : double
  out speed : double
  out angle : double
  state v : double = 0
  state x : double = 1
  der v = (u - v) / 50 ms
  der x = 20 * v / 1<s>
  speed = v
  angle = x
}}

environment Bench for Main {{
  plant : Plant

  u           -> plant.u
  plant.speed -> speed
  plant.angle -> angle
}}
"""
"""A fast inner loop and a slow outer one."""


def program(text: str, **values: object) -> LoadedProgram:
    """Load a program from one of the texts."""
    return LoadedProgram(SourceFile(name="loop.csp", text=text.format(**values)))


def loops(loaded: LoadedProgram, **options: object) -> LoopReport:
    """The loops of a program in its first environment."""
    network = loaded.network
    return analyse_loops(network, network.environments[0], **options)  # type: ignore[arg-type]


def only_loop(loaded: LoadedProgram) -> AnalysedLoop:
    """The single loop of a program."""
    report = loops(loaded)
    assert report.refusals == ()
    (loop,) = report.loops
    return loop
