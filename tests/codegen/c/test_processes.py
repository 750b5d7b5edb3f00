"""Process classes in C: they behave as at -O0, and neither sanitizers nor compilers object."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest

from cspdiag import pipeline
from cspdiag.base.sources import read_source
from cspdiag.base.span import SourceFile
from cspdiag.network.ir.network import CoreNetwork
from cspdiag.simulate.native import run as native
from cspdiag.simulate.run import execute
from tests.support.compiling import compile_once

ROOT = Path(__file__).parents[3]
OWN = Path(__file__).parent / "programs"
PROGRAMS = ROOT / "tests" / "conformance" / "programs"
LIMIT = 60_000_001
STRICT = ("-O0", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror")

NEEDS_COMPILER = pytest.mark.skipif(
    not any(shutil.which(name) for name in ("cc", "gcc", "clang")), reason="there is no C compiler"
)


def network_of(path: Path) -> CoreNetwork:
    built = pipeline.build(read_source(str(path)), read_source)
    assert built.network is not None, [found.message for found in built.checked.report.diagnostics]
    return built.network


@NEEDS_COMPILER
@pytest.mark.parametrize("level", [0, 1])
@pytest.mark.parametrize("name", ["endless_part", "guarded", "names", "priorities", "raising"])
def test_a_program_gives_the_trace_of_the_reference(name: str, level: int) -> None:
    network = network_of(OWN / f"{name}.csp")
    expected = execute.simulate(network, pipeline.generate(network, read_source), until=LIMIT)
    run = native.simulate(network, read_source, level=level, until=LIMIT, options=STRICT)
    assert run.communications == expected.communications
    assert (run.outcome.ended, run.outcome.time) == (expected.outcome.ended, expected.outcome.time)


@pytest.mark.skipif(shutil.which("gcc") is None, reason="there is no gcc")
@pytest.mark.parametrize(
    ("name", "level"),
    [
        ("modes_with_arrays_buffers_and_faults", 0),
        ("alternative_takes_interrupt_guard", 1),
        ("branches_of_one_class", 0),
    ],
)
def test_sanitizers_find_nothing(name: str, level: int, tmp_path: Path) -> None:
    network = network_of(PROGRAMS / f"{name}.csp")
    files = pipeline.generate(network, read_source, "c", level)
    for path, text in files.items():
        target = tmp_path / path
        target.parent.mkdir(exist_ok=True)
        target.write_text(text, encoding="utf-8")
    ports = {path for path in files if path.startswith("support/csp_port_") and "simulation" not in path}
    sources = sorted(path for path in files if path.endswith(".c") and path not in ports)
    flags = ["-std=c99", "-g", "-O0", "-ffp-contract=off", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"]
    made = ["gcc", *flags, "-I.", "-Isupport", "-DCSP_TRACE=1", *sources, "-lm", "-o", "simulation"]
    compile_once(*made, cwd=tmp_path)
    done = subprocess.run(["./simulation", "--for", str(LIMIT), "--observe", "all"], cwd=tmp_path, capture_output=True)
    assert b"ERROR" not in done.stderr
    assert b"runtime error" not in done.stderr
    assert done.returncode in (0, 1)


def test_a_ring_of_many_cells_is_built_by_loops() -> None:
    text = read_source(str(ROOT / "models" / "ring" / "ring.csp"))
    built = pipeline.build(text, read_source, settings={"cells": "500"})
    assert built.network is not None
    ring = pipeline.generate(built.network, read_source, "c")["ring.c"]
    assert "for (uint32_t i = 1U; i < 499U; i++) {" in ring
    assert "self->cell_output[i - 1U]" in ring
    assert len(ring.splitlines()) < 150


@pytest.mark.parametrize("level", [0, 1])
def test_only_channels_that_are_shared_or_guarded_by_their_writer_keep_queues(level: int) -> None:
    path = OWN / "guarded.csp"
    package = pipeline.generate(network_of(path), read_source, "c", level)
    program, reader = package["guarded.c"], package["collects.c"]
    assert [program.count(f"csp_{kind}_init(") for kind in ("guarded", "any")] == [3, 1]
    assert "csp_select_inputs(csp, party, &self->choice.alternative, 3U)" in reader
    offers = "(output ! true -> skip [] after 9 ms -> skip) ;"
    writing = path.read_text(encoding="utf-8").replace("output ! true ;", offers)
    both = text_of(writing, level)["guarded.c"]
    assert [both.count(f"csp_{kind}_init(") for kind in ("guarded", "any")] == [2, 2]


def text_of(program: str, level: int = 0) -> dict[str, str]:
    built = pipeline.build(SourceFile(name="main.csp", text=program), read_source)
    assert built.network is not None, [found.message for found in built.checked.report.diagnostics]
    return pipeline.generate(built.network, read_source, "c", level)


POOL = """
process Asker(size: int) {
  out ask[size] : int
  out free      : int
  composition { BODY }
}
process Main {
  communication {
    asker : Asker(size = 5)
    asker.free -> _
    for i < 5 { asker.ask[i] -> _ }
  }
  composition { asker }
}
"""


@pytest.mark.parametrize("size", [3, 40, 400])
def test_branches_of_a_parallel_share_a_step_function_however_many_they_are(size: int) -> None:
    program = (ROOT / "benchmarks" / "networks" / "workers.csp").read_text(encoding="utf-8")
    pool = text_of(program.replace("const size = 10", f"const size = {size}"))["pool.c"]
    assert pool.count("_step(csp_kernel *csp, csp_party *party)") == 2  # the process and its branches
    assert f"i < {size}U" in pool
    assert pool.count("\n") < 170


@pytest.mark.parametrize(
    ("branch", "functions"),
    [
        ("wait i * 1 ms ; ask[i] ! i", 1),
        ("ask[i] ! 7 - 2 ; ask[4 - i] ! 3", 5),  # the second element counts down
        ("wait 1 ms ; ask[i] ! (i * i) % 5", 1),  # computed from the number
        ("wait 1 ms ; ask[(2 * i) % 5] ! i", 3),  # the elements 0, 2 and 4 count
        ("wait 1 ms ; (if i < 2 then ask[i] ! 1 else ask[i] ! 2 * i)", 3),  # the last three count
        ("begun: (wait 1 ms ; ask[i] ! i)", 5),  # each group has an index among the groups of the process
    ],
)
def test_branches_share_a_step_function_where_they_differ_in_even_steps(branch: str, functions: int) -> None:
    texts = text_of(POOL.replace("BODY", f"par i < 5 : ({branch})"))
    assert texts["asker.c"].count("_step(csp_kernel *csp, csp_party *party)") == 1 + functions


@pytest.mark.parametrize("level", [0, 1])
def test_branches_that_differ_in_their_number_share_code(level: int) -> None:
    network = network_of(PROGRAMS / "branches_of_one_body.csp")
    server = pipeline.generate(network, read_source, "c", level)["server.c"]
    assert server.count("= self->reply[self->choice_2.alternative.chosen];") == 1
    assert server.count("csp_guard_read(") == 2


def test_numbers_of_branches_are_computed_with() -> None:
    network = network_of(PROGRAMS / "branches_of_one_body.csp")
    server = pipeline.generate(network, read_source, "c", 0)["server.c"]
    assert server.count("self->question % 1000 + (int64_t)self->choice.alternative.chosen;") == 1


def test_branches_in_sequence_share_code_beside_others() -> None:
    network = network_of(PROGRAMS / "branches_in_runs.csp")
    server = pipeline.generate(network, read_source, "c", 1)["server.c"]
    assert "self->question % 999 + (int64_t)self->choice_2.alternative.chosen;" in server  # i + 3 of guard i + 3
    assert "self->reply[2U - self->choice_2.alternative.chosen]" in server
    assert server.count("CSP_AWAIT(csp_channel_write(") == 5


BRANCHES = """
process Serves {
  in  low[4]  : int
  in  high[4] : int
  out up[8]   : int
  out lamp    : int

  communication {
    var v : int    = 0
    var w : int[4] = [0, 0, 0, 0]
  }

  composition { BODY }
}

