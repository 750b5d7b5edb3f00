"""How optimized processes communicate where one task uses each end of a channel, and where several tasks do."""

from __future__ import annotations

from pathlib import Path

import pytest

from cspdiag import pipeline
from cspdiag.base import SourceFile

ENDS = Path(__file__).parents[3] / "conformance" / "programs" / "ends_of_several_tasks.csp"


def no_file(path: str) -> SourceFile:
    raise FileNotFoundError(path)


def generated(text: str) -> dict[str, str]:
    network = pipeline.build(SourceFile(name="top.csp", text=text), no_file).network
    assert network is not None
    return pipeline.generate(network, no_file, level=1, observed=True)


@pytest.fixture(scope="module")
def ends() -> dict[str, str]:
    return generated(ENDS.read_text(encoding="utf-8"))


def test_a_channel_with_an_end_of_several_tasks_notes_who_waits(ends: dict[str, str]) -> None:
    """Both ends do, and those of whatever else is connected to instances of the same class."""
    for channel in ("a", "b"):
        assert f"self.{channel}_output = Rendezvous[int](" in ends["top/top.py"]
    reads = ends["top/changing.py"].partition("def steps")[2]
    assert reads.count("input_.reading = me") == 2
    assert "input_.reader" not in reads
    assert ends["top/counter.py"].count("output.writing = me") == 1


@pytest.mark.parametrize(("process", "notes"), [("ticker", 1), ("printer", 1), ("apart", 3), ("hasty", 3)])
def test_a_task_notes_the_ends_that_belong_to_it_before_its_loop(
    ends: dict[str, str], process: str, notes: int
) -> None:
    code = ends[f"top/{process}.py"].partition("def steps")[2]
    assert "Rendezvous" not in ends[f"top/{process}.py"]
    assert sum(code.count(f".{end} = me") for end in ("reader", "writer")) == notes
    assert all("er = me\n" not in loop.partition("\n\n")[0] for loop in code.split("while True:")[1:])


def test_an_element_of_an_array_of_ports_is_noted_where_it_waits() -> None:
    files = generated("""
process Source { out o[2] : int  composition { mu (o[0] ! 1 ; o[1] ! 2) } }
process Sink { in i : int  communication { var x : int }  composition { mu i ? x } }
process Top {
  communication { source : Source  sinks[k < 2] : Sink  for k < 2 { source.o[k] -> sinks[k].i } }
  composition { source || (par k < 2 : sinks[k]) }
}
""")
    before, _, loop = files["top/source.py"].partition("while True:")
    assert "writer = me" not in before
    assert loop.count("channel.writer = me\n") == loop.count("channel.offered = ") == 2
