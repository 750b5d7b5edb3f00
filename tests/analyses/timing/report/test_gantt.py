"""Gantt charts are legible for every program: names, bars of almost no time, lateness, very many releases."""

from __future__ import annotations

from functools import cache
from itertools import pairwise
from xml.etree.ElementTree import Element, fromstring

import pytest

from cspdiag.analyses.timing.report.gantt import gantt_svg
from cspdiag.analyses.timing.report.timing import timing_report
from cspdiag.draw.scene.text_metrics import text_width
from tests.analyses.timing.programs import network_of, report_of

TINY = """
submodel Tiny wcet 3 ns { in x : double  out y : double  y = x }
submodel Mid wcet 70 ms { in x : double  out y : double  y = x }
submodel Huge wcet 2 s { in x : double  out y : double  y = x }
process P {
  in  x : double @ 50 ms
  in  m : double @ 1 s
  in  u : double @ 10 s
  out y : double @ 50 ms
  out n : double @ 1 s
  out v : double @ 10 s
  communication { tiny : Tiny  mid : Mid  huge : Huge
    x -> tiny.x  tiny.y -> y  m -> mid.x  mid.y -> n  u -> huge.x  huge.y -> v }
  composition { mu tiny ||> mu mid ||> mu huge }
}
"""

FREQUENT = """
submodel A wcet 300 ns { in x : double  out y : double  y = x }
submodel B wcet 5 us { in x : double  out y : double  y = x }
process P {
  in  x : double @ 10 us
  in  u : double @ 20 s
  out y : double @ 10 us
  out v : double @ 20 s
  communication { a : A  b : B  x -> a.x  a.y -> y  u -> b.x  b.y -> v }
  composition { mu a ||> mu b }
}
"""

MANY = """
submodel Law wcet 20 us { in x : double  out y : double  y = x }
process WMWM_LOOP_WITH_A_VERY_WIDE_NAME_OF_ITS_OWN_AND_THE_WHOLE_PLANT_THAT_RUNS_ON_AND_ON {
  in  x : double @ 1 ms
  out y : double @ 1 ms
  communication { law : Law  x -> law.x  law.y -> y }
  composition { mu law }
}
process THE_OUTERMOST_PROCESS_THAT_HAS_A_NAME_WHICH_IS_LONGER_THAN_ITS_DIAGRAM_IS_WIDE_AND_THEN_SOME_MORE_OF_IT {
  in  x[12] : double @ 1 ms
  out y[12] : double @ 1 ms
  communication {
    WWWW_controller_of_the_chassis_and_everything_that_is_connected_to_it[12] :
      WMWM_LOOP_WITH_A_VERY_WIDE_NAME_OF_ITS_OWN_AND_THE_WHOLE_PLANT_THAT_RUNS_ON_AND_ON
    for i < 12 {
      x[i] -> WWWW_controller_of_the_chassis_and_everything_that_is_connected_to_it[i].x
      WWWW_controller_of_the_chassis_and_everything_that_is_connected_to_it[i].y -> y[i]
    }
  }
  composition { par i < 12 : WWWW_controller_of_the_chassis_and_everything_that_is_connected_to_it[i] }
}
"""

SVG = "{http://www.w3.org/2000/svg}"
LATE = "#c00000"


@cache
def chart(text: str) -> Element:
    return fromstring(gantt_svg(report_of(text)))


def texts(drawn: Element, kind: str) -> list[Element]:
    return [each for each in drawn.iter(f"{SVG}text") if each.get("class") == kind]


def number(element: Element, name: str) -> float:
    return float(element.get(name, "nan"))


def bars(drawn: Element) -> list[Element]:
    return [each for each in drawn.iter(f"{SVG}rect") if each.find(f"{SVG}title") is not None]