process Main {
  in  low[4]  : int
  in  high[4] : int
  out up[8]   : int
  out lamp    : int

  communication {
    serves : Serves

    low         -> serves.low
    high        -> serves.high
    serves.up   -> up
    serves.lamp -> lamp
  }

  composition { serves }
}
"""


@pytest.mark.parametrize(
    ("body", "selections"),
    [
        ("alt i < 3 : (low[i] ? v -> lamp ! v + i)", []),
        ("alt i < 4 : (low[i] ? w[i] -> lamp ! w[3 - i])", []),
        ("alt i < 4 : (when v != i & low[i] ? v -> (mu (wait i * 1 ms ; v := v + 1) until v > i))", []),
        ("(prialt i < 4 : (low[i] ? v -> up[i] ! i)) []> (prialt i < 4 : (high[i] ? v -> up[i + 4] ! i))", ["< 4U"]),
        ("(alt i < 4 : (low[i] ? v -> (wait 1 ms ; up[i] ! v))) [] (after 1 ms -> lamp ! 0)", ["< 4U"]),
        ("alt i < 2 : (low[i] ? v -> lamp ! v + i)", ["== 0U"]),
        ("alt i < 3 : (low[i] ? v -> (alt j < 3 : (high[j] ? v -> lamp ! v + j)))", ["== 0U", "== 1U"]),
    ],
)
def test_branches_that_differ_in_numbers_that_count_are_one(body: str, selections: list[str]) -> None:
    serves = text_of(BRANCHES.replace("BODY", f"mu ({body})"))["serves.c"]
    assert re.findall(r"if \(self->\w+\.alternative\.chosen (.*)\) \{", serves) == selections
    assert "switch (self->" not in serves


def test_a_zero_is_not_added() -> None:
    serves = text_of(BRANCHES.replace("BODY", "mu (alt i < 2 : (low[i] ? v -> (lamp ! v + i ; up[i] ! v - i)))"))[
        "serves.c"
    ]
    assert "self->sent.lamp = self->v;" in serves
    assert not re.search(r"[+-] 0\b", serves)


def test_ports_that_count_are_attached_in_loops() -> None:
    network = network_of(PROGRAMS / "branches_of_one_body.csp")
    star = pipeline.generate(network, read_source, "c")["star.c"]
    assert "ports_of_server.request[i] = &self->client_request[i];" in star
    assert ".request[1] =" not in star


@pytest.mark.parametrize("level", [0, 1])
def test_no_function_that_initializes_a_process_is_long(level: int) -> None:
    network = network_of(PROGRAMS / "many_lines_of_instances.csp")
    line = pipeline.generate(network, read_source, "c", level)["line.c"]
    parts = line.split("line_initialize")[1:]
    assert len(parts) > 3
    assert max(part.count(";") for part in parts) < 250


def test_a_long_law_is_one_function_wherever_it_runs() -> None:
    network = network_of(PROGRAMS / "faults_within_long_laws.csp")
    main = pipeline.generate(network, read_source, "c", 1)["main_.c"]
    assert main.count("static void main__law_calculate(csp_kernel *csp, struct main_ *self)") == 1
    assert main.count("  main__law_calculate(csp, self);") == 3
    assert "    const int8_t error = " in main  # its variables have the names in the text


def test_iterations_of_a_fused_loop_are_counted_without_overflow_checks() -> None:
    network = network_of(ROOT / "models" / "cascade" / "cascade.csp")
    cascade = pipeline.generate(network, read_source, "c", 1)["cascade.c"]
    assert "self->turn = self->turn + 1;" in cascade
