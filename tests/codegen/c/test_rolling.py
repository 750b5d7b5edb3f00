"""Statements and iterations of a `seq` that were unrolled become loops again, also if the process waits in them."""

from __future__ import annotations

from pathlib import Path

import pytest

from cspdiag import pipeline
from cspdiag.base.sources import read_source
from cspdiag.base.span import SourceFile
from cspdiag.codegen.c.text.code import Code, address, call, code, unsigned
from cspdiag.codegen.c.text.rolling import countable, rolled
from cspdiag.codegen.c.text.statements import Plain, lines, run

WORKERS = read_source(str(Path(__file__).parents[3] / "benchmarks" / "networks" / "workers.csp"))


def shown(*groups: list[Plain]) -> list[str]:
    return lines(rolled(groups))


def element(array: str, index: int) -> Code:
    return address(code(array).at(index))


def made(*arguments: Code) -> Plain:
    return run(call("make", *arguments))


def test_subscripts_that_count_become_a_loop() -> None:
    groups = [[made(element("cell", i), element("link", i + 1))] for i in range(4)]
    assert shown(*groups) == [
        "for (uint32_t i = 0U; i < 4U; i++) {",
        "    make(&cell[i], &link[i + 1U]);",
        "}",
    ]


def test_what_closes_the_ring_stays_outside_the_loop() -> None:
    groups = [[made(element("cell", i), element("link", (i + 1) % 5))] for i in range(5)]
    assert shown(*groups)[-1] == "make(&cell[4], &link[0]);"
    assert "i < 4U" in shown(*groups)[0]


def test_arguments_and_steps_other_than_one_count_too() -> None:
    groups = [[made(element("cell", i), countable(10 - i), unsigned(3 * i)), run("next++")] for i in range(3)]
    assert shown(*groups) == [
        "for (uint32_t i = 0U; i < 3U; i++) {",
        "    make(&cell[i], (int64_t)(10U - i), 3U * i);",
        "    next++;",
        "}",
    ]


def test_alternating_groups_make_one_loop() -> None:
    groups = [[made(element(name, i))] for i in range(3) for name in ("left", "right")]
    assert shown(*groups) == [
        "for (uint32_t i = 0U; i < 3U; i++) {",
        "    make(&left[i]);",
        "    make(&right[i]);",
        "}",
    ]


def test_few_or_irregular_statements_are_not_rolled() -> None:
    few = [[made(element("cell", i))] for i in range(2)]
    assert shown(*few) == ["make(&cell[0]);", "make(&cell[1]);"]
    groups = [[made(element("cell", i * i), countable(i))] for i in range(4)]
    assert shown(*groups) == [f"make(&cell[{i * i}], {i});" for i in range(4)]


def test_statements_that_do_not_count_are_not_repeated_by_a_loop() -> None:
    assert shown(*[[run("numbers++")]] * 3) == ["numbers++;"] * 3


@pytest.mark.parametrize("level", [0, 1])
def test_branches_of_a_parallel_that_differ_in_numbers_share_their_code(level: int) -> None:
    lengths = set()
    for size in ("20", "40"):
        network = pipeline.build(WORKERS, read_source, settings={"size": size}).network
        assert network is not None
        files = pipeline.generate(network, read_source, "c", level, observed=True)
        lengths.add(sum(len(text.splitlines()) for path, text in files.items() if path.startswith("pool")))
    assert len(lengths) == 1


SCAN = """
const taps : double[16] = [1, 2, 3, 4, 5, 6, 7, 8, 7, 6, 5, 4, 3, 2, 1, 0.5]

process Scan {
  in  low[16]  : double @ 10 ms
  in  high[16] : double @ 10 ms
  out sum      : double @ 10 ms

  communication {
    var v     : double[16] = [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0]
    var w     : double     = 0
    var total : double     = 0
    var count : int        = 0
  }

  composition {
    mu (BODY ; sum ! total)
  }
}
"""


NARROW = """
process Writer {
  out written : int32
  composition { (seq i < 6 : (written ! int32(800000000 * i - 2000000000) ; wait 1 us)) }
}
"""


def scan(body: str, level: int = 0) -> str:
    """The step function of the process, with the table of places."""
    built = pipeline.build(SourceFile(name="main.csp", text=SCAN.replace("BODY", body)), read_source)
    assert built.network is not None, [found.message for found in built.checked.report.diagnostics]
    return pipeline.generate(built.network, read_source, "c", level)["scan.c"]