@pytest.mark.parametrize("text", [TINY, FREQUENT, MANY])
def test_no_text_leaves_the_picture_or_reaches_into_the_chart(text: str) -> None:
    drawn = chart(text)
    width = number(drawn, "width")
    left = min(number(line, "x1") for line in drawn.iter(f"{SVG}line"))
    for name in texts(drawn, "name"):
        assert number(name, "x") + text_width(name.text or "", 12) < left - 4
    for title in texts(drawn, "title"):
        assert number(title, "x") + text_width(title.text or "", 14) * 1.1 < width, "bold letters are wider"
    marks = [(number(tick, "x"), text_width(tick.text or "", 11)) for tick in texts(drawn, "tick")]
    assert marks[-1][0] + marks[-1][1] / 2 < width
    assert all(one + (own + its) / 2 + 4 < other for (one, own), (other, its) in pairwise(marks))
    assert width - left >= 700


@pytest.mark.parametrize("text", [TINY, FREQUENT, MANY])
def test_every_bar_is_visible_and_only_late_ones_are_red(text: str) -> None:
    for bar in bars(chart(text)):
        assert number(bar, "width") >= 1.5
        assert bar.get("class") is None or number(bar, "width") >= 4, "an edge would cover it"
        red, green, blue = (int(bar.get("fill", "")[place : place + 2], 16) for place in (1, 3, 5))
        is_red = red > 1.9 * max(green, blue)
        assert is_red == (bar.get("fill") == LATE)


def test_what_is_late_is_seen_without_colours_however_short_it_is() -> None:
    drawn = chart(TINY)
    late = [bar for bar in bars(drawn) if bar.get("fill") == LATE]
    tips = [bar.findtext(f"{SVG}title") or "" for bar in late]
    assert {tip.partition(" ")[0] for tip in tips} == {"tiny", "mid"}
    others = [number(bar, "height") for bar in bars(drawn) if bar not in late]
    assert min(number(bar, "height") for bar in late) > max(others)
    (note,) = texts(drawn, "note")
    assert "red and taller: ends after the next release" in (note.text or "")
    assert any("steps, late" in tip for tip in tips), "those of one instant are one bar"


def test_releases_that_cannot_be_distinguished_are_a_band() -> None:
    drawn = chart(FREQUENT)
    assert len(list(drawn.iter())) < 3000
    assert number(drawn, "width") < 1200, "a wider one would show no more"
    (band,) = [each for each in drawn.iter(f"{SVG}rect") if each.get("class") == "many"]
    assert number(band, "width") > 700
    (note,) = texts(drawn, "note")
    assert "grey bands: releases that are too many to be drawn" in (note.text or "")


def test_a_name_that_is_cut_is_whole_in_its_tooltip() -> None:
    (first, *_) = texts(chart(MANY), "name")
    assert "…" in (first.text or "")
    name = "WWWW_controller_of_the_chassis_and_everything_that_is_connected_to_it[0] @ 1 ms"
    assert first.findtext(f"{SVG}title") == name


def test_the_work_of_the_kernel_at_ticks_is_a_row() -> None:
    report = timing_report(network_of(TINY), kernel=1_000_000)
    drawn = fromstring(gantt_svg(report))
    names = [name.text for name in texts(drawn, "name")]
    assert names[0] == "kernel @ 50 ms"
    tips = [bar.findtext(f"{SVG}title") or "" for bar in bars(drawn)]
    assert tips[0] == "kernel @ 50 ms: 0 to 1 ms, released at 0"
    assert any(tip.startswith("tiny @ 50 ms: 1 ms to") for tip in tips), "the kernel comes before all processes"


def test_the_work_of_the_kernel_has_one_row_for_all_periods() -> None:
    text = TINY.replace("@ 50 ms", "@ 3 ms").replace("@ 10 s", "@ 7 ms").replace("@ 1 s", "@ 6 ms")
    drawn = fromstring(gantt_svg(timing_report(network_of(text), kernel=1000)))
    assert texts(drawn, "name")[0].text == "kernel"
    tips = [bar.findtext(f"{SVG}title") or "" for bar in bars(drawn)]
    assert {tip.partition(":")[0] for tip in tips if tip.startswith("kernel")} == {"kernel @ 3 ms", "kernel @ 7 ms"}
