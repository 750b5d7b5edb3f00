"""What changed between two versions of a program, in terms of its diagrams."""

from __future__ import annotations

from pathlib import Path

import pytest

from cspdiag.base import SourceFile
from cspdiag.base.sources import read_source
from cspdiag.draw.differences.picture import marks, union
from cspdiag.draw.differences.programs import Difference, differences
from cspdiag.draw.differences.render_text import render
from cspdiag.draw.elements.texts import same_text
from cspdiag.model.program import Program
from cspdiag.pipeline import check

ROOT = Path(__file__).parents[3]

PROGRAM = """\
const T = 2 ms
struct Gains { kp: double  kd: double }

submodel Law(kp: double<V>) {
  in  e : double
  out u : double<V>
  state last : double = 0
  u = kp * (e - last)
  next last = e
}

process Reader(T: time) {
  in  x : double @ T
  out y : double
  communication { var v : double }
  composition { mu (x ? v ; y ! v) }
}

process Writer {
  in  y : double
  out u : double<V> @ T
  communication {
    law : Law(kp = 2<V>)
    y     -> law.e
    law.u -> u
  }
  composition { mu law }
}

process Top {
  in  x : double    @ T
  out u : double<V> @ T

  communication {
    reader : Reader(T)
    writer : Writer

    x        -> reader.x
    reader.y -> value : double -> writer.y
    writer.u -> u
  }

  composition { reader || writer }
}

assert Top deadlock free
"""


def program(text: str) -> Program:
    checked = check(SourceFile(name="versions.csp", text=text), read_source)
    assert checked.program is not None
    return checked.program


def difference(*replacements: tuple[str, str]) -> Difference:
    text = PROGRAM
    for old, new in replacements:
        assert old in text
        text = text.replace(old, new)
    return differences(program(PROGRAM), program(text))


def reported_changes(*replacements: tuple[str, str]) -> list[str]:
    return [line.strip() for line in render(difference(*replacements).changes).splitlines()]


@pytest.mark.parametrize(
    ("old", "new", "lines"),
    [
        ("kp = 2<V>", "kp = 3<V>", ["process Writer", "~ instance law: argument kp 2<V> → 3<V>"]),
        ("Law(kp = 2<V>)", "Law(2<V>)", []),
        ("u = kp * (e - last)", "u = kp * e", ["submodel Law", "~ equation u: value kp * (e - last) → kp * e"]),
        ("state last : double = 0", "state last : double = 1", ["submodel Law", "~ state last: initial value 0 → 1"]),
        ("kd: double ", "kd: float ", ["struct Gains", "~ field kd: type double → float"]),
        ("var v : double", "var v : double = 0", ["process Reader", "~ variable v: initial value none → 0"]),
        (
            "mu (x ? v ; y ! v)",
            "mu (x ? v ; y ! v ; y ! v)",
            ["process Reader", "~ composition: mu (x ? v ; y ! v) → mu (x ? v ; y ! v ; y ! v)"],
        ),
        ("assert Top deadlock free", "", ["- assert Top deadlock free"]),
        ("submodel Law(kp: double<V>)", "submodel Law(kp: double<V> = 1<V>)",
         ["submodel Law", "~ parameter kp: default none → 1<V>"]),
    ],
)  # fmt: skip
def test_a_change_is_reported_in_the_words_of_the_diagram(old: str, new: str, lines: list[str]) -> None:
    assert reported_changes((old, new)) == lines


def test_a_type_that_differs_in_its_unit_only_is_reported_as_another_unit() -> None:
    lines = reported_changes(("out u : double<V> @ T\n  communication", "out u : double<mV> @ T\n  communication"))
    assert lines == ["process Writer", "~ port u: unit V → mV"]


def test_a_period_that_follows_from_a_constant_is_reported_where_it_is_used() -> None:
    assert reported_changes(("const T = 2 ms", "const T = 5 ms")) == [
        "const T",
        "~ value 2 ms → 5 ms",
        "process Writer",
        "~ port u: period 2 ms → 5 ms",
        "process Top",
        "~ port x: period 2 ms → 5 ms",
        "~ port u: period 2 ms → 5 ms",
    ]