@pytest.mark.parametrize("level", [0, 1])
@pytest.mark.parametrize(
    ("body", "waits"),
    [
        ("(seq i < 16 : (low[i] ? v[i]))", 1),
        ("(seq i < 3 : (low[i] ? v[i]))", 1),
        ("(seq i < 16 : (low[i] ? w ; high[i] ? v[i]))", 2),
        ("(seq i < 8 : (low[2 * i + 1] ? v[i + 3]))", 1),
        ("(seq i < 16 : (low[i] ? w ; if w > 1 then high[i] ? w))", 2),
        ("(seq i < 16 : (low[i] ? w)) ; (seq i < 16 : (high[i] ? w))", 2),
        ("(seq i < 2 : (low[i] ? w))", 2),  # too few
        ("(seq i < 4 : (low[3 - i] ? w))", 1),  # elements count down
        ("(seq i < 4 : (low[3 - i] ? v[15 - 2 * i] ; high[i] ? w))", 2),
        ("(seq i < 4 : (low[i] ? w ; total := 1 ; low[i + 1] ? w ; total := 2 ; high[i] ? w ; total := 3))", 3),
        ("low[0] ? w ; low[1] ? w ; low[2] ? w", 3),  # each has its own place in the text
    ],
)
def test_a_process_waits_at_as_many_places_as_its_text_has(body: str, waits: int, level: int) -> None:
    text = scan(body, level)
    assert text.count("CSP_AWAIT(") == text.count(".waiting = CSP_AT_READ") == waits


@pytest.mark.parametrize("level", [0, 1])
def test_a_turn_may_have_many_steps(level: int) -> None:
    steps = [f"low[i] ? w ; total := total + w * {2 + step}" for step in range(40)]
    text = scan(f"(seq i < 4 : ({' ; '.join(steps)})) ; (seq i < 9 : (high[i] ? w))", level)
    assert text.count("CSP_AWAIT(") == 41


def test_the_turn_and_what_the_process_waits_for_outlast_the_wait() -> None:
    text = " ".join(scan("(seq i < 16 : (low[i] ? v[i]))").split())
    assert "for (self->turn = 0U; self->turn < 16U; self->turn++) {" in text
    assert "self->awaited = &self->low[self->turn]; CSP_AWAIT(" in text
    assert ".indirect = true," in text
    assert ".offset = offsetof(struct scan, awaited) }" in text
    assert "self->v.at[self->turn] = self->received.low;" in text


@pytest.mark.parametrize("level", [0, 1])
@pytest.mark.parametrize(
    ("body", "waits"),
    [
        ("(seq i < 3 : (high[i] ? w ; (seq j < 4 : (low[4 * i + j] ? w))))", 2),
        ("(seq i < 4 : (seq j < 4 : (low[4 * i + j] ? w ; high[j] ? v[i])))", 2),
        ("(seq i < 4 : (seq j < 4 : (seq k < 4 : (low[4 * i + j] ? v[4 * j + k] ; high[k] ? w))))", 2),
        ("(seq i < 4 : (high[i] ? w ; if w > 1 then (seq j < 4 : (low[i + j] ? v[j]))))", 2),
        ("(seq i < 3 : (high[i] ? w ; (seq j < 3 : (low[3 * i + j] ? w))))", 2),
        ("(seq i < 3 : (high[i] ? w ; (seq j < 3 : (low[j] ? w ; w := 1 ; high[j] ? w ; w := 2 ; low[i] ? w))))", 4),
        ("(seq i < 4 : (seq j < 4 : (low[15 - 4 * i - j] ? w ; high[3 + i - j] ? w)))", 2),
        ("(seq i < 4 : (mu ((seq j < 4 : (low[i + j] ? v[j])) ; high[i] ? w) until w > 1))", 2),
        ("(seq i < 3 : (seq j < 2 : (low[i] ? w ; high[j] ? w)))", 4),  # too few inside
        ("(seq i < 2 : (seq j < 3 : (low[i] ? w ; high[j] ? w)))", 4),  # too few around
        ("(seq i < 3 : (seq j < 3 : (low[2 * i * i + j] ? w)))", 3),  # elements do not count around
    ],
)
def test_loops_in_loops_wait_at_as_many_places_as_the_text_has(body: str, waits: int, level: int) -> None:
    assert scan(body, level).count("CSP_AWAIT(") == waits


