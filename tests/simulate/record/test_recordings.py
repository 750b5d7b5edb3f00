"""Recordings, traces and the result of a run."""

from __future__ import annotations

import contextlib
import csv
import io
import json
import os
import subprocess
from array import array
from pathlib import Path

import numpy
import pytest

import cspdiag
from cspdiag.base.files.whole import write_whole
from cspdiag.model.types import INT
from cspdiag.simulate.record.chrome_trace import chrome_trace_text
from cspdiag.simulate.record.files import csv_parts, plain_trace_text
from cspdiag.simulate.record.held import Column, held_rows
from cspdiag.simulate.record.history import History
from cspdiag.simulate.result import Run


@pytest.fixture
def run(heater: Path) -> Run:
    return cspdiag.load(str(heater)).run("Bench", until="2 s")


def test_run_ends_when_the_program_ends(run: Run) -> None:
    assert run.outcome.ended == "terminated"
    # The button changes at the first grid instant after 400 ms; 25 ms of cooling follow, and the log listens until 480
    # ms.
    assert run.outcome.time == 480_000_000


def test_signals_are_arrays_by_the_names_of_the_ports(run: Run) -> None:
    assert list(run.signals)[:3] == ["temperature", "button", "power"]
    assert run.time("temperature")[:3] == pytest.approx([0.01, 0.02, 0.03])
    assert run["button"].tolist() == [1]
    assert run.time("button").tolist() == pytest.approx([0.405])
    with pytest.raises(KeyError, match="there are: temperature, button, power"):
        run["temprature"]


def test_output_reaches_the_plant_one_period_later(run: Run) -> None:
    assert run["power"][0] == 50.0
    assert run.time("power")[0] == pytest.approx(0.02)


def test_closed_loop_follows_the_differential_equation(run: Run) -> None:
    # From 20 ms on the chamber is driven by 50 W: t = 290 + 1000 (1 - exp(-(time - 0.02)/1 s)).
    time, temperature = run.time("temperature"), run["temperature"]
    heating = (time > 0.02) & (temperature < 309)
    expected = 290 + 1000 * (1 - numpy.exp(-(time[heating] - 0.02)))
    assert heating.sum() >= 1
    assert temperature[heating] == pytest.approx(expected, rel=1e-9)


def test_recording_holds_values_between_communications(run: Run) -> None:
    rows = list(csv.DictReader(io.StringIO("".join(csv_parts(run)))))
    assert list(rows[0]) == ["time", "temperature", "button", "power"]
    assert rows[0]["time"] == "0.01"
    assert rows[0]["power"] == ""
    assert float(rows[1]["power"]) == 50.0
    pressed = [row for row in rows if row["button"]]
    assert float(pressed[0]["time"]) == pytest.approx(0.405)
    assert len({row["time"] for row in rows}) == len(rows)


def test_plain_trace_has_every_communication_in_order(run: Run) -> None:
    events = [json.loads(line) for line in plain_trace_text(run).splitlines()]
    assert [event["t"] for event in events] == sorted(event["t"] for event in events)
    assert events[0] == {"t": 10_000_000, "channel": "Oven.temperature", "value": 290.0}
    assert {"t": 10_000_000, "channel": "Oven.demand", "value": "high"} in events
    assert not any(event["channel"].endswith(".now") for event in events)


def test_safe_values_are_recorded_but_are_no_communications(heater: Path) -> None:
    run = cspdiag.load(str(heater)).run(until="100 ms")
    assert run["power"][-1] == 0.0
    assert run.time("power")[-1] == pytest.approx(0.1)
    assert "".join(csv_parts(run)).splitlines()[-1].endswith(",0.0")
    last = [event.value for event in run.events if event.channel == "Oven.power"][-1]
    assert last == 5.0


def test_two_runs_give_the_same_trace(run: Run, heater: Path) -> None:
    again = cspdiag.load(str(heater)).run("Bench", until="2 s")
    assert plain_trace_text(run) == plain_trace_text(again)


def test_an_archive_has_instants_and_values(run: Run, tmp_path: Path) -> None:
    run.to_npz(tmp_path / "out.npz")
    with numpy.load(tmp_path / "out.npz") as archive:
        assert set(archive) == {name + tail for name in ("temperature", "button", "power") for tail in ("", ".time")}
        assert archive["power"].tolist() == run["power"].tolist()
        assert archive["power.time"].tolist() == run.time("power").tolist()