def test_a_composition_that_changes_the_kind_of_a_channel_is_reported() -> None:
    lines = reported_changes(("composition { reader || writer }", "composition { reader ; writer }"))
    assert "~ connection value: inferred kind rendezvous → variable" in lines


def test_a_long_composition_is_reported_by_its_steps_and_a_short_one_as_a_whole() -> None:
    steps = " ; ".join(["x ? v ; y ! v"] * 12)
    before = PROGRAM.replace("mu (x ? v ; y ! v)", f"mu ({steps})")
    after = before.replace("mu (x ? v", "mu (wait 1 ms ; x ? v")
    found = differences(program(before), program(after)).changes
    assert render(found).splitlines() == ["  process Reader", "    + composition: process wait 1 ms"]
    assert [change.name for change in found] == ["", "process"]


def test_renamed_elements_are_recognized_and_cause_no_further_changes() -> None:
    lines = reported_changes(
        ("    reader : Reader", "    source : Reader"),
        ("-> reader.x", "-> source.x"),
        ("reader.y ->", "source.y ->"),
        ("{ reader ||", "{ source ||"),
    )
    assert lines[:2] == ["process Top", "~ instance reader is now called source"]
    assert not [line for line in lines if "connection" in line]


def test_renamed_definitions_are_recognized() -> None:
    assert reported_changes(("process Reader", "process Sampler"), (": Reader(T)", ": Sampler(T)")) == [
        "~ process Reader is now called Sampler"
    ]


def test_a_new_instance_between_two_others_is_reported_with_its_connections() -> None:
    lines = reported_changes(
        ("    writer : Writer\n", "    writer : Writer\n    second : Reader(T)\n"),
        ("    x        -> reader.x\n", "    x        -> reader.x, second.x\n    second.y -> _\n"),
    )
    assert lines == [
        "process Top",
        "+ instance second : Reader(T)",
        "~ connection x -> reader.x, second.x: now to second.x",
        "+ connection second.y -> _",
    ]


def test_whole_added_and_removed_definitions_are_reported_in_one_line() -> None:
    lines = reported_changes(
        ("struct Gains { kp: double  kd: double }", "enum Mode { idle, run }"),
        ("const T = 2 ms", "const T = 2 ms\nconst N = 3"),
    )
    assert lines == ["+ const N = 3", "+ enum Mode", "- struct Gains"]


def test_the_picture_has_the_elements_of_both_versions_with_marks() -> None:
    found = difference(
        ("    writer : Writer\n", "    writer : Writer\n    extra : Writer\n"),
        ("reader.y -> value : double -> writer.y", "reader.y -> value : double -> extra.y"),
        ("writer.u -> u", "extra.u -> u\n    writer.u -> _"),
    )
    (pair,) = [each for each in found.diagrams if each.name == "Top"]
    whole = union(pair.before, pair.after)
    keys = {element.key for element in whole.elements()}
    kinds = {key: mark.kind for key, mark in marks(pair).items()}
    assert kinds["extra"] == "added"
    assert kinds["value (before)"] == "removed"
    assert kinds["value (after)"] == "added"
    assert kinds["extra.u -> u"] == "added"
    assert kinds["writer.u -> u"] == "removed"
    assert kinds["writer.u -> writer.u -> _"] == "added"
    assert "writer" not in kinds
    assert {key for key in kinds if "." not in key} <= keys


def test_every_model_differs_in_nothing_from_itself() -> None:
    for path in sorted(ROOT.glob("models/*/*.csp")):
        versions = [check(read_source(str(path)), read_source).program for _ in range(2)]
        assert versions[0] is not None
        assert versions[1] is not None
        assert differences(versions[0], versions[1]) == Difference()


