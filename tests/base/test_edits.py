from __future__ import annotations

import pytest

from cspdiag.base import Diagnostic, Edit, SourceFile, Span
from cspdiag.base.edits import apart, applied, removing, replacing
from cspdiag.base.record import record
from cspdiag.base.spelling import is_slip
from tests.base.render.samples import Sample, at, source


@record
class Mendable(Sample):
    change: tuple[Edit, ...] = ()

    @property
    def edits(self) -> tuple[Edit, ...]:
        return self.change


FILE = source("in  a : int;\n  ;\nx = a&&b\n")


def edit(start: int, end: int, text: str, file: SourceFile = FILE) -> Edit:
    return Edit(Span(file, start, end), text)


def test_edits_are_applied_by_their_places() -> None:
    assert applied("abcdef", [edit(4, 5, "E"), edit(0, 1, ""), edit(2, 2, "--")]) == "b--cdEf"
    assert applied("abc", []) == "abc"


def test_a_replaced_word_does_not_join_its_neighbour() -> None:
    assert applied(FILE.text, [replacing(at(FILE, "&&"), "and")]).endswith("x = a and b\n")
    assert replacing(at(FILE, ":"), "=") == Edit(at(FILE, ":"), "=")


def test_removing_includes_the_space_before_and_a_whole_line() -> None:
    assert applied(FILE.text, [removing(at(FILE, ";"))]).startswith("in  a : int\n  ;\n")
    assert applied(FILE.text, [removing(Span(FILE, 15, 16))]) == "in  a : int;\nx = a&&b\n"


def test_of_overlapping_edits_only_the_first_is_applied() -> None:
    other = source("other")

    def found(*changes: Edit) -> Diagnostic:
        return Mendable(changes[0].span if changes else at(FILE, "a"), "e", change=changes)

    both = found(edit(0, 2, "x"), edit(8, 9, "y"))
    meets, inserts, elsewhere, apart_from = (
        found(edit(9, 10, "z")),
        found(edit(2, 2, "z")),
        found(edit(0, 2, "x", other)),
        found(edit(3, 4, "z")),
    )
    assert apart([both, meets, found(), inserts, elsewhere, apart_from]) == [both, elsewhere, apart_from]


@pytest.mark.parametrize(
    ("written", "meant"),
    [("fork1", "fork2"), ("angles", "angle"), ("x_l", "x_r"), ("kp", "Kp"), ("idel", "idol"), ("bangle", "angle"),
     ("state12", "state21"), ("angle", "angle1"), ("an1gle", "angle"), ("xp", "px"), ("", "a")],
)  # fmt: skip
def test_a_difference_that_may_distinguish_is_not_a_slip(written: str, meant: str) -> None:
    assert not is_slip(written, meant)


@pytest.mark.parametrize("written", ["angel", "anlge", "agnle", "anglle", "agle", "ANGLE", "Angle"])
def test_a_slip_is_recognized(written: str) -> None:
    assert is_slip(written, "angle")