def test_an_archive_can_be_written_to_a_device_and_into_a_pipe(run: Run, tmp_path: Path) -> None:
    (tmp_path / "nothing.npz").symlink_to("/dev/null")
    run.to_npz(tmp_path / "nothing.npz")
    assert (tmp_path / "nothing.npz").is_symlink()

    os.mkfifo(tmp_path / "pipe.npz")
    with subprocess.Popen(["cat", tmp_path / "pipe.npz"], stdout=subprocess.PIPE) as reader:
        while True:
            with contextlib.suppress(cspdiag.FileError):  # Nobody reads from it yet.
                run.to_npz(tmp_path / "pipe.npz")
                break
            assert reader.poll() is None
        written, _ = reader.communicate(timeout=20)
    run.to_npz(tmp_path / "file.npz")
    with numpy.load(tmp_path / "file.npz") as archive, numpy.load(io.BytesIO(written)) as piped:
        assert [(name, value.tolist()) for name, value in piped.items()] == [
            (name, value.tolist()) for name, value in archive.items()
        ]


def test_a_table_that_is_written_in_parts_is_the_same(run: Run, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = list(csv_parts(run))
    monkeypatch.setattr("cspdiag.simulate.record.held._ROWS", 3)
    parts = list(csv_parts(run))
    assert len(parts) > len(whole) + 5
    assert "".join(parts) == "".join(whole)


def test_values_of_one_instant_are_in_one_row_however_many(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("cspdiag.simulate.record.held._ROWS", 3)
    few, many = (
        History(array("q", times), list(map(str, times)), array("q")) for times in ([0, 7], [5, 5, 5, 5, 5, 9])
    )
    columns = [Column(name, name, INT, (), lambda values, _: values) for name in ("few", "many", "never")]
    parts = list(held_rows({"few": few, "many": many}, columns, "-"))
    assert [instant for instants, _ in parts for instant in instants] == [0, 5, 7, 9]
    joined = [[cell for _, cells in parts for cell in cells[position]] for position in range(3)]
    assert joined == [["0", "0", "7", "7"], ["-", "5", "5", "9"], ["-", "-", "-", "-"]]


def test_chrome_trace_has_tracks_flows_and_counters(run: Run) -> None:
    events = json.loads(chrome_trace_text(run))["traceEvents"]
    tracks = {event["args"]["name"]: event["tid"] for event in events if event["name"] == "thread_name"}
    assert {"Oven", "Oven.heat", "Oven.log", "Oven.cool", "Oven.work"} <= set(tracks)
    starts = {event["id"]: event for event in events if event["ph"] == "s"}
    finishes = {event["id"]: event for event in events if event["ph"] == "f"}
    assert starts.keys() == finishes.keys() != set()
    assert {event["tid"] for event in starts.values()} == {tracks["Oven.heat"]}
    assert {event["tid"] for event in finishes.values()} == {tracks["Oven.log"]}
    counters = {event["name"] for event in events if event["ph"] == "C"}
    assert counters == {"temperature", "button", "power"}
    heat = next(event for event in events if event["ph"] == "X" and event["tid"] == tracks["Oven.heat"])
    assert heat["dur"] == pytest.approx(405_000, abs=1)


def test_summary_says_when_each_mode_ended(run: Run) -> None:
    summary = run.summary()
    assert "Oven in Bench: ended by itself at 480 ms" in summary
    assert "work: heat until 405 ms, cool until 430 ms" in summary
    assert "missed samples: none" in summary


def test_plot_shows_signals_and_modes(run: Run, tmp_path: Path) -> None:
    figure = run.plot(tmp_path / "out.svg")
    labels = {line.get_label() for axes in figure.axes for line in axes.lines}
    assert {"temperature", "power"} <= labels
    texts = {text.get_text() for axes in figure.axes for text in axes.texts}
    beside = {text.get_text() for axes in figure.axes if axes.get_legend() for text in axes.get_legend().get_texts()}
    assert "heat" in texts
    assert "cool" in texts | beside
    assert (tmp_path / "out.svg").read_text().startswith("<?xml")
    assert "<svg" in run._repr_svg_()


def test_file_that_cannot_be_written_leaves_nothing(tmp_path: Path) -> None:
    target = tmp_path / "out"
    target.mkdir()
    with pytest.raises(OSError, match="out"):
        write_whole(target, b"data")
    assert [path.name for path in tmp_path.iterdir()] == ["out"]


def test_time_limit_and_settings(heater: Path) -> None:
    run = cspdiag.load(str(heater)).run(until="100 ms", set={"chamber.ambient": "320<K>"})
    assert run.outcome.ended == "time limit"
    assert run["temperature"][0] == 320.0
    assert set(run["power"][:-1]) == {5.0}
