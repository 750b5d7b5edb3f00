"""Every instance costs the same, however many there are, as an element of an array and as a line of its own: lines of
Python are counted, not time.
"""

from __future__ import annotations

import gc
import importlib
import re
import tracemalloc
from collections.abc import Callable
from itertools import product
from pathlib import Path
from types import CodeType

import pytest

from cspdiag import pipeline
from cspdiag.base.sources import read_source
from cspdiag.base.span import SourceFile
from cspdiag.cli.main import main
from cspdiag.network.ir.network import CoreNetwork
from cspdiag.proofs.portfolio import prove_deadlock_free, prove_knot_free
from cspdiag.proofs.properties.cycles import endless_run
from cspdiag.proofs.transitions import transition_system
from cspdiag.proofs.verdict import Limits
from cspdiag.simulate.record.modes import mode_groups
from tests.support.counting import calls, lines
from tests.support.thorough import in_turn
from tests.support.verifying import answers_to

NETWORKS = Path(__file__).parents[1] / "benchmarks" / "networks"
FEW = 24
MOST_GROWTH = 2.4
"""The maximum ratio of the lines that another ``2 * FEW`` elements take to those of another ``FEW``: 2 if each takes
the same, 4 if the cost of each grows with their number.
"""


@pytest.fixture(autouse=True)
def benchmarks(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(NETWORKS.parent / "programs"))


def program(name: str, count: int, form: str = "array", *, ends: bool = False) -> SourceFile:
    """A network of ``benchmarks/networks/``, as an "array" or as "lines" for each instance and relationship."""
    return SourceFile(name="main.csp", text=importlib.import_module("scale").source(name, form, count, ends=ends))


def network(name: str, count: int, form: str = "array") -> CoreNetwork:
    return network_of(program(name, count, form))


def network_of(source: SourceFile, *, for_code: bool = False) -> CoreNetwork:
    built = pipeline.build(source, read_source, for_code=for_code)
    assert built.network is not None
    return built.network


def growth(done: Callable[[int], Callable[[], object]]) -> float:
    """The ratio of growth; ``done`` prepares what is counted for a number of elements."""
    done(4 * FEW)()  # what is imported or computed once, or until records are made often
    first, second, third = (lines(done(count)) for count in (FEW, 2 * FEW, 4 * FEW))
    return (third - second) / (second - first)


@pytest.mark.parametrize("form", ["array", "lines"])
@pytest.mark.parametrize("name", ["ring", "star"])
def test_checks_take_the_same_for_each_element(name: str, form: str) -> None:
    assert growth(lambda count: lambda: pipeline.check(program(name, count, form), read_source)) < MOST_GROWTH


@pytest.mark.parametrize(
    ("network_and_target", "way"),
    in_turn(product(("ring", "workers", "star"), ("python", "c")), tuple(product((0, 1), ("array", "lines")))),
)
def test_generators_take_the_same_for_each_element(network_and_target: tuple[str, str], way: tuple[int, str]) -> None:
    (name, target), (level, form) = network_and_target, way

    def generating(count: int) -> Callable[[], object]:
        made = network(name, count, form)
        return lambda: pipeline.generate(made, read_source, target, level)

    assert growth(generating) < MOST_GROWTH


