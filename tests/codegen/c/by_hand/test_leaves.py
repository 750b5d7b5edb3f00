"""Processes written by hand in C behave like the same processes in the language."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from cspdiag import pipeline
from cspdiag.base import SourceFile
from cspdiag.base.sources import read_source
from cspdiag.codegen.shared.target_error import TargetError
from cspdiag.network.ir.network import CoreNetwork
from cspdiag.simulate.native import run as native
from cspdiag.simulate.result import Run
from cspdiag.simulate.run import execute

MS = 1_000_000
NEEDS_COMPILER = pytest.mark.skipif(
    not any(shutil.which(name) for name in ("cc", "gcc", "clang")), reason="there is no C compiler"
)

SCALE = """process Scale(gain: int) {
  in  input  : int
  in  offset : int = 7
  out output : int
  communication { var value : int = 0  var other : int = 0 }
  composition { mu (input ? value ; offset ? other ; output ! gain * value + other) }
}
"""

HEADER = """\
#ifndef SCALE_H
#define SCALE_H
#include "scale_ports.h"

struct scale {
    csp_process process;
    csp_ends ends;
    csp_in input, offset;
    csp_out output;
    int64_t gain, value, other;
};

#endif
"""

SOURCE = """\
#include "scale.h"

enum { READS_INPUT = 1, READS_OFFSET, WRITES_OUTPUT, FAILS };

static csp_party *scale_step(csp_kernel *csp, csp_party *party)
{
    struct scale *const self = (struct scale *)(void *)party;
    csp_progress progress;

    switch (party->state) {
    case 0:
        csp_observe_begin(csp, party->number);
        for (;;) {
            CSP_READ(self->input, self->value, READS_INPUT, fails)
            CSP_READ(self->offset, self->other, READS_OFFSET, fails)
            self->value = self->gain * self->value + self->other;
            CSP_WRITE(self->output, self->value, WRITES_OUTPUT, fails)
        }
    case FAILS:
    fails:
        csp_unwind(csp, party);
        csp_ends_close(&self->ends);
        csp_observe_end(csp, party->number);
        return csp_fail(csp, party);
    default:
        return NULL;
    }
}

static const csp_place scale_places[] = {
    [0] = {.waiting = CSP_AT_NOTHING, .where = "scale.c"},
    [READS_INPUT] = CSP_PLACE_READ(struct scale, input, FAILS, "scale.c"),
    [READS_OFFSET] = CSP_PLACE_READ(struct scale, offset, FAILS, "scale.c"),
    [WRITES_OUTPUT] = CSP_PLACE_WRITE(struct scale, output, FAILS, "scale.c"),
    [FAILS] = {.waiting = CSP_AT_NOTHING, .failed = FAILS, .where = "scale.c"},
};

static const csp_class scale_class = {
    .step = scale_step, .places = scale_places, .name = "Scale", .where = "scale.c", .offset = 0};

void scale_initialize(struct scale *self, csp_numbers *numbers, const struct scale_ports *ports, int64_t gain)
{
    csp_process_init(&self->process, &scale_class, numbers->process++);
    csp_in_init(&self->input, ports->input, &self->ends);
    csp_in_init(&self->offset, ports->offset, &self->ends);
    csp_out_init(&self->output, ports->output);
    self->gain = gain;
}
"""

PROGRAM = """
process Source {
  out value : int
  communication { var n : int = 0 }
  composition { mu (value ! n ; n := n + 1 ; wait 3 ms) until n == 9 }
}

process Sink {
  in value : int
  communication { var got : int }
  composition { mu (value ? got) }
}

process Top {
  in  level   : int @ 2 ms
  in  pressed : int
  out shown   : int
  out kept    : int @ 5 ms
  communication {
    source   : Source
    plain    : Scale(gain = 3)
    buffered : Scale(gain = -1)
    first    : Scale(gain = 10)
    second   : Scale(gain = 1)
    sampled  : Scale(gain = 2)
    pressing : Scale(gain = 5)
    sink     : Sink
    last     : Sink

    source.value    -> broadcast -> plain.input, buffered.input
    plain.output    -> a : int -> first.input
    first.output    -> shown
    buffered.output -> b : int buffer 2 -> second.input
    level           -> sampled.input
    sampled.output  -> kept
    second.output   -> c : int any -> sink.value
    pressed         -> pressing.input
    pressing.output -> d : int overwrite 2 -> last.value
  }
  composition {
    (source || plain || first || (buffered || second || sink interrupt after 40 ms -> skip)
    || (sampled interrupt after 21 ms -> skip) || (pressing || last)) interrupt after 80 ms -> skip
  }
}

submodel World {
  in  shown, kept    : int
  out level, pressed : int
  state n : int = 0
  next n = n + 1
  level   = n * n
  pressed = n / 6
}

