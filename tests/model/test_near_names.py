"""Which name was probably meant."""

from __future__ import annotations

import pytest

from cspdiag.base.spelling import Speller, edits, near_symbol
from cspdiag.model.units import near_unit

NAMES = ["feedback", "control", "status", "kp", "T", "joystick_buttons", "max"]


@pytest.mark.parametrize(
    ("written", "expected"),
    [
        ("feedbak", "feedback"),
        ("Control", "control"),
        ("statsu", "status"),
        ("joystick_button", "joystick_buttons"),
        ("mx", None),
        ("t", None),
        ("velocity", None),
        ("feedback", None),
    ],
)
def test_nearest_name(written: str, expected: str | None) -> None:
    assert Speller().nearest(written, NAMES) == expected


@pytest.mark.parametrize(
    ("written", "names", "expected"),
    [("EE", ["E"], "E"), ("aab", ["ab"], "ab"), ("n22", ["n2"], None), ("ab", ["abb"], "abb")],
)
def test_a_doubled_letter_is_a_slip_in_short_names(written: str, names: list[str], expected: str | None) -> None:
    assert Speller().nearest(written, names) == expected


@pytest.mark.parametrize(
    ("written", "expected"),
    [
        ("Hzz", "Hz"),
        ("Hhz", "Hz"),
        ("zH", "Hz"),
        ("HZ", "Hz"),
        ("mHz", None),
        ("GHz", None),
        ("mins", "min"),
        ("mm", None),
        ("mVs", None),
        ("V", None),
    ],
)
def test_near_symbols_of_units(written: str, expected: str | None) -> None:
    assert near_symbol(written, ["Hz", "MHz", "ms", "min", "s"]) == expected


@pytest.mark.parametrize(
    ("written", "expected"),
    [("Hzz", "Hz"), ("rad/ss", None), ("raad/s", "rad/s"), ("N*mol*HZ", "N*mol*Hz"), ("Nm", "N*m"), ("wheel", None)],
)
def test_near_units(written: str, expected: str | None) -> None:
    assert near_unit(written) == expected


def test_a_text_full_of_unknown_names_is_checked_in_bounded_time() -> None:
    speller = Speller(comparisons=10, measurements=10)
    assert speller.nearest("feedbak", NAMES) == "feedback"
    assert speller.nearest("feedbak", NAMES) == "feedback"
    assert [speller.nearest("feedbak", [*NAMES[1:], "feedback"]) for _ in range(5)] == [None] * 5


@pytest.mark.parametrize(
    ("left", "right", "distance"), [("", "abc", 3), ("abc", "acb", 1), ("abc", "abd", 1), ("ab", "ba", 1)]
)
def test_edits(left: str, right: str, distance: int) -> None:
    assert edits(left, right) == distance == edits(right, left)
