"""The kit finds what differs, and reports it in a way that helps."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from pathlib import Path

import pytest

from cspdiag.base import SourceFile
from cspdiag.network.ir.network import Network
from cspdiag.semantics.trace import Communication, Ending, Execution
from tests.conformance.__main__ import main
from tests.conformance.kit import certify, judge, tolerance
from tests.conformance.sources import network_of
from tests.conformance.targets import READABLE, REFERENCE, TARGETS, GeneratedPython, Meaning, target_named
from tests.conformance.traces import compare, units_apart

PAIR = """process Source {
  out x : double
  communication { var n : double = 0.5 }
  composition { mu (x ! n * 1.1 ; n := n + 1 ; wait 1 ms) until n > 5 }
}

process Sink {
  in x : double
  communication { var v : double = 0 }
  composition { mu (x ? v) until v > 4.9 }
}

process Top {
  communication {
    source : Source
    sink   : Sink
    source.x -> x : double -> sink.x
  }
  composition { source || sink }
}
"""


@dataclasses.dataclass(frozen=True)
class Changed(GeneratedPython):
    """The readable code with one change in its behaviour."""

    level: int = 0

    change: Callable[[Execution], Execution] = lambda execution: execution

    def run(self, network: Network, environment: str | None, until: int) -> Execution:
        return self.change(READABLE.run(network, environment, until))


def verdict_on(change: Callable[[Execution], Execution], **fields: bool) -> str:
    """The report of the kit for a target with this change."""
    network = network_of(SourceFile(name="pair.csp", text=PAIR))
    verdict = judge(Changed(change=change, **fields), network, None, 100_000_001)
    assert (verdict.result == "equal") == (verdict.details == "")
    return verdict.details


def with_value(position: int, value: float) -> Callable[[Execution], Execution]:
    def change(execution: Execution) -> Execution:
        trace = list(execution.trace)
        trace[position] = trace[position]._replace(value=value)
        return execution._replace(trace=trace)

    return change


def test_the_same_is_equal() -> None:
    assert verdict_on(lambda execution: execution) == ""


def test_a_difference_shows_both_sides_and_the_waiting_processes() -> None:
    details = verdict_on(with_value(2, 2.5))
    assert "Top.x: communication 2 differs" in details
    assert "> 2: 2.000000 ms Top.x 2.75  (Top.source to Top.sink)" in details
    assert "> 2: 2.000000 ms Top.x 2.5  (Top.source to Top.sink)" in details
    assert "Top.source communicates through Top.x" in details
    assert "Top.source waits to write Top.x" in details


def test_a_difference_in_the_last_bit_is_a_difference() -> None:
    assert "differs" in verdict_on(with_value(1, math.nextafter(1.5 * 1.1, 2)))


def test_missing_communication() -> None:
    details = verdict_on(lambda execution: execution._replace(trace=execution.trace[:-1]))
    assert "> end" in details


def test_other_ending() -> None:
    details = verdict_on(lambda execution: execution._replace(ending=Ending("failed", 7, "Fault", "Fault: no")))
    assert "reference: terminated at 5.000000 ms" in details
    assert "python-O0: failed at 0.000007 ms with Fault: Fault: no" in details


def test_reports_of_deadlocks_are_compared() -> None:
    stuck = "process P { in c : int communication { var v : int } composition { c ? v } }\n"
    stuck += "process Top { communication { p : P channel c : int c -> p.c } composition { (c ! 1 ; c ! 2) || p } }\n"
    network = network_of(SourceFile(name="stuck.csp", text=stuck))
    ending = REFERENCE.run(network, None, 10_000_000).ending
    assert ending.message is not None
    assert (
        "Top waits to write Top.c (stuck.csp:2); no other process that still runs can take the value" in ending.message
    )
    assert TARGETS["python-O1"].run(network, None, 10_000_000).ending.agrees_with(ending)
    assert not ending._replace(message="deadlock at 0 s").agrees_with(ending)


def test_other_safe_values() -> None:
    assert "safe values differ" in verdict_on(lambda execution: execution._replace(released=[("x", 1)]))


def test_units_in_the_last_place() -> None:
    assert units_apart(0.0, -0.0) == 0
    assert units_apart(1.0, math.nextafter(1.0, 2.0)) == 1
    assert units_apart(-5e-324, 5e-324) == 2
    assert units_apart(math.nan, 1.0) > 1
    near = [Communication(0, "Top.x", (1.0, 2))], [Communication(0, "Top.x", (math.nextafter(1.0, 2.0), 2))]
    assert compare(*near) is not None
    assert compare(*near, units=1) is None


def test_other_library_may_differ_only_in_its_functions() -> None:
    other = Meaning(other_library=True)
    sine = PAIR.replace("n * 1.1", "sin(n)")
    assert tolerance(other, network_of(SourceFile(name="pair.csp", text=PAIR))) == 0
    assert tolerance(other, network_of(SourceFile(name="pair.csp", text=sine))) == 1
    assert tolerance(REFERENCE, network_of(SourceFile(name="pair.csp", text=sine))) == 0


def test_certify_checks_every_program_of_a_folder(tmp_path: Path) -> None:
    (tmp_path / "inner").mkdir()
    (tmp_path / "inner" / "pair.csp").write_text(PAIR, encoding="utf-8")
    (verdict,) = certify(target_named("python-O0"), tmp_path, 100_000_000)
    assert (verdict.result, verdict.communications) == ("equal", 5)
    assert verdict.program == (tmp_path / "inner" / "pair.csp").as_posix()


def test_command_prints_a_table(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "pair.csp").write_text(PAIR, encoding="utf-8")
    assert main(["python-O0", str(tmp_path)]) == 0
    assert capsys.readouterr().out == f"equal           5 {tmp_path.as_posix()}/pair.csp\n"


def test_hand_written_bodies_behave_as_in_readable_code(tmp_path: Path) -> None:
    (tmp_path / "counter.py").write_text(
        """from cspdiag.runtime import Process


class Counter(Process):
    def __init__(self, name, n):
        super().__init__(name)
        self.n = n

    async def run(self):
        await self.n.write(7)
""",
        encoding="utf-8",
    )
    path = tmp_path / "counter.csp"
    path.write_text(
        f"""process Counter python "{tmp_path}/counter.py:Counter" {{ out n : int }}
process Top {{
  communication {{ counter : Counter  channel n : int  var got : int = 0  counter.n -> n }}
  composition {{ counter || n ? got }}
}}
""",
        encoding="utf-8",
    )
    network = network_of(SourceFile(name=path.as_posix(), text=path.read_text(encoding="utf-8")))
    done = REFERENCE.run(network, None, 1_000_001)
    assert [value for _, _, value, _, _ in done.trace] == [7]
    assert done == READABLE.run(network, None, 1_000_001)


def test_words_of_failures_are_compared_with_those_of_the_meaning() -> None:
    text = PAIR.replace("n := n + 1", "n := n / (n - 0.5)")
    network = network_of(SourceFile(name="pair.csp", text=text))
    done = REFERENCE.run(network, None, 1_000_001)
    assert done.ending.message == "Fault: division by zero, in Top.source (pair.csp:4)"
    changed = done.ending._replace(message="Fault: division by nought, in Top.source (pair.csp:4)")
    verdict = judge(Changed(change=lambda execution: execution._replace(ending=changed)), network, None, 1_000_001)
    assert "the end differs" in verdict.details
