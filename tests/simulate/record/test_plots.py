"""Plots: every part and port has a place of its own, and no text overlaps another, a curve or a legend."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from functools import cache
from itertools import combinations, pairwise
from pathlib import Path

import numpy
import pytest

import cspdiag
from cspdiag import pipeline
from cspdiag.base import SourceFile
from cspdiag.base.sources import read_source
from cspdiag.simulate.record.plot.series import series_of, shortened, stairs, thinned, unit_of_time
from cspdiag.simulate.result import Run
from cspdiag.simulate.run.execute import simulate
from tests.simulate.record.test_samples import DRIVE

pytest.importorskip("matplotlib")

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.transforms import Bbox

MODELS = Path(__file__).parents[3] / "models"

STATIONS = """
enum Phase { waiting, clamping, drilling, releasing_the_work_piece }

process Clamp(n : int) { composition { wait 100 ms * (n + 1) } }
process Drill { composition { wait 300 ms } }

process Station(n : int) {
  out busy  : bool  @ 50 ms
  out phase : Phase @ 50 ms
  communication {
    clamp : Clamp(n = n)
    drill : Drill
  }
  composition {
    seq i < 3 : (busy ! true ; phase ! Phase.clamping ; clamp ; phase ! Phase.drilling ; drill ; busy ! false ;
                 phase ! Phase.releasing_the_work_piece ; wait 200 ms)
  }
}

process Line {
  in  button   : int
  out busy[5]  : bool  @ 50 ms
  out phase[5] : Phase @ 50 ms
  communication {
    station[i < 5] : Station(n = i)
    for i < 5 {
      station[i].busy  -> busy[i]
      station[i].phase -> phase[i]
    }
    var pressed : int
  }
  composition { (par i < 5 : station[i]) || (mu button ? pressed) }
}

submodel Hand {
  out button : int
  state t : int = 0
  next t = t + 1
  button = if t < 100 then 0 else if t < 104 then 12345 else t / 35
}

environment Bench for Line step 10 ms {
  hand : Hand
  hand.button -> button
  for i < 5 {
    busy[i]  -> _
    phase[i] -> _
  }
}
"""

CURVES = """
process Curves {
  in  a_very_long_name_of_the_encoder_at_wheel[8] : double<rad> @ 10 ms
  in  broken : double<V> @ 10 ms
  in  once   : double<K> @ 70 ms
  in  never  : double<W> @ 7 s
  out nobody : int
  composition { wait 100 ms }
}

driver Broken python "broken.py:Broken" {
  out broken : double<V>
}

submodel Wheels {
  out a : double<rad>
  out once : double<K>
  state t : int = 0
  next t = t + 1
  a = double(t) * 1<rad>
  once = double(t) * 1<K>
}

environment Bench for Curves step 1 ms {
  wheels : Wheels
  torn   : Broken
  for i < 8 {
    wheels.a -> a_very_long_name_of_the_encoder_at_wheel[i]
  }
  torn.broken -> broken
  wheels.once -> once
  1<W> -> never
  nobody -> _
}
"""

BROKEN = """
class Broken:
    count = 0

    def read(self, port):
        self.count += 1
        return float("inf") if self.count % 30 < 10 else float(self.count)
"""

PULSES = """
enum Beat { tick, tock }

process Beats {
  in  reported  : time @ 50 ms
  out heartbeat : int
  out alive     : bool
  out beat      : Beat
  out weight    : double<kg>
  out fast      : int
  out lateness  : time @ 100 ms
  out count     : int @ 100 ms
  communication { var r : time }
  composition {
    (seq i < 20 : (heartbeat ! 1 ; alive ! true ; beat ! Beat.tock ; weight ! 2.5<kg> ; wait 100 ms))
    || (mu (fast ! 7 ; wait 3 ms))
    || (mu reported ? r)
    || (seq i < 15 : (lateness ! (3 ms * (i % 4)) ; count ! i ; wait 120 ms))
  }
}