def test_each_loop_in_which_the_process_waits_has_a_turn_of_its_own() -> None:
    text = " ".join(scan("(seq i < 3 : (high[i] ? w ; (seq j < 4 : (low[4 * i + j] ? w))))").split())
    assert "for (self->turn = 0U; self->turn < 3U; self->turn++) {" in text
    assert "for (self->turn_2 = 0U; self->turn_2 < 4U; self->turn_2++) {" in text
    assert "self->awaited = &self->low[4U * self->turn + self->turn_2];" in text


def test_what_counts_down_is_subtracted_last() -> None:
    """Unsigned numbers are never less than 0 on the way."""
    text = " ".join(scan("(seq i < 4 : (seq j < 4 : (low[15 - 4 * i - j] ? w ; high[3 + i - j] ? w)))").split())
    assert "self->awaited = &self->low[15U - 4U * self->turn - self->turn_2];" in text
    assert "self->awaited = &self->high[self->turn + 3U - self->turn_2];" in text


def test_durations_count_in_nanoseconds() -> None:
    text = " ".join(scan("(seq i < 4 : (low[i] ? w ; wait (9 - i) * 5 us))", level=1).split())
    assert "csp_wait(csp, party, &self->delay, 45 * CSP_US - 5 * CSP_US * (int64_t)self->turn)" in text


@pytest.mark.parametrize("level", [0, 1])
def test_numbers_of_narrow_types_count_in_64_bits(level: int) -> None:
    """Products on the way need not fit in the type."""
    source = SourceFile(name="main.csp", text=NARROW)
    network = pipeline.build(source, read_source).network
    assert network is not None
    text = "".join(pipeline.generate(network, read_source, "c", level).values())
    assert "(int32_t)(800000000 * (int64_t)self->turn - 2000000000)" in text


def test_a_loop_without_waits_in_one_with_waits_is_counted_by_a_local_variable() -> None:
    text = " ".join(scan("(seq i < 3 : (high[i] ? w ; (seq j < 4 : total := total + v[j])))").split())
    assert "for (uint32_t i = 0U; i < 4U; i++) {" in text
    assert "self->total + self->v.at[i]" in text


def test_steps_between_waits_are_counted_by_a_local_variable() -> None:
    text = " ".join(scan("low[0] ? w ; high[0] ? w ; (seq i < 16 : total := total + v[i])").split())
    assert "for (uint32_t i = 0U; i < 16U; i++) {" in text
    assert text.count("csp_real(") == 1
    assert "self->turn" not in text


@pytest.mark.parametrize("level", [0, 1])
@pytest.mark.parametrize(
    ("body", "inside"),
    [
        ("(seq i < 16 : total := total + taps[i] * v[i])", "taps.at[i] * self->v.at[i]"),
        ("(seq i < 16 : total := total + (if i == 0 then 0 else v[i - 1]))", "((int64_t)i == 0) ? 0.0 : self->v.at["),
        ("(seq i < 16 : total := total + double(i) * w)", "(double)(int64_t)i * self->w"),
        ("(seq i < 16 : count := count + i)", "csp_add(csp, self->count, (int64_t)i)"),
        ("(seq i < 16 : count := count + i * i % 7)", "(int64_t)i * (int64_t)i % 7"),
        ("(seq i < 4 : (seq j < 4 : count := count + i * j))", "(int64_t)i * (int64_t)i_2"),
    ],
)
def test_constants_in_turns_leave_them_a_loop(body: str, inside: str, level: int) -> None:
    """At -O1 turns have one text, not each the number that it computes with."""
    text = " ".join(scan(f"low[0] ? w ; low[1] ? v[3] ; {body}", level).split())
    assert "for (uint32_t i = 0U; i < " in text
    assert text.count(inside) == 1


def test_conditions_of_steps_are_decided_turn_by_turn() -> None:
    text = scan("(seq i < 16 : (if i < 8 then count := count + 1 else (low[i] ? w)))", level=1)
    assert "if (" not in text.split("case FAILS:")[0].replace("if (csp_", "")


def test_a_table_without_a_name_is_not_written_out_in_each_turn() -> None:
    text = scan("low[0] ? w ; low[1] ? v[1] ; (seq i < 3 : total := total + ([0.5, 0.25, 0.125])[i] * v[i])", level=1)
    assert "0.5 * self->v.at[0]" in text
