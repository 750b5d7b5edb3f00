"""No part of the compiler is much worse than linear in the text or the instances, measured in calls of functions, not
in time.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import pytest

from cspdiag import pipeline
from cspdiag.base import SourceFile
from cspdiag.base.render.text import render
from cspdiag.base.sources import read_source
from tests.support.counting import calls
from tests.support.nested import nested

MOST = 2.6
"""The maximum growth for twice the size: n log n, with room for what does not grow at all."""


def ring(n: int) -> str:
    """Instances of one class in a ring."""
    return f"""process Cell {{ in i : int out o : int communication {{ var v : int = 0 }} composition {{ mu (i ? v ; o ! v) }} }}
process Top {{
  communication {{
    cell[{n}] : Cell
    for k < {n} {{ cell[k].o -> link : int -> cell[(k + 1) % {n}].i }}
  }}
  composition {{ par k < {n} : cell[k] }}
}}
"""


def classes(n: int) -> str:
    """As many classes as instances, each run twice."""
    processes = [f"process P{k} {{ out o : int composition {{ o ! {k} }} }}" for k in range(n)]
    instances = [f"    p{k} : P{k}\n    p{k}.o -> c{k} : int -> sink.i[{k}]" for k in range(n)]
    steps = " ; ".join(f"i[{k}] ? v" for k in range(n))
    sink = f"process Sink {{ in i[{n}] : int communication {{ var v : int }} composition {{ mu ({steps}) }} }}"
    runs = " ; ".join(f"p{k} ; p{k}" for k in range(n))
    body = "process Top {\n  communication {\n    sink : Sink\n" + "\n".join(instances)
    return "\n".join([*processes, sink, f"{body}\n  }}\n  composition {{ ({runs}) || sink }}\n}}\n"])


def equations(n: int) -> str:
    """A law with many equations and states."""
    states = [f"  state s{k} : double = 0\n  next s{k} = x{k}" for k in range(n)]
    lets = [f"  let x{k} = 0.5 * s{k} + {f'x{k - 1}' if k else 'u'}" for k in range(n)]
    law = "\n".join(["submodel Law {", "  in u : double", "  out y : double", *states, *lets, f"  y = x{n - 1}", "}"])
    return f"""{law}
process Top {{
  in  u : double @ 1 ms
  out y : double @ 1 ms
  communication {{ law : Law u -> law.u law.y -> y }}
  composition {{ mu law }}
}}
submodel Source {{ out u : double u = 1.0 }}
environment Bench for Top {{ source : Source source.u -> u y -> _ }}
"""


def unconnected(n: int) -> str:
    """An array of ports of which an environment connects one: E0801."""
    return f"""process Top {{
  in limits[{n}] : int
  in x : int
  communication {{ var v : int = 0 }}
  composition {{ mu (x ? v) }}
}}
submodel Source {{ out u : int u = 1 }}
environment Bench for Top {{ source : Source source.u -> x source.u -> limits[3] }}
"""


def runs_of_laws(n: int) -> str:
    """Two laws that read one variable, run one after the other again and again."""
    return f"""submodel Law {{ in x : double out y : double y = 2 * x }}
process Top {{
  communication {{
    one : Law other : Law
    var x : double = 1 var y : double var z : double
    x -> one.x one.y -> y x -> other.x other.y -> z
  }}
  composition {{ seq i < {n} : (one ; other) }}
}}
"""


def compiled(text: str) -> None:
    """Check, and generate all packages, or show what is wrong."""
    built = pipeline.build(SourceFile(name="large.csp", text=text), read_source)
    if built.network is None:
        render(built.checked.report.diagnostics)
        return
    for target, level in (("python", 0), ("python", 1), ("c", 1)):
        pipeline.generate(built.network, read_source, target, level)


@pytest.mark.parametrize("shape", [ring, classes, equations, unconnected])
def test_twice_the_size_is_hardly_more_than_twice_the_work(shape: Callable[[int], str]) -> None:
    compiled(shape(8))
    small, large = (calls(partial(compiled, shape(n))) for n in (24, 48))
    assert large <= MOST * small


def test_reading_ends_of_laws_that_run_at_many_places() -> None:
    def lowering(n: int) -> int:
        checked = pipeline.check(SourceFile(name="runs.csp", text=runs_of_laws(n)), read_source)
        return calls(partial(pipeline.compile_network, checked))

    lowering(8)
    assert lowering(400) <= MOST * lowering(200)


def test_alternatives_inside_each_other() -> None:
    def checking(levels: int) -> int:
        source = SourceFile(name="nested.csp", text=nested("ready alternative", levels))
        return calls(partial(pipeline.check, source, read_source))

    checking(6)
    assert checking(16) <= MOST * checking(8)