submodel Clock {
  out reported : time
  state k : int = 0
  next k = k + 1
  reported = 1 ms * (k % 7) + 20 ms
}

environment Bench for Beats step 10 ms {
  clock : Clock
  clock.reported -> reported
  heartbeat -> _
  alive -> _
  beat -> _
  weight -> _
  fast -> _
  lateness -> _
  count -> _
}
"""

LIGHTS = """
enum Light { red, amber, green }

process Crossing {
  out north : Light @ 20 ms
  out east  : Light @ 20 ms
  out temperature_of_the_cabinet_at_the_corner_of_the_market_place : double<W/m^2/K> @ 20 ms
  out cars  : int
  communication { var n : int = 0 }
  composition {
    (mu (cars ! 1000000000 + n ; n := n + 1 ; wait 7 ms)) ||
    (mu (north ! Light.green ; east ! Light.red ; wait 60 ms ; north ! Light.amber ; wait 20 ms ;
         north ! Light.red ; east ! Light.green ; wait 20 ms))
    || (seq i < 2 : (temperature_of_the_cabinet_at_the_corner_of_the_market_place ! double(i) * 1<W/m^2/K> + 300<W/m^2/K> ;
                     wait 40 ms))
  }
}

environment Bench for Crossing step 10 ms {
  north -> _
  east -> _
  temperature_of_the_cabinet_at_the_corner_of_the_market_place -> _
  cars -> _
}
"""

INSTANTS = """
enum Mode { idle, moving, done }

process Burst {
  out at_once, later, twice, last : int
  out mode : Mode
  composition {
    (at_once ! 1000 ; at_once ! 2222 ; wait 1 s ; at_once ! 17 ; wait 30 ms ; at_once ! 18 ; wait 70 ms ; at_once ! 19 ;
     at_once ! 123456789 ; at_once ! 20 ; wait 90 ms ; at_once ! 21)
    || (seq i < 5 : (later ! 1 ; later ! i + 100 ; later ! 7 ; wait 230 ms))
    || (seq i < 6 : (twice ! 5 ; twice ! 5 ; wait 200 ms))
    || (wait 1200 ms ; last ! 12345678)
    || (wait 1 s ; mode ! Mode.moving ; mode ! Mode.idle ; mode ! Mode.done ; wait 200 ms)
  }
}