@pytest.mark.parametrize(
    ("name", "target", "most", "most_element_by_element"),
    [
        ("ring", "python", 100, 810),
        ("ring", "c", 40, 840),
        ("pipeline", "python", 45, 1_010),
        ("pipeline", "c", 15, 1_070),
        ("workers", "python", 340, 2_080),
        ("workers", "c", 25, 2_190),
        ("star", "python", 1_460, 4_550),
    ],
)
def test_an_element_takes_few_calls_from_the_text_to_the_code(
    name: str, target: str, most: int, most_element_by_element: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An element of a ring is an instance with a channel, of workers two with two, of a star one with two and a branch
    of an alternative.
    """
    monkeypatch.setattr(pipeline, "LEAST_TO_CONTINUE", 0)
    few, many = 220, 268  # too many to be fused; the smaller networks that these follow from have the same size

    def each(*, for_code: bool) -> float:
        def compiling(count: int) -> Callable[[], object]:
            source = program(name, count)
            return lambda: pipeline.generate(network_of(source, for_code=for_code), read_source, target, 1)

        for _ in range(3):  # what is imported or computed once, or until records are made often
            compiling(many)()
        return (calls(compiling(many)) - calls(compiling(few))) / (many - few)

    assert each(for_code=True) < most
    assert each(for_code=False) < most_element_by_element


def test_a_checked_line_takes_few_bytes() -> None:
    """For each cell of a ring: the lines of its instance, its relationship and its place in the composition."""

    def memory(count: int) -> int:
        source = program("ring", count, "lines")
        gc.collect()
        tracemalloc.start()
        try:
            checked = pipeline.check(source, read_source, for_findings=True)
            assert not checked.report.diagnostics
            return tracemalloc.get_traced_memory()[0]
        finally:
            tracemalloc.stop()

    memory(200)
    assert (memory(1200) - memory(200)) / 1000 < 3_900


def test_no_variable_is_shared_with_nested_functions_for_each_line() -> None:
    """Python takes ``n`` squared steps to compile a function of which others use ``n`` variables."""
    shared = []
    for count in (200, 300):  # too many to be fused
        text = re.sub(r"(cell\d+)", r"\1_", program("ring", count, "lines").text)
        built = pipeline.build(SourceFile(name="ring.csp", text=text), read_source)
        assert built.network is not None
        files = pipeline.generate(built.network, read_source, "python", 1)
        pending = [compile(files["ring/ring.py"], "ring.py", "exec", dont_inherit=True)]
        functions = []
        while pending:
            functions.append(pending.pop())
            pending += [constant for constant in functions[-1].co_consts if isinstance(constant, CodeType)]
        shared.append(max(len(function.co_cellvars) for function in functions))
    assert 0 < shared[0] == shared[1]


@pytest.mark.parametrize("level", [0, 1])
@pytest.mark.parametrize(("target", "path"), [("python", "main/ring.py"), ("c", "ring.c")])
def test_the_text_of_numbered_lines_does_not_grow_with_their_number(target: str, path: str, level: int) -> None:
    few, many = (
        pipeline.generate(network("ring", count, "lines"), read_source, target, level)[path] for count in (200, 900)
    )
    assert len(few.splitlines()) == len(many.splitlines())


@pytest.mark.parametrize("level", [0, 1])
@pytest.mark.parametrize("name", ["ring", "pipeline", "workers", "star"])
def test_the_python_of_an_array_does_not_grow_with_its_elements(name: str, level: int) -> None:
    few, many = (
        pipeline.generate(network(name, count), read_source, "python", level) for count in (200, 900)
    )  # too many to be fused
    assert few.keys() == many.keys()
    for path, text in few.items():
        assert len(text.splitlines()) == len(many[path].splitlines()), path


def test_the_groups_of_a_summary_take_the_same_for_each_element() -> None:
    def grouping(count: int) -> Callable[[], object]:
        made = network("star", count)
        return lambda: mode_groups(made)

    assert growth(grouping) < MOST_GROWTH


def test_outputs_are_followed_only_where_a_variable_depends_on_them() -> None:
    """Following all of them takes a bit for each output at each instruction."""
    analysis = pipeline.check(program("star", FEW), read_source).analysis
    assert analysis is not None
    assert {"Server", "Client"} <= {shape.name for shape in analysis.flows}
    assert not any("_written" in vars(flow) for flow in analysis.flows.values())


def test_a_search_of_a_ring_takes_the_same_for_each_cell() -> None:
    def searching(count: int) -> Callable[[], object]:
        system = transition_system(network("ring", count))
        events = range(len(system.events))

        def search() -> None:
            prove_deadlock_free(system, Limits(), ["stubborn"])
            prove_knot_free(system, Limits(), ["stubborn"])
            endless_run(system, events, Limits())

        return search

    assert growth(searching) < MOST_GROWTH


def test_what_a_proof_leaves_open_is_listed_in_a_few_lines() -> None:
    *_, livelock = answers_to({"case.csp": program("ring", 20).text})
    assert (livelock.question.text, livelock.outcome) == ("Ring livelock free", "unknown")
    assert len({abstraction.what for abstraction in livelock.abstractions}) > 20
    assert livelock.reason.count("only ranges are distinguished") < 10
    assert "; and 15 more)" in livelock.reason


@pytest.mark.parametrize("level", ["-O0", "-O1"])
@pytest.mark.parametrize("name", ["ring", "pipeline", "workers", "star"])
def test_lines_and_an_array_have_the_same_trace(
    name: str, level: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    traces: list[str] = []
    for form in ("lines", "array"):
        written, trace = tmp_path / f"{form}.csp", tmp_path / f"{form}.jsonl"
        written.write_text(program(name, 12, form, ends=True).text, encoding="utf-8")
        status = main(["run", level, str(written), "--trace", str(trace)])
        assert (status, "error" in capsys.readouterr().err) in ((0, False), (1, False))
        traces.append(re.sub(r"(\w)\[(\d+)\]", r"\1\2", trace.read_text(encoding="utf-8")))
    assert traces[0] == traces[1] != ""
