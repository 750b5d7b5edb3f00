"""Programs and environments as FMUs, in a simulator of another make (fmpy)."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from cspdiag.cli.main import main
from tests.simulate.native.fmu.master import Instance, together

pytest.importorskip("fmpy")

JIWY = "models/jiwy/jiwy.csp"
SLOW = ("--set", "Tsh=70 ms", "--set", "Tsv=70 ms")


@pytest.fixture(scope="module", autouse=True)
def quickly_compiled() -> Iterator[None]:
    """Without optimization, which makes no difference to values."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("CFLAGS", "-O0")
        yield


def exported(folder: Path, program: str | Path, *options: str) -> Path:
    """The FMU that cspdiag makes."""
    assert main(["compile", str(program), "--target", "fmu", "-O1", "-o", str(folder), *options]) == 0
    (made,) = folder.glob("*.fmu")
    return made


def handed_over(folder: Path, until: str, *options: str) -> dict[str, dict[int, Any]]:
    """What a run has handed over or sampled at the external ports, by port and instant in nanoseconds."""
    trace = folder / "trace.jsonl"
    assert main(["run", JIWY, "-O1", "--for", until, "--trace", str(trace), *options]) == 0
    found: dict[str, dict[int, Any]] = {}
    for row in map(json.loads, trace.read_text().splitlines()):
        name = row["channel"].removeprefix("Jiwy.")
        if "." not in name:
            found.setdefault(name, {})[row["t"]] = row["value"]
    return found


def differences(
    program: Path, plant: Path, expected: dict[str, dict[int, Any]], until: float, step: float, **options: bool
) -> tuple[list[str], int]:
    """Where the FMUs differ from a run, and how many values were compared: outputs of the program with what was handed
    over last, inputs with what was sampled.
    """
    found: list[str] = []
    compared = 0
    held: dict[str, Any] = dict.fromkeys(("control_horizontal", "control_vertical"), 0.0)
    pending = {name: sorted(expected[name].items(), reverse=True) for name in held}
    folder = program.parent
    with Instance(program, folder / "program", **options) as one, Instance(plant, folder / "plant") as other:
        for time, values in together(one, other, until, step):
            instant = round(time * 1e9)
            for name, changes in pending.items():
                while changes and changes[-1][0] <= instant:
                    held[name] = changes.pop()[1]
            sampled = {name: at[instant] for name, at in expected.items() if name not in held and instant in at}
            for name, value in {**held, **sampled}.items():
                compared += 1
                if values[name] != value:
                    found.append(f"{instant} {name}: {values[name]!r} instead of {value!r}")
    return found, compared


@pytest.fixture(scope="module")
def programs(tmp_path_factory: pytest.TempPathFactory) -> dict[str, tuple[Path, Path]]:
    """JIWY's controller and its plant, by version of FMI."""
    made = {}
    for fmi in ("2.0", "3.0"):
        folder = tmp_path_factory.mktemp(f"jiwy{fmi}")
        program = exported(folder / "program", JIWY, "--fmi", fmi)
        made[fmi] = program, exported(folder / "plant", JIWY, "--fmi", fmi, "--environment", "Bench")
    return made


def test_controller_and_plant_give_the_bits_of_a_run(programs: dict[str, tuple[Path, Path]], tmp_path: Path) -> None:
    """All of it: alignment, motion, the stop button, homing, the end."""
    expected = handed_over(tmp_path, "12.77 s")
    assert expected["joystick_buttons"]
    found, compared = differences(*programs["2.0"], expected, 12.77, 1e-3)
    assert (found, compared) == ([], compared)
    assert compared > 40_000


STEPS = [1e-3, 2e-3, 5e-3, 7e-3, 10e-3]
"""Seconds: the shortest period of JIWY, and longer ones; all divide the periods of `slow`."""


@pytest.fixture(scope="module")
def expected(tmp_path_factory: pytest.TempPathFactory) -> dict[str, dict[int, Any]]:
    """What a run hands over and samples."""
    return handed_over(tmp_path_factory.mktemp("run"), "2.1 s")


@pytest.mark.parametrize("step", STEPS)
def test_early_return_makes_results_independent_of_the_steps(
    programs: dict[str, tuple[Path, Path]], expected: dict[str, dict[int, Any]], step: float
) -> None:
    found, compared = differences(*programs["3.0"], expected, 2.1, step, early=True)
    assert found == []
    assert compared > 6_000


