"""The values of names: ranges, lists, and what is refused."""

from __future__ import annotations

import pytest

import cspdiag
from cspdiag.arguments import values_of
from cspdiag.base.sources import read_source
from cspdiag.base.span import SourceFile
from cspdiag.sweep.plan import Request, plan_sweep
from tests.sweep.programs import HEATER


def values(name: str, given: object) -> list[object]:
    """What tables have of the values of a name."""
    source = SourceFile(name="heater.csp", text=HEATER)
    request = Request(source=source, given=values_of({name: given}), measures=(), environment=None, until=0)
    (axis,) = plan_sweep(request, read_source).grid.axes
    return [value.cell for value in axis.values]


def test_values_are_equally_far_apart() -> None:
    assert values("gain", "0.1:0.5:5") == [0.1, 0.2, 0.3, 0.4, 0.5]


def test_values_in_equal_ratios() -> None:
    assert values("gain", "1:100:3:log") == [1.0, 10.0, 100.0]


def test_a_list() -> None:
    assert values("gain", "1, 2.5 ,4") == [1.0, 2.5, 4.0]


def test_times_are_seconds() -> None:
    assert values("T", "10ms:30 ms:3") == [0.01, 0.02, 0.03]
    assert values("T", [0.5]) == [0.5]


def test_values_of_python() -> None:
    numpy = pytest.importorskip("numpy")
    assert values("gain", numpy.linspace(1, 2, 3)) == [1.0, 1.5, 2.0]
    assert values("gain", 3) == [3.0]


@pytest.mark.parametrize(
    ("name", "text", "reason"),
    [
        ("gains", "1:2:3", "there is no constant 'gains' (did you mean 'gain'?)"),
        ("gain", "1:2:0", "a sweep needs at least one"),
        ("gain", "1:2", "is not FIRST:LAST:COUNT"),
        ("gain", "1:2:three", "three is not a number of values"),
        ("gain", "0:2:3:log", "equal ratios need two values of one sign"),
        ("gain", "1<V>:2<V>:3", "gain"),
        ("gain", "1,,2", "gain"),
        ("gain", "", "gain"),
        ("gain", "1:2:99999999", "99999999 values are too many"),
        ("gain", "1:2:99999999999", "99999999999 values are too many"),
        ("gain", "a:b:c", "`a:b:c` is not FIRST:LAST:COUNT, such as 1:5:9: c is not a number of values"),
    ],
)
def test_what_is_not_a_range_is_refused(name: str, text: str, reason: str) -> None:
    with pytest.raises(cspdiag.SettingError) as caught:
        cspdiag.parse(HEATER).sweep({name: text}, until=1)
    assert reason in str(caught.value)
    assert "\n" not in str(caught.value)


def test_no_values_are_refused() -> None:
    with pytest.raises(cspdiag.SettingError, match="gain: a sweep needs at least one value"):
        cspdiag.parse(HEATER).sweep({"gain": []}, until=1)


def test_whole_numbers_between_which_there_is_none() -> None:
    program = cspdiag.parse("parameter n : int = 1\nprocess A {\n  composition { skip }\n}\n")
    with pytest.raises(cspdiag.SettingError, match="4 values from 1 to 2 are not whole numbers"):
        program.sweep({"n": "1:2:4"})


def test_floats_that_are_whole_are_integers() -> None:
    program = cspdiag.parse("parameter n : int = 1\nprocess A {\n  composition { skip }\n}\n")
    assert [row["n"] for row in program.sweep({"n": [2.0, -1e16]}, target="python", workers=1).rows] == [2, -(10**16)]
    with pytest.raises(cspdiag.SettingError, match=r"2\.5"):
        program.sweep({"n": [2.5]})


def test_a_grid_that_is_too_large_is_refused_before_it_is_made() -> None:
    with pytest.raises(cspdiag.SettingError, match="9000 x 9000 = 81000000 runs, more than 10000000"):
        cspdiag.parse(HEATER).sweep({"gain": "1:2:9000", "target": "1:2:9000"}, until=1)
