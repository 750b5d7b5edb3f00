"""What optimized processes know of arrays and of the ready queue."""

from __future__ import annotations

import pytest

from cspdiag import pipeline
from cspdiag.base import SourceFile
from cspdiag.simulate.run.package import LoadedPackage

RING = """
process Cell {
  in  input  : int
  out output : int
  communication { var value : int }
  composition { mu (input ? value ; output ! value) }
}
process Top {
  communication {
    cell[12] : Cell
    for i < 12 { cell[i].output -> cell[(i + 1) % 12].input }
  }
  composition { par i < 12 : cell[i] }
}
"""

PAIR = """
process Writer { out o : int  composition { mu (o ! 1 ; wait 1 ms) } }
process Reader { in i : int  communication { var x : int } composition { mu i ? x } }
process Top {
  communication { writer : Writer  reader : Reader  writer.o -> reader.i }
  composition { writer %s reader }
}
"""


def no_file(path: str) -> SourceFile:
    raise FileNotFoundError(path)


def generated(text: str, level: int = 1, *, traced: bool = False) -> dict[str, str]:
    network = pipeline.build(SourceFile(name="top.csp", text=text), no_file).network
    assert network is not None
    # Code that is observed is not fused.
    return pipeline.generate(network, no_file, level=level, traced=traced, observed=True)


@pytest.mark.parametrize("traced", [False, True])
def test_a_deadlock_in_an_array_is_reported_with_the_names_of_its_elements(traced: bool) -> None:
    reports = []
    for level in (0, 1):
        package = LoadedPackage("top", generated(RING, level, traced=traced))
        outcome = package.module("network").build({}).run()
        assert outcome.ended == "deadlock"
        reports.append([(each.path, each.channels) for each in outcome.deadlock.cycle])
    assert reports[0] == reports[1]
    assert ("Top.cell[11]", ("Top.cell[10].output",)) in reports[1]


def test_elements_share_their_names_unless_each_communication_reports_them() -> None:
    assert "self.cell_output = numbered(" in generated(RING)["top/top.py"]
    assert "numbered(" not in generated(RING, traced=True)["top/top.py"]


@pytest.mark.parametrize(
    ("operator", "readied"), [("||", "queue.append(o.reader.entry)"), ("||>", "ready_queue.append(")]
)
def test_generators_are_readied_directly_unless_there_are_levels_of_priority(operator: str, readied: str) -> None:
    files = generated(PAIR % operator)
    assert readied in files["top/writer.py"]
    assert ("tracked = True" in files["top/top.py"]) == (operator == "||>")
