"""Recordings as tables of pandas and data sets of xarray."""

from __future__ import annotations

import builtins
import io
import sys
from pathlib import Path

import numpy
import pytest

import cspdiag

SHAPES = """
enum Mode { idle, moving }
struct Pose { x: double<m> y: double<m> }

process Main {
  out gyro  : double<rad/s>[2] @ 10 ms
  out pose  : Pose
  out mode  : Mode
  out ready : bool
  out count : int

  composition {
    gyro ! [1<rad/s>, 2<rad/s>] ; wait 15 ms ;
    pose ! Pose(x = 3<m>, y = 4<m>) ; mode ! Mode.moving ; wait 10 ms ;
    ready ! true ; count ! 7 ; wait 10 ms
  }
}

environment Bench for Main {
  gyro -> _
  pose -> _
  mode -> _
  ready -> _
  count -> _
}
"""

JIWY = Path(__file__).parents[3] / "models/jiwy/jiwy.csp"


@pytest.fixture(scope="module")
def run() -> cspdiag.Run:
    return cspdiag.load(JIWY).run(until=0.5)


def test_a_table_is_what_the_recording_is(run: cspdiag.Run, tmp_path: Path) -> None:
    pandas = pytest.importorskip("pandas")
    frame = run.to_dataframe()
    run.to_csv(tmp_path / "run.csv")
    written = pandas.read_csv(io.StringIO((tmp_path / "run.csv").read_text()), index_col="time")
    assert list(frame.columns) == list(written.columns)
    assert frame.index.equals(written.index)
    for name in frame.columns:
        numpy.testing.assert_array_equal(frame[name].astype("float64"), written[name].astype("float64"))


def test_a_table_says_units_and_periods(run: cspdiag.Run) -> None:
    pytest.importorskip("pandas")
    frame = run.to_dataframe()
    assert frame.attrs["units"]["time"] == "s"
    assert frame.attrs["units"]["feedback_vertical"] == "rad"
    assert frame.attrs["periods"]["feedback_vertical"] == 0.001
    assert frame.attrs["periods"]["feedback_horizontal"] == 0.002
    assert "joystick_buttons" not in frame.attrs["periods"]
    assert (frame.attrs["process"], frame.attrs["environment"]) == ("Jiwy", "Bench")


def test_a_data_set_has_the_same_values(run: cspdiag.Run) -> None:
    pytest.importorskip("pandas")
    pytest.importorskip("xarray")
    data, frame = run.to_xarray(), run.to_dataframe()
    assert set(data.data_vars) == set(frame.columns)
    for name in frame.columns:
        numpy.testing.assert_array_equal(data[name].values.astype(float), frame[name].astype("float64"))
    assert data["time"].attrs["units"] == "s"
    assert data["control_vertical"].attrs == {"type": "double<V>", "units": "V", "period": 0.001}


def test_signals_are_chosen_by_name(heater: Path) -> None:
    pytest.importorskip("pandas")
    pytest.importorskip("xarray")
    run = cspdiag.load(heater).run(until=0.3)
    frame = run.to_dataframe(["Oven.demand", "power"])
    assert list(frame.columns) == ["Oven.demand", "power"]
    assert frame["Oven.demand"].dropna().iloc[0] == "high"
    assert list(run.to_xarray("power").data_vars) == ["power"]
    for make in (run.to_dataframe, run.to_xarray):
        with pytest.raises(cspdiag.UnknownSignalError, match="no signal 'powr'"):
            make(["powr"])


def test_every_type_can_represent_missing_values() -> None:
    pandas = pytest.importorskip("pandas")
    pytest.importorskip("xarray")
    run = cspdiag.parse(SHAPES).run()
    frame, data = run.to_dataframe(), run.to_xarray()
    assert list(frame.columns) == ["gyro[0]", "gyro[1]", "pose.x", "pose.y", "mode", "ready", "count"]
    # In the last row outputs have their safe values.
    first, last = frame.iloc[0], frame.iloc[-2]
    assert [last[name] for name in frame.columns][2:] == [3.0, 4.0, "moving", True, 7]
    assert all(pandas.isna(first[name]) for name in frame.columns[2:])
    assert [str(kind) for kind in frame.dtypes[2:]] == ["float64", "float64", "category", "boolean", "Int64"]
    assert frame.attrs["units"]["gyro[1]"] == "rad/s"
    assert data["gyro"].dims == ("time", "gyro_0")
    numpy.testing.assert_array_equal(data["gyro"].values[:, 1], frame["gyro[1]"])
    assert data["gyro"].attrs["units"] == "rad/s"
    assert data["gyro"].attrs["period"] == 0.01
    assert data["mode"].attrs["flag_meanings"].split()[int(data["mode"].values[-2])] == "moving"
    assert numpy.isnan(data["count"].values[0])


def test_a_run_in_which_nothing_passed_is_an_empty_table() -> None:
    pytest.importorskip("pandas")
    pytest.importorskip("xarray")
    run = cspdiag.parse(SHAPES.replace("gyro ! [1<rad/s>, 2<rad/s>] ;", "")).run(until="1 ms")
    assert len(run.to_dataframe()) == 0
    assert run.to_xarray()["gyro"].shape == (0, 2)


@pytest.mark.parametrize(("make", "package"), [("to_dataframe", "pandas"), ("to_xarray", "xarray")])
def test_a_missing_package_is_named_with_its_extra(
    run: cspdiag.Run, make: str, package: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(ImportError, match=rf"this needs {package}: pip install 'cspdiag\[{package}\]'") as raised:
        getattr(run, make)()
    assert isinstance(raised.value, cspdiag.CspdiagError)
    assert package in (Path(__file__).parents[3] / "pyproject.toml").read_text().partition("dev = [")[0]


def test_the_packages_are_imported_only_where_used(monkeypatch: pytest.MonkeyPatch) -> None:
    requested: list[str] = []
    original = builtins.__import__

    def noting(name: str, *rest: object, **more: object) -> object:
        requested.append(name.partition(".")[0])
        return original(name, *rest, **more)

    monkeypatch.setattr(builtins, "__import__", noting)
    cspdiag.load(JIWY).run(until=0.01)["control_vertical"]
    assert not {"pandas", "xarray"} & set(requested)