def test_a_model_differs_from_nothing_in_all_its_definitions() -> None:
    jiwy = check(read_source(str(ROOT / "models/jiwy/jiwy.csp")), read_source).program
    assert jiwy is not None
    found = differences(program(""), jiwy)
    assert {change.definition for change in found.changes if change.kind != "assert"} == set(jiwy.definitions)
    assert {change.action for change in found.changes} == {"added"}
    backwards = differences(jiwy, program(""))
    assert {change.action for change in backwards.changes} == {"removed"}
    assert len(backwards.changes) == len(found.changes)


def test_spaces_within_indexes_do_not_count() -> None:
    text = (ROOT / "models/ring/ring.csp").read_text(encoding="utf-8")
    changed = text.replace("cell[i + 1].input", "cell[ i+1 ].input").replace("cell[cells - 1]", "cell[cells-1]")
    assert changed != text
    assert differences(program(text), program(changed)) == Difference()


WRITING = """\
const OFFSET = 1.50<V>
const WAIT = 0.020 s

submodel Law {
  in  e : double<V>
  out u : double<V>[2]
  u[0] = 0.5 * e - 1.0e-3 * OFFSET
  u[1] = e
}

process Body {
  composition { skip }
}

assert  Body terminates
"""


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("1.50<V>", "1.5<V>"),
        ("1.50<V>", "0.15e+01<V>"),
        ("0.020 s", "0.02s"),
        ("1.0e-3", "0.001"),
        ("u[0] =", "u[ 0 ] ="),
        ("0.5 * e - 1.0e-3 * OFFSET", "0.50*e-1.0e-3*OFFSET"),
        ("assert  Body", "assert Body"),
    ],
)
def test_what_is_only_written_in_another_way_is_no_change(old: str, new: str) -> None:
    assert old in WRITING
    assert differences(program(WRITING), program(WRITING.replace(old, new))).changes == ()


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("1.50<V>", "1.05<V>"),
        ("1.50<V>", "15.0<V>"),
        ("0.020 s", "0.02 ms"),
        ("1.0e-3", "1.0e-30"),
    ],
)
def test_what_means_something_else_is_a_change(old: str, new: str) -> None:
    assert old in WRITING
    (change,) = differences(program(WRITING), program(WRITING.replace(old, new))).changes
    assert change.action == "changed"


def test_an_integer_is_not_a_number_with_a_point() -> None:
    """Its type is another one."""
    (change,) = differences(program("const N = 2"), program("const N = 2.0")).changes
    assert (change.before, change.after) == ("2", "2.0")


def test_spaces_and_digits_within_a_text_are_part_of_it() -> None:
    assert not same_text('"my port"', '"myport"')
    assert not same_text('"COM01.0"', '"COM1.0"')
    assert not same_text("not a", "nota")


def test_states_and_values_of_a_submodel_that_were_renamed_are_found() -> None:
    before = """submodel Filter(rate: double = 2) {
  in  a : double
  out p : double
  state old : double = 0
  let half = old / rate
  let sum  = half + a
  next old = sum
  p = sum * 2
}
"""
    after = (
        before.replace("rate", "speed").replace("old", "stored").replace("half", "part").replace("sum * 2", "sum * 3")
    )
    assert render(differences(program(before), program(after)).changes).splitlines() == [
        "  submodel Filter",
        "    ~ parameter rate is now called speed",
        "    ~ state old is now called stored",
        "    ~ let half is now called part",
        "    ~ equation p: value sum * 2 → sum * 3",
    ]


def test_what_also_changed_or_could_be_two_things_is_not_renamed() -> None:
    before = "submodel Two {\n  in  a : double\n  out p : double\n  let x = a\n  let y = a\n  p = x + y\n}\n"
    after = before.replace("let x", "let u").replace("let y", "let v").replace("x + y", "u + v")
    found = render(differences(program(before), program(after)).changes).splitlines()
    assert not any("is now called" in line for line in found)
    assert [line.split()[0] for line in found[1:]] == ["-", "-", "+", "+", "~"]
