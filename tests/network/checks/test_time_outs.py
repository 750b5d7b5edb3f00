"""Time-outs that W0615 reports never to elapse do not elapse, and the others do."""

from __future__ import annotations

from itertools import product

import pytest

from cspdiag import pipeline
from cspdiag.base.sources import read_source
from cspdiag.base.span import SourceFile
from cspdiag.simulate.run import execute

PROGRAM = """
process Main {{
  in  a     : double @ 2 ms
  out alarm : int
  communication {{
    var x : double = 0
  }}
  composition {{
    wait {first} us ;
    mu (
      {branches}
    )
  }}
}}

submodel Source {{
  out y : double
  y = time / 1<s>
}}

environment Bench for Main {{
  source : Source
  source.y -> a
  alarm -> _
}}
"""


@pytest.mark.parametrize(
    ("operator", "is_second", "delay"), list(product(("[]", "[]>"), (False, True), (1500, 2000, 2500, 9000)))
)
def test_a_time_out_never_elapses_if_that_is_stated(operator: str, is_second: bool, delay: int) -> None:
    branches = ["a ? x -> skip", f"after {delay} us -> alarm ! 1"]
    if not is_second:
        branches.reverse()
    elapsed = set()
    reported = set()
    for first in (0, 700, 2000, 3100):
        text = PROGRAM.format(first=first, branches=f" {operator} ".join(branches))
        built = pipeline.build(SourceFile(name="main.csp", text=text), read_source)
        assert built.network is not None
        reported.add(any(found.code == "W0615" for found in built.checked.report.diagnostics))
        files = pipeline.generate(built.network, read_source, level=1, traced=True, observed=True)
        run = execute.simulate(built.network, files, until=100_000_000)
        elapsed.add(any(channel == "Main.alarm" for _, channel, *_ in run.communications))
    assert len(reported) == 1
    if True in reported:
        assert elapsed == {False}
    else:
        assert True in elapsed
