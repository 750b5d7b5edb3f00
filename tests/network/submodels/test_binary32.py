"""Numbers in the text that are used as binary32 are rounded like every other binary32."""

from __future__ import annotations

from cspdiag import pipeline
from cspdiag.base import SourceFile
from cspdiag.base.sources import read_source
from cspdiag.simulate.run.execute import simulate

PROGRAM = """\
const third : float = 0.3333

process Main {
  out y : float
  communication { var x : float = 0.1 }
  composition { y ! x ; y ! 0.7 ; y ! -0.1 ; y ! third ; y ! limit(x, 0.2, 0.3) }
}

submodel Sink { in y : float }
environment Bench for Main { sink : Sink y -> sink.y }
"""


def test_literals_constants_and_initial_values_are_rounded() -> None:
    network = pipeline.build(SourceFile(name="case.csp", text=PROGRAM), read_source).network
    assert network is not None
    for level in (0, 1):
        run = simulate(network, pipeline.generate(network, read_source, level=level))
        assert [value for _, _, value, *_ in run.communications] == [
            0.10000000149011612, 0.699999988079071, -0.10000000149011612, 0.33329999446868896, 0.20000000298023224,
        ]  # fmt: skip
