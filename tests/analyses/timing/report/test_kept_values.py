"""Where a value may be kept from an earlier sample, or not every sample is passed on, no time is reported that a run
may exceed; bounds in tables are rounded to the safe side.
"""

from __future__ import annotations

import pytest

from cspdiag.analyses.timing.report.render_json import as_json
from cspdiag.analyses.timing.report.render_text import lower, table, upper
from tests.analyses.timing.programs import MS, law, report_of
from tests.analyses.timing.report.test_equal_instants import program, simulated

KEPT = "x ? v ; (if v < 0.053 then w := v else skip) ; y ! w"
IN_TURN = "x ? v ; x ? w ; y ! v"


@pytest.mark.parametrize(
    ("steps", "output", "age"),
    [
        (KEPT, "10 ms", 148),
        (f"{KEPT} ; skip", "1 ms immediate", 147),
        ("x ? v ; y ! v + w ; (if v < 0.053 then w := v else skip)", "1 ms", 1),
        ("x ? v ; (if v < 0.053 then w := v else skip) ; (if v < 0 then w := 0 else skip) ; y ! w", "10 ms", 148),
        ("x ? v ; (w := 1.0 / (v - 0.053) catch Fault -> skip) ; y ! w", "10 ms", 0),
        ("x ? v ; (if v < 0.053 then (w := v ; y ! w) else y ! w)", "10 ms", 148),
        (IN_TURN, "5 ms", 3),
    ],
)
def test_a_value_that_may_be_kept_has_no_bound(steps: str, output: str, age: int) -> None:
    text = program("1 ms", output, steps)
    report = report_of(text)
    assert report.is_schedulable
    assert any(chain.age is None and chain.reaction is None for chain in report.chains)
    assert [loop.latency for loop in report.loops] == [None]
    assert simulated(text).age >= age * MS


@pytest.mark.parametrize(
    ("steps", "output", "age", "reaction"),
    [
        ("x ? v ; if v < 0.053 then y ! v else skip", "10 ms", 10, None),
        ("x ? w ; x ? v ; y ! v", "10 ms", 10, None),
        ("x ? v ; (if v < 0.053 then w := v else w := 0) ; y ! w", "10 ms", 1, None),
        ("x ? v ; (if v < 0.053 then w := v else w := v) ; y ! w", "10 ms", 1, None),
        ("x ? v ; w := v ; (if v < 0.053 then w := 0 else skip) ; y ! w", "10 ms", 1, None),
        ("x ? v ; y ! v ; if v < 0.053 then y ! 0 else skip", "10 ms", 1, None),
        ("x ? v ; y ! w ; w := v", "1 ms", 2, 3),
        ("x ? v ; w := v ; y ! w", "10 ms", 1, 11),
    ],
)
def test_ages_are_bounded_though_reactions_may_not_be(steps: str, output: str, age: int, reaction: int | None) -> None:
    text = program("1 ms", output, steps)
    chains = report_of(text).chains
    assert {chain.age for chain in chains} == {age * MS}
    assert {chain.reaction for chain in chains} == {None if reaction is None else reaction * MS}
    seen = simulated(text)
    assert seen.age <= age * MS
    assert reaction is None or seen.reaction <= reaction * MS


@pytest.mark.parametrize("kind", ["overwrite 1", ""])
def test_what_a_loop_that_ends_has_passed_on_may_be_kept_by_another(kind: str) -> None:
    text = """
        process Main {
          in x : double @ 1 ms  in z : double @ 1 ms  out y : double @ 1 ms
          communication { var v : double = 0  var w : double = 0  var p : double = 0  channel c : double KIND }
          composition { (BEGIN (x ? v ; c ! v) END) || mu (c ? w -> skip [] z ? p -> y ! w) }
        }
        """
    text = text.replace("KIND", kind)
    lasting = report_of(text.replace("BEGIN", "mu").replace("END", ""))
    assert [chain.age for chain in lasting.chains if chain.source == "x"] == [2 * MS]
    ending = report_of(text.replace("BEGIN", "(mu").replace("END", "until v > 0.02) ; mu (x ? v)"))
    ages = [chain.age for chain in ending.chains if chain.source == "x"]
    assert ages
    assert set(ages) == {None}


def test_a_loop_that_is_left_bounds_its_reactions_as_long_as_it_lasts() -> None:
    modes = "(mu (x ? v ; y ! v) until v > 0.053) ; mu (x ? v ; y ! 0)"
    text = program("1 ms", "1 ms", "x ? v ; y ! v").replace("mu (x ? v ; y ! v)", modes)
    assert [(chain.reaction, chain.age) for chain in report_of(text).chains] == [(2 * MS, MS)]


def test_the_report_says_why_and_where_there_is_no_bound() -> None:
    report = report_of(program("1 ms", "10 ms", KEPT))
    shown = table(report)
    assert "x     Main, Main  y   no bound  no bound" in shown
    assert (
        "`Main.w`: a value may stay in `w` without bound: it is not certain to be replaced in each sample\n"
        "  --> main.csp:6:" in shown
    )
    (chain,) = as_json(report)["chains"]
    assert (chain["reaction"], chain["age"]) == (None, None)
    assert chain["unbounded"]["name"] == "Main.w"
    assert chain["unbounded"]["line"] == 6
    (row,) = as_json(report)["loops"]
    assert (row["latency"], row["jitter"]) == (None, None)


def test_upper_bounds_are_rounded_up_and_lower_bounds_down() -> None:
    assert (upper(1_000_040), lower(1_000_040)) == ("1.001 ms", "1 ms")
    assert (upper(3_999_960), lower(3_999_960)) == ("4 ms", "3.999 ms")
    assert (upper(999_999), lower(999_999)) == ("1 ms", "999.9 us")
    assert (upper(0), lower(0), upper(7), lower(-1_000_040)) == ("0", "0", "7 ns", "-1.001 ms")


def test_the_table_shows_no_bound_below_what_it_is() -> None:
    text = law("Law", "1000040 ns") + program("5 ms", "5 ms immediate", "law").replace(
        "{ var v", "{ law : Law  x -> law.x  law.y -> y  var v"
    )
    shown = table(report_of(text)).splitlines()
    row = next(line.split("  ") for line in shown if line.startswith("law"))
    cells = [cell.strip() for cell in row if cell.strip()]
    assert cells == [
        "law", "5 ms", "1.001 ms", "20.1 %", "1.001 ms", "0", "1.001 ms", "3.999 ms", "0 to 1.001 ms", "1.001 ms", "y"
    ]  # fmt: skip
    assert next(line for line in shown if line.startswith("x ")).replace("   ", "  ").split("  ")[-2:] == [
        "6.001 ms",
        "1.001 ms",
    ]