environment Bench for Top step 1 ms {
  world : World
  shown         -> world.shown
  kept          -> world.kept
  world.level   -> level
  world.pressed -> pressed
}
"""


def network_of(text: str, folder: Path) -> CoreNetwork:
    built = pipeline.build(SourceFile(name=str(folder / "case.csp"), text=text), read_source)
    assert built.network is not None, [found.message for found in built.checked.report.diagnostics]
    return built.network


def communications_of(run: Run) -> list[tuple[int, str, object]]:
    return [(time, channel, value) for time, channel, value, _, _ in run.communications]


@NEEDS_COMPILER
@pytest.mark.parametrize("level", [0, 1])
def test_a_process_by_hand_communicates_through_all_kinds_of_ends(level: int, tmp_path: Path) -> None:
    (tmp_path / "scale.c").write_text(SOURCE)
    (tmp_path / "scale.h").write_text(HEADER)
    in_the_language = network_of(SCALE + PROGRAM, tmp_path)
    ports = SCALE[: SCALE.index("  communication")].replace("{", 'c "scale.c" {', 1) + "}\n"
    by_hand = network_of(ports + PROGRAM, tmp_path)

    expected = execute.simulate(in_the_language, pipeline.generate(in_the_language, read_source), until=100 * MS)
    run = native.simulate(by_hand, read_source, level=level, until=100 * MS, options=("-O0",))
    assert len(expected.communications) > 50
    assert communications_of(run) == communications_of(expected)
    assert (run.outcome.ended, run.outcome.time) == (expected.outcome.ended, expected.outcome.time)


def saved_network(folder: Path, header: str) -> CoreNetwork:
    (folder / "scale.c").write_text(SOURCE)
    (folder / "scale.h").write_text(header)
    ports = SCALE[: SCALE.index("  communication")].replace("{", 'c "scale.c" {', 1) + "}\n"
    return network_of(ports + PROGRAM, folder)


COMMENTED = [
    ("struct scale {", "struct scale { // the process; its members"),
    ("    csp_ends ends;", "    csp_ends ends; // what is closed; at the end"),
    ("    csp_out output;", "    // csp_out spare;\n    csp_out output;"),
    ("struct scale {", "/* struct scale { csp_in spare; }; */\nstruct scale {"),
]


@NEEDS_COMPILER
@pytest.mark.parametrize("change", COMMENTED, ids=["brace", "member", "line", "block"])
def test_a_header_may_have_comments(change: tuple[str, str], tmp_path: Path) -> None:
    network = saved_network(tmp_path, HEADER.replace(*change))
    run = native.simulate(network, read_source, level=0, until=100 * MS, options=("-O0",))
    assert len(run.communications) > 50


INDIRECT = [
    ("\nstruct scale {\n    csp_process process;", "#define OWN csp_process process;\nstruct scale {\n    OWN"),
    ("\nstruct scale {", "typedef csp_out own;\nstruct scale {\n"),
    ("    csp_out output;", "    struct { union { csp_out output; }; };"),
    ("    csp_out output;", "    struct { struct { csp_out output; }; } inside;"),
    ("\nstruct scale {", "typedef struct { csp_out one; } own;\nstruct scale {"),
    ("\nstruct scale {", "typedef csp_out own[1];\n#define BOTH own output_;\nstruct scale {"),
]


SHOWN = [
    ("\n#endif", "\n#define SIZE_OF_IN sizeof(csp_in)\n#ifdef DEBUG\nstruct debug { int level; };\n#endif\n#endif"),
    ("\n};", " };\n#ifdef DEBUG\nstruct debug {\n    int level;\n};\n#endif\n"),
]


@pytest.mark.parametrize(("before", "after"), SHOWN, ids=["behind", "in one line"])
def test_what_is_outside_of_the_struct_hides_no_member(before: str, after: str, tmp_path: Path) -> None:
    assert HEADER.count(before) == 1
    network = saved_network(tmp_path, HEADER.replace(before, after))
    assert pipeline.generate(network, read_source, "c", 0)


@pytest.mark.parametrize(
    ("before", "after"), INDIRECT, ids=["macro", "typedef", "nameless", "inside", "struct", "array"]
)
def test_members_are_found_behind_macros_and_types(before: str, after: str, tmp_path: Path) -> None:
    """States without pointers need each place of one: as many as with members that are declared plainly."""
    plain = pipeline.generate(saved_network(tmp_path, HEADER), read_source, "c", 0)["network_pointers.c"]
    header = HEADER.replace(before, after)
    if "own" in after:
        written = {"csp_out own": "own output", "one": "own output", "own[1]": "BOTH"}
        header = header.replace("    csp_out output;", f"    {next(b for a, b in written.items() if a in after)};")
    files = pipeline.generate(saved_network(tmp_path, header), read_source, "c", 0)
    own = [row for row in plain.splitlines() if "struct scale, output" in row or "struct scale, process" in row]
    rows = "offsetof(struct scale, "
    assert len(own) == 2
    assert ".." not in files["network_pointers.c"]
    assert files["network_pointers.c"].count(rows) == plain.count(rows)


REFUSED = [
    (
        "    csp_out output;",
        "#ifdef OUTPUT\n    csp_out output;\n#endif",
        "scale.h:9: whether `struct scale` has `output`, with a pointer, depends on the preprocessor",
    ),
    ("    csp_process process;\n    csp_ends ends;", "    csp_ends ends;\n    csp_process process;", "begin with"),
    ("    csp_process process;", "    csp_ends process;", "`csp_process process;`"),
    ("    csp_out output;", "    FIELD(csp_out, output);", "scale.h:9: `FIELD(csp_out, output)` in `struct scale`"),
]


@pytest.mark.parametrize(("before", "after", "reason"), REFUSED, ids=["condition", "second", "other", "function"])
def test_what_is_not_known_of_a_struct_is_refused(before: str, after: str, reason: str, tmp_path: Path) -> None:
    network = saved_network(tmp_path, HEADER.replace(before, after))
    with pytest.raises(TargetError) as refused:
        pipeline.generate(network, read_source, "c", 0)
    assert reason in str(refused.value)
    assert "help: " in str(refused.value)