@pytest.fixture(scope="module")
def slow(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path, dict[str, dict[int, Any]]]:
    """The same with sample periods that all steps divide, and what its run hands over and samples."""
    folder = tmp_path_factory.mktemp("slow")
    program = exported(folder / "program", JIWY, *SLOW)
    plant = exported(folder / "plant", JIWY, *SLOW, "--environment", "Bench")
    return program, plant, handed_over(folder, "2.8 s", *SLOW)


@pytest.mark.parametrize("step", STEPS)
def test_steps_that_divide_the_periods_make_no_difference(
    slow: tuple[Path, Path, dict[str, dict[int, Any]]], step: float
) -> None:
    found, compared = differences(*slow, 2.8, step)
    assert found == []
    assert compared > 500


DESK = "tests/simulate/native/fmu/desk.csp"


@pytest.fixture(scope="module", params=["2.0", "3.0"])
def desk(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A program with ports of all types."""
    return exported(tmp_path_factory.mktemp("desk"), DESK, "--fmi", request.param)


def ready(path: Path, folder: Path, **options: bool) -> Instance:
    """An instance at time 0, with inputs."""
    instance = Instance(path, folder / "desk", **options)
    set_up(instance)
    instance.begin()
    return instance


def set_up(instance: Instance, fmu: Any = None) -> None:
    for name, value in {"pose.height": 0.7, "mode": 3, "limits[0]": 0.2, "limits[1]": 0.5, "weight": 9}.items():
        instance.set(name, value, fmu)


def test_fmpy_finds_nothing_to_complain_about(desk: Path, programs: dict[str, tuple[Path, Path]]) -> None:
    from fmpy.validation import validate_fmu

    for path in (desk, *programs["2.0"], *programs["3.0"]):
        assert validate_fmu(str(path)) == []


def test_fmpy_simulates_it(desk: Path) -> None:
    import fmpy

    start = {"pose.height": 0.7, "mode": 3, "limits[0]": 0.2, "limits[1]": 0.5, "weight": 9}
    result = fmpy.simulate_fmu(str(desk), stop_time=0.02, output_interval=1e-3, start_values=start)
    assert list(result["drive"][[0, 3, 4, 20]]) == [0.0, 0.0, 2.5, 2.5]
    assert list(result["shown"][[3, 4]]) == [1, 3]


def test_values_of_all_types(desk: Path, tmp_path: Path) -> None:
    with ready(desk, tmp_path) as one:
        one.set("button", True)
        one.set("delay", 0.25)
        one.set("feet[1,1]", 400.0)
        one.step(0.0, 0.01)
        lamps = {"lamp[0]": False, "lamp[1]": True}
        assert one.outputs() == {"drive": 2.5, "shown": 3, **lamps, "total": 1, "kept": True}
        assert (one.get("delay"), one.get("weight"), one.get("time")) == (0.25, 9, 0.01)


def test_a_value_out_of_range_is_refused_with_the_name(desk: Path, tmp_path: Path) -> None:
    with ready(desk, tmp_path) as one:
        for name, value in (("mode", 4), ("drive", 1.0)):
            with pytest.raises(Exception, match="status 3"):
                one.set(name, value)
            assert name in one.messages[-1]
        assert one.get("mode") == 3


def test_an_event_is_a_change_or_a_count_or_a_clock(desk: Path, tmp_path: Path) -> None:
    with ready(desk, tmp_path, events=True) as one:
        fmu = one.fmu

        def update() -> float:
            again = True
            while again:
                again, _, _, _, defined, at = fmu.updateDiscreteStates()
            fmu.enterStepMode()
            return float(at) if defined else -1.0

        if one.is_new:
            assert update() == 0.002
        one.step(0.0, 0.004)
        assert one.get("total") == 0
        one.set("button", True)
        one.step(0.004, 0.004)
        assert one.get("total") == 1
        if one.is_new:
            fmu.enterEventMode()
            fmu.setClock([one.variables["button.clock"].valueReference], [True])
            again = fmu.updateDiscreteStates()[0]
            assert again
            assert fmu.getClock([one.variables["total.clock"].valueReference]) == [True]
            update()
            assert one.get("total") == 2
        else:
            one.set("button.count", 1)
            one.step(0.008, 0.004)
            assert (one.get("total"), one.get("total.count")) == (2, 2)


def test_several_instances_reset_and_termination(desk: Path, tmp_path: Path) -> None:
    with ready(desk, tmp_path) as one:
        other = one.instance("other")
        set_up(one, other)
        one.set("weight", 17, other)
        one.begin(other)
        for step in range(4):
            one.step(step * 0.002, 0.002)
            one.step(step * 0.002, 0.002, other)
        assert (one.get("drive"), one.get("drive", other)) == (2.5, 0.5)
        one.fmu.terminate()
        assert (one.get("drive"), one.get("drive", other)) == (-1.0, 0.5)
        one.fmu.reset()
        set_up(one)
        one.begin()
        assert one.get("drive") == 0.0
        one.step(0.0, 0.006)
        assert one.get("drive") == 2.5
        other.freeInstance()


def test_a_fault_is_an_error_with_its_text_and_safe_values(desk: Path, tmp_path: Path) -> None:
    with ready(desk, tmp_path) as one:
        one.step(0.0, 0.006)
        one.set("weight", 7)
        with pytest.raises(Exception, match="status 3"):
            one.step(0.006, 0.006)
        assert "division by zero, in Desk (desk.csp:" in one.messages[-1]
        assert one.get("drive") == -1.0
        with pytest.raises(Exception, match="status 3"):
            one.step(0.006, 0.006)
        assert "cannot be called while the instance is in an error" in one.messages[-1]


def test_what_does_not_fit_is_refused(desk: Path, tmp_path: Path) -> None:
    with ready(desk, tmp_path) as one:
        one.step(0.0, 0.004)
        with pytest.raises(Exception, match="status 3"):
            one.step(0.1, 0.002)
        assert one.messages[-1] == "a step of 0.002 s from 0.1 s is not possible: the instance is at 0.004 s"
        with pytest.raises(Exception, match="status 3"):
            one.step(0.004, -1.0)
        one.step(0.004, 0.002)


def test_steps_that_were_added_up_meet_their_ticks(desk: Path, tmp_path: Path) -> None:
    """The sum of many floating-point steps is beside the multiple; the next tick must not fall into the step before."""
    with ready(desk, tmp_path) as one:
        time = 0.0
        for step in range(1000):
            one.set("pose.height", 0.2 + 0.0001 * step)
            one.step(time, 1e-3)
            time += 1e-3
        assert time != 1.0
        # The sample of 0.998 s was the value set for the step from there.
        assert one.get("drive") == (0.2 + 0.0001 * 998) * 10 / 2


def test_a_state_can_be_taken_set_and_made_bytes(desk: Path, tmp_path: Path) -> None:
    with ready(desk, tmp_path) as one:
        state_names = ("getFMUState", "setFMUState") if one.is_new else ("getFMUstate", "setFMUstate")
        get, put = (getattr(one.fmu, name) for name in state_names)
        other = one.instance("other")
        one.begin(other)
        one.set("button", True)
        one.step(0.0, 0.004)
        state = get()
        bytes_ = one.fmu.serializeFMUState(state) if one.is_new else one.fmu.serializeFMUstate(state)
        finals = []
        for _ in range(2):
            one.set("button", False)
            one.step(0.004, 0.004)
            finals.append(one.outputs())
            one.set("pose.height", 0.3)
            one.step(0.008, 0.006)
            finals.append(one.outputs())
            put(state)
            assert one.get("button") is True or one.get("button") == 1
        assert finals[:2] == finals[2:]
        assert finals[1]["total"] == 2
        read = other.deserializeFMUState if one.is_new else other.deSerializeFMUstate
        (other.setFMUState if one.is_new else other.setFMUstate)(read(bytes_))
        one.set("button", False, other)
        one.step(0.004, 0.004, other)
        assert one.outputs(other) == finals[0]
        other.freeInstance()


@pytest.mark.parametrize(
    ("environment", "reported"),
    [
        ("Hand", "the environment has the device `Level`, which an FMU cannot open"),
        ("Other", "the environment has an FMU, which cannot be in another FMU"),
    ],
)
def test_an_environment_with_devices_or_fmus_is_refused(
    environment: str, reported: str, desk: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "show.csp").write_text(
        "process Show {\n  in shown : int @ 2 ms\n  communication { var x : int }\n"
        "  composition { mu (shown ? x) }\n}\n"
        'driver Level python "hand.py:Level" { out shown : int }\n'
        f'submodel Model fmu "{desk}" {{ out shown : int }}\n'
        "environment Hand for Show {\n  level : Level\n  level.shown -> shown\n}\n"
        "environment Other for Show {\n  model : Model\n  model.shown -> shown\n}\n"
    )
    (tmp_path / "hand.py").write_text("class Level:\n    def read(self, port: str) -> int:\n        return 1\n")
    command = ["compile", str(tmp_path / "show.csp"), "--target", "fmu", "--environment", environment]
    assert main([*command, "-o", str(tmp_path / "build")]) == 1
    assert reported in capsys.readouterr().err
    assert not (tmp_path / "build").exists()