environment Bench for Burst {
  at_once -> _
  later -> _
  twice -> _
  last -> _
  mode -> _
}
"""

ENDS_AT_ONCE = """
enum Mode { idle, done }
process Short {
  out a    : int
  out mode : Mode
  composition { a ! 1000 ; a ! 2222 ; mode ! Mode.done }
}
environment Bench for Short { a -> _  mode -> _ }
"""

WIDE_NAMES = """
enum Phase { waiting_for_the_operator_to_come, clamping_the_work_piece, releasing_the_work_piece_again }
process Line {
  out a_very_long_name_of_an_output_of_the_machine[2] : int
  out phase_of_the_production_line_at_the_left_side : Phase
  composition {
    (par k < 2 : (seq i < 7 : (a_very_long_name_of_an_output_of_the_machine[k] ! 1000 + i ; wait 140 ms)))
    || (seq i < 7 : (phase_of_the_production_line_at_the_left_side ! Phase.clamping_the_work_piece ; wait 300 ms ;
                     phase_of_the_production_line_at_the_left_side ! Phase.releasing_the_work_piece_again ; wait 20 ms))
  }
}
environment Bench for Line {
  for i < 2 { a_very_long_name_of_an_output_of_the_machine[i] -> _ }
  phase_of_the_production_line_at_the_left_side -> _
}
"""

NOTHING = "process Nothing { composition { skip } }\n"

PROGRAMS = {
    "pulses": PULSES,
    "lights": LIGHTS,
    "instants": INSTANTS,
    "ends at once": ENDS_AT_ONCE,
    "wide names": WIDE_NAMES,
    "nothing": NOTHING,
    "stations": STATIONS,
    "drive": DRIVE,
    "curves": CURVES.replace("1<W> -> never", "wheels.power -> never"),
}
PROGRAMS["curves"] = PROGRAMS["curves"].replace(
    "  out once : double<K>\n  state", "  out once : double<K>\n  out power : double<W>\n  power = 1<W>\n  state"
)


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Run]:
    folder = tmp_path_factory.mktemp("plots")
    found = {}
    (folder / "broken.py").write_text(BROKEN)
    for name, text in PROGRAMS.items():
        (folder / f"{name}.csp").write_text(text)
        environment = "Bench" if "Bench" in text else None
        found[name] = cspdiag.load(str(folder / f"{name}.csp")).run(environment, until=UNTIL.get(name, "5 s"))
    for name in ("jiwy", "emergency", "watchdog", "buffer", "cascade", "dining", "ring"):
        found[name] = cspdiag.load(str(MODELS / name / f"{name}.csp")).run(until="3 s")
    return found


UNTIL = {"pulses": "2 s", "lights": "200 ms", "wide names": "1.2 s"}
NAMES = [*PROGRAMS, "jiwy", "emergency", "watchdog", "buffer", "cascade", "dining", "ring"]


@cache
def drawn(run: Run) -> Figure:
    from matplotlib.backends.backend_agg import FigureCanvasAgg

    figure = run.plot()
    FigureCanvasAgg(figure).draw()
    return figure


def boxes(figure: Figure) -> Iterator[tuple[str, Bbox]]:
    """Every visible text, with its place on the page."""
    renderer = figure.canvas.get_renderer()  # type: ignore[attr-defined]
    for axes in figure.axes:
        legend = axes.get_legend()
        low, high = sorted(axes.get_ylim())
        labels = [label for label in axes.get_yticklabels() if low <= label.get_position()[1] <= high]
        texts = [*axes.texts, axes.title, axes.yaxis.label, *labels, *(legend.get_texts() if legend else [])]
        for text in texts:
            if text.get_text() and text.get_visible():
                yield text.get_text(), text.get_window_extent(renderer)


def lanes_of(figure: Figure) -> Axes:
    return figure.axes[0]


def names(axes: Axes) -> list[str]:
    return [label.get_text() for label in axes.get_yticklabels()]


@pytest.mark.parametrize("name", NAMES)
def test_no_text_overlaps_another(runs: dict[str, Run], name: str) -> None:
    found = list(boxes(drawn(runs[name])))
    crossing = [
        (one, other)
        for (one, here), (other, there) in combinations(found, 2)
        if here.x0 < there.x1 - 1 and there.x0 < here.x1 - 1 and here.y0 < there.y1 - 2 and there.y0 < here.y1 - 2
    ]
    assert crossing == []


@pytest.mark.parametrize("name", NAMES)
def test_legends_are_next_to_the_curves_and_everything_is_on_the_page(runs: dict[str, Run], name: str) -> None:
    figure = drawn(runs[name])
    renderer = figure.canvas.get_renderer()  # type: ignore[attr-defined]
    for axes in figure.axes:
        legend = axes.get_legend()
        if legend is not None:
            box = legend.get_window_extent(renderer)
            assert not any(box.overlaps(other.get_window_extent(renderer)) for other in figure.axes)
    for text, box in boxes(figure):
        assert -1 <= box.x0 <= box.x1 <= figure.bbox.x1 + 1, text


@pytest.mark.parametrize("name", NAMES)
def test_curves_of_a_panel_are_distinguished_without_colours(runs: dict[str, Run], name: str) -> None:
    for axes in drawn(runs[name]).axes:
        legend = axes.get_legend()
        styles = (
            [str(line.get_dash_capstyle()) + str(line._dash_pattern) for line in legend.get_lines()] if legend else []
        )
        assert len(set(styles)) == len(styles)


def test_parallel_parts_have_lanes_of_their_own(runs: dict[str, Run]) -> None:
    axes = lanes_of(drawn(runs["stations"]))
    assert names(axes)[:5] == [f"station[{index}]" for index in range(5)]
    bars = [patch for patch in axes.patches if isinstance(patch, Rectangle)]
    for row in range(5):
        own = sorted((bar.get_x(), bar.get_x() + bar.get_width()) for bar in bars if row < bar.get_y() < row + 1)
        assert len(own) == 6
        assert all(end <= start + 1e-9 for (_, end), (start, _) in pairwise(own))


def test_conditions_and_literals_are_stacked(runs: dict[str, Run]) -> None:
    axes = lanes_of(drawn(runs["stations"]))
    assert [*names(axes)[-11:]] == ["button", *(f"busy[{n}]" for n in range(5)), *(f"phase[{n}]" for n in range(5))]
    heights = [line.get_ydata() for line in axes.lines if len(line.get_ydata()) > 10 and line.get_marker() == "None"]
    assert len(heights) == 5
    assert len({int(numpy.nanmin(values)) for values in heights}) == 5
    reported = " ".join(text for text, _ in boxes(drawn(runs["stations"])))
    assert all(literal in reported for literal in ("waiting", "clamping", "drilling", "releasing_the_work_piece"))


def panel_of(figure: Figure, curve: str) -> Axes:
    return next(axes for axes in figure.axes if curve in (line.get_label() for line in axes.lines))


def marks_of(figure: Figure, port: str) -> list[float]:
    """When a lane has marks."""
    axes = lanes_of(figure)
    row = names(axes).index(port)
    marks = [line for line in axes.lines if line.get_marker() != "None" and row < line.get_ydata()[0] < row + 1]
    return [float(instant) for line in marks for instant in line.get_xdata()]


def test_events_that_bring_the_same_again_are_all_seen(runs: dict[str, Run]) -> None:
    figure = drawn(runs["pulses"])
    written = [0.1 * count for count in range(20)]
    assert marks_of(figure, "heartbeat") == pytest.approx([*written, 2.0]), "the last one is the safe value"
    assert marks_of(figure, "alive") == pytest.approx([*written, 2.0])
    assert marks_of(figure, "beat") == pytest.approx([*written, 2.0])
    fast = marks_of(figure, "fast")
    assert len(fast) == 668
    assert numpy.diff(fast).max() < 0.0031
    weight = [line for line in panel_of(figure, "weight").lines if line.get_marker() == "|"]
    assert [float(at) for line in weight for at in line.get_xdata()] == pytest.approx(written[1:])


def texts_in_lane(figure: Figure, port: str) -> list[str]:
    """The texts next to the marks of a lane, from left to right."""
    axes = lanes_of(figure)
    row = names(axes).index(port)
    found = [(*text.get_position()[::-1], text.get_text()) for text in axes.texts]
    return [text for _, text in sorted((place, text) for height, place, text in found if row < height < row + 1)]


def test_values_of_one_instant_share_a_label(runs: dict[str, Run]) -> None:
    figure = drawn(runs["instants"])
    assert texts_in_lane(figure, "at_once") == ["1000, 2222", "17", "18", "…", "21, 0"]
    assert texts_in_lane(figure, "later") == [*(f"1, {100 + i}, 7" for i in range(5)), "0"]
    assert texts_in_lane(figure, "twice") == ["5, 5"] * 6 + ["0"]
    assert texts_in_lane(figure, "last") == ["12345678, 0"]


def test_literals_that_pass_in_no_time_are_seen(runs: dict[str, Run]) -> None:
    axes = lanes_of(drawn(runs["instants"]))
    legend = axes.get_legend()
    assert legend is not None
    (several,) = (
        patch.get_facecolor()
        for patch, text in zip(legend.get_patches(), legend.get_texts(), strict=True)
        if text.get_text() == "several, briefly"
    )
    (bar,) = [each for each in axes.patches if isinstance(each, Rectangle) and each.get_facecolor() == several]
    assert (bar.get_x(), bar.get_width() > 0.001) == (1.0, True)


def test_a_run_of_zero_length_reports_what_it_wrote(runs: dict[str, Run]) -> None:
    figure = drawn(runs["ends at once"])
    assert texts_in_lane(figure, "a") == ["1000, 2222, 0"]
    assert texts_in_lane(figure, "mode") == ["idle"]


def test_numbers_without_room_to_be_written_are_a_curve(runs: dict[str, Run]) -> None:
    figure = drawn(runs["lights"])
    assert "cars" not in names(lanes_of(figure))
    low, high = panel_of(figure, "cars").get_ylim()
    assert 1e9 - 5 < low <= 1e9 < 1e9 + 28 <= high < 1e9 + 40


def test_durations_have_an_axis_of_their_own_in_a_unit_that_suits_them(runs: dict[str, Run]) -> None:
    figure = drawn(runs["pulses"])
    axes = panel_of(figure, "reported")
    assert axes.get_ylabel() == "duration (ms)"
    assert [line.get_label() for line in axes.lines if not str(line.get_label()).startswith("_")] == [
        "reported",
        "lateness",
    ]
    assert {"0", "5", "10", "15", "20", "25"} <= set(names(axes))
    assert panel_of(figure, "count").get_ylabel() == "value"


@pytest.mark.parametrize(
    ("longest", "unit"), [(90.0, "s"), (1.0, "s"), (0.5, "ms"), (2e-5, "µs"), (3e-8, "ns"), (0.0, "s")]
)
def test_the_unit_suits_the_longest_duration(longest: float, unit: str) -> None:
    assert unit_of_time(longest)[0] == unit


def test_a_short_run_is_shown_in_milliseconds(runs: dict[str, Run]) -> None:
    last = drawn(runs["lights"]).axes[-1]
    assert last.get_xlabel().partition("   ")[0] == "time (ms)"
    assert {"0", "50", "100", "150", "200"} <= {label.get_text() for label in last.get_xticklabels()}
    assert [label.get_text() for label in drawn(runs["nothing"]).axes[-1].get_xticklabels()] == ["0"]


def test_literals_have_no_hue_that_could_contradict_their_names(runs: dict[str, Run]) -> None:
    bars = [patch for patch in lanes_of(drawn(runs["lights"])).patches if isinstance(patch, Rectangle)]
    colors = {bar.get_facecolor()[:3] for bar in bars}
    assert len(colors) >= 3
    assert all(red <= green <= blue for red, green, blue in colors), "greys and blues"


def test_a_safe_value_at_the_end_does_not_flatten_the_run(runs: dict[str, Run]) -> None:
    axes = panel_of(drawn(runs["lights"]), shortened("temperature_of_the_cabinet_at_the_corner_of_the_market_place"))
    assert runs["lights"]["temperature_of_the_cabinet_at_the_corner_of_the_market_place"][-1] == 0
    low, high = axes.get_ylim()
    assert (low, high) == pytest.approx((299.95, 301.05))
    assert axes.get_ylabel() == "(W/m²/K)"


def test_unread_samples_are_drawn_thin(runs: dict[str, Run]) -> None:
    figure = drawn(runs["drive"])
    axes = figure.axes[1]
    speed = {line.get_linewidth(): line for line in axes.lines if line.get_color() == "#1f4e79"}
    thick, thin = speed[max(speed)], speed[min(speed)]
    assert thin.get_linewidth() < 0.5 < thick.get_linewidth()
    read, unread = (numpy.asarray(line.get_ydata(), dtype=float) for line in (thick, thin))
    assert numpy.nanmax(read) == 50.0
    assert (numpy.nanmin(unread), numpy.nanmax(unread)) == (60.0, 240.0)
    assert "thin: never read" in figure.axes[-1].get_xlabel()


def test_vectors_and_structs_are_curves(runs: dict[str, Run]) -> None:
    reported = [text for text, _ in boxes(drawn(runs["drive"]))]
    assert {"gyro[0]", "gyro[1]", "gyro[2]", "pose.x", "pose.at[0]", "pose.at[1]", "shown[0]", "shown[1]"} <= set(
        reported
    )


def test_nothing_is_left_out(runs: dict[str, Run]) -> None:
    for run in runs.values():
        reported = {text for text, _ in boxes(drawn(run))}
        for series in series_of(run):
            name = shortened(series.name)
            assert {name, f"{name} (no value)"} & reported, series.name


def test_gaps_stay_gaps(runs: dict[str, Run]) -> None:
    broken = next(series for series in series_of(runs["curves"]) if series.name == "broken")
    _, value = stairs(broken, 0.1, unread=True)
    assert numpy.isnan(value).any()
    assert numpy.nanmax(value) < 1e6


def test_a_long_run_has_no_more_points_than_can_be_seen() -> None:
    time = numpy.arange(1_000_000) * 1e-3
    value = numpy.sin(time)
    value[500_000] = 7.0
    value[700_000:710_000] = numpy.nan
    few, seen = thinned(time, value, 1000.0)
    assert len(few) < 8_000
    assert (numpy.nanmax(seen), numpy.nanmin(seen)) == (7.0, numpy.nanmin(value))
    assert numpy.isnan(seen).any()
    assert (numpy.diff(few) >= 0).all()


def test_a_long_name_keeps_both_ends() -> None:
    assert shortened("speed") == "speed"
    short = shortened("a_very_long_name_of_the_encoder_at_wheel[7]")
    assert (short[:11], short[-8:], len(short)) == ("a_very_long", "wheel[7]", 30)


def test_a_figure_is_the_same_every_time(runs: dict[str, Run]) -> None:
    assert runs["emergency"]._repr_svg_() == runs["emergency"]._repr_svg_()


def shown_run(text: str) -> Figure:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "shown.csp"
        path.write_text(text)
        return drawn(cspdiag.load(str(path)).run(until="2.5 s"))


def curves_of(axes: Axes) -> list[str]:
    legend = axes.get_legend()
    return [text.get_text() for text in legend.get_texts()] if legend else []


MANY = """
submodel Law { in x : double  out y : double  y = 2 * x }
process Main {
  in  x[20] : double @ 10 ms
  out y[20] : double @ 10 ms
  communication { law[20] : Law  for i < 20 { x[i] -> law[i].x  law[i].y -> y[i] } }
  composition { mu (seq i < 20 : law[i]) }
}
submodel Waves { out x[20] : double  EQUATIONS }
environment Bench for Main { waves : Waves  for i < 20 { waves.x[i] -> x[i]  y[i] -> _ } }
""".replace("EQUATIONS", "  ".join(f"x[{i}] = sin({i + 1}<1/s> * time) + {i}" for i in range(20)))


def test_the_elements_of_a_port_share_panels_with_no_other_port() -> None:
    figure = shown_run(MANY)
    panels = [curves_of(axes) for axes in figure.axes]
    assert all(len({name[0] for name in panel}) == 1 for panel in panels)
    assert [len(panel) for panel in panels] == [5] * 8


def test_safe_values_at_the_end_are_marked_and_off_the_scale() -> None:
    figure = shown_run(MANY)
    last = figure.axes[-1]
    assert curves_of(last)[-1] == "y[19]"
    low, high = last.get_ylim()
    assert low > 25
    assert high < 45
    marks = [line for line in last.lines if line.get_marker() == "v"]
    assert len(marks) == 5
    assert all(list(line.get_ydata()) == [low] for line in marks)
    assert "safe value, off the scale" in last.get_xlabel()


SIZES = """
process Main {
  in a, b, c, d : double @ 5 ms
  communication { var p : double }
  composition { mu (a ? p ; b ? p ; c ? p ; d ? p) }
}
submodel Plant {
  out a, b, c, d : double
  a = 1e12 * sin(10<1/s> * time)
  b = 1e-12 * cos(10<1/s> * time)
  c = 5
  d = exp(1<1/s> * time)
}
environment Bench for Main { plant : Plant  plant.a -> a  plant.b -> b  plant.c -> c  plant.d -> d }
"""


def test_signals_of_very_different_size_have_panels_of_their_own() -> None:
    assert [curves_of(axes) for axes in shown_run(SIZES).axes] == [["a"], ["b"], ["c", "d"]]


COUNTS = """
process First {
  in  angle : double<rad> @10 ms
  out slow, far, farther : double<rad>
  communication { var here : double<rad> }
  composition { angle ? here ; slow ! 0.05 * here ; far ! 400 * here ; farther ! 50000 * here }
}
process Second {
  in slow, far, farther : double<rad>
  communication { var sum : double<rad>  var part : double<rad> }
  composition { slow ? sum ; far ? part ; sum := sum + part ; farther ? part ; sum := sum + part }
}
process Main {
  in  angle : double<rad> @10 ms
  out rounds, pulses : int @10 ms
  communication {
    var n : int = 0
    first  : First
    second : Second
    angle -> first.angle
    first.slow    -> slow    : double<rad> -> second.slow
    first.far     -> far     : double<rad> -> second.far
    first.farther -> farther : double<rad> -> second.farther
  }
  composition { mu (first ; second ; n := n + 1 ; rounds ! n % 6 ; pulses ! n * 500) until n == 100 }
}
submodel Turn { out angle : double<rad>  angle = 1<rad/s> * time }
environment Bench for Main { turn : Turn  turn.angle -> angle  rounds -> _  pulses -> _ }
"""


def test_variables_and_whole_numbers_of_very_different_size_have_panels_of_their_own() -> None:
    """In no panel is the greatest value of a unit far above the least, for ports and for variables; the panels of a
    unit follow each other.
    """
    network = pipeline.build(SourceFile(name="shown.csp", text=COUNTS), read_source, alone=True).network
    assert network is not None
    files = pipeline.generate(network, read_source, level=1, traced=True, observed=True, probed=True)
    axes = drawn(simulate(network, files, probe_variables=True)).axes[1:]
    assert all(len(panel.get_yticks()) > 2 for panel in axes)
    assert [curves_of(panel) for panel in axes] == [
        ["angle", "slow"],
        ["far"],
        ["farther"],
        ["rounds"],
        ["pulses"],
    ]


def test_coinciding_curves_differ_in_width() -> None:
    text = """
    process Main {
      in  a, b : double @ 10 ms
      communication { var p : double }
      composition { mu (a ? p ; b ? p) }
    }
    submodel Wave { out a, b : double  a = sin(3<1/s> * time)  b = sin(3<1/s> * time) }
    environment Bench for Main { wave : Wave  wave.a -> a  wave.b -> b }
    """
    (axes,) = shown_run(text).axes
    below, above = axes.lines
    assert below.get_linewidth() > 2 * above.get_linewidth()


def test_what_only_runs_has_the_colour_of_no_mode() -> None:
    text = """
    process P { out o : int  communication { var n : int = 0 } composition { mu (o ! n ; n := n + 1 ; wait 100 ms) } }
    process Q { in i : int  communication { var n : int = 0 } composition { mu (busy: (i ? n ; wait 30 ms)) } }
    process Main { communication { p : P  q : Q  p.o -> q.i } composition { p || q } }
    environment Bench for Main { }
    """
    axes = lanes_of(shown_run(text))
    legend = axes.get_legend()
    assert legend is not None
    reported = {patch.get_facecolor() for patch in legend.get_patches()}
    plain = {bar.get_facecolor() for bar in axes.patches if isinstance(bar, Rectangle) and bar.get_y() < 1}
    assert plain
    assert not plain & reported


def test_the_only_sample_at_the_end_is_not_cut_off() -> None:
    text = """
    process Main { in x : double @ 10 ms  communication { var p : double } composition { x ? p } }
    submodel One { out x : double  x = 0.06 }
    environment Bench for Main { one : One  one.x -> x }
    """
    (axes,) = shown_run(text).axes
    assert [line.get_clip_on() for line in axes.lines if line.get_marker() == "o"] == [False]
