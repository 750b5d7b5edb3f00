"""The Python interface."""

from __future__ import annotations

import shutil
import struct
from pathlib import Path

import pytest

import cspdiag
from cspdiag.api import ProgramError
from cspdiag.model.types import RealType
from cspdiag.network.lower.program import SelectionError
from cspdiag.settings import SettingError, parse_duration, split_setting
from tests.support.counting import lines

JIWY = Path(__file__).parents[2] / "models/jiwy/jiwy.csp"
NETWORKS = Path(__file__).parents[2] / "benchmarks/networks"


@pytest.fixture
def broken(tmp_path: Path) -> Path:
    path = tmp_path / "broken.csp"
    path.write_text("process A {\n  composition { nobody }\n}\n")
    return path


def test_a_program_is_loaded_checked_and_compiled() -> None:
    program = cspdiag.load(JIWY)
    assert program.check() == []
    assert program.network.top == "Jiwy"
    assert program.compile() == cspdiag.compile(str(JIWY))
    assert "jiwy/network.py" in program.compile()


def test_a_program_runs_with_settings() -> None:
    program = cspdiag.load(JIWY)
    run = program.run(environment="Bench", until="50 ms", set={"Tsv": "2 ms", "pan.inertia": 2e-3})
    assert run.outcome.time == 50_000_000
    instants = run.time("feedback_vertical")
    assert len(instants) == 25
    assert instants[1] - instants[0] == pytest.approx(0.002)
    assert len(program.run(until="50 ms").time("feedback_vertical")) == 50


def test_a_large_array_is_checked_by_fewer_elements_and_built_with_all() -> None:
    text = (NETWORKS / "ring.csp").read_text(encoding="utf-8")
    small, large = (cspdiag.parse(text.replace("size = 1000", f"size = {size}")) for size in (400, 4000))
    few, many = (lines(program.check) for program in (small, large))
    assert many < 2 * few
    assert large.check() == []
    assert len(small.network.instances) > 400


def test_errors_are_reported(broken: Path) -> None:
    (diagnostic,) = cspdiag.check(broken)
    assert diagnostic.code == "E0204"
    with pytest.raises(ProgramError, match="nobody") as raised:
        cspdiag.compile(broken)
    assert raised.value.diagnostics == [diagnostic]


def test_what_does_not_exist_is_refused(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        cspdiag.load(tmp_path / "missing.csp")
    program = cspdiag.load(JIWY)
    with pytest.raises(SelectionError, match="Nowhere"):
        program.run(environment="Nowhere")
    for setting in ("Nothing", "pan.nothing", "nobody.inertia"):
        with pytest.raises(SettingError, match=setting):
            program.run(set={setting: 1})
    with pytest.raises(SettingError, match="Tsv"):
        program.run(set={"Tsv": "fast"})


def test_settings_are_names_and_values() -> None:
    assert split_setting(" Tsh = 10 ms ") == ("Tsh", "10 ms")
    for text in ("Tsh", "=1", "Tsh=", ""):
        with pytest.raises(SettingError, match="NAME=VALUE"):
            split_setting(text)
    assert parse_duration("1.5 ms") == 1_500_000
    with pytest.raises(SettingError):
        parse_duration("soon")


def test_a_run_is_accessed_by_name() -> None:
    run = cspdiag.load(JIWY).run(until=0.05)
    assert repr(run) == "<Run of Jiwy in Bench: reached the time limit at 50 ms>"
    assert "feedback_vertical" in run
    assert 0 not in run
    assert list(run)[:2] == ["joystick_horizontal", "joystick_vertical"]


def test_a_diagnostic_is_shown_as_one_line(broken: Path) -> None:
    (diagnostic,) = cspdiag.check(broken)
    assert str(diagnostic) == f"{broken}:2:17: there is no instance `nobody`"
    assert repr(diagnostic) == f"<E0204 {diagnostic}>"
    assert repr(diagnostic.span.source) == f"SourceFile({str(broken)!r})"


def test_truth_values_are_set_as_python_has_them(tmp_path: Path) -> None:
    path = tmp_path / "wait.csp"
    path.write_text("const long = false\nprocess A { composition { if long then wait 2 s else wait 1 s } }\n")
    path.write_text(path.read_text() + "environment E for A {}\n")
    program = cspdiag.load(path)
    assert program.run(set={"long": True}).outcome.time == 2_000_000_000
    assert program.run(set={"long": False}).outcome.time == 1_000_000_000


@pytest.mark.parametrize(
    ("arguments", "meant"),
    [
        ({"set": {"pna.inertia": 1}}, "pan.inertia"),
        ({"set": {"pan.inertai": 1}}, "pan.inertia"),
        ({"set": {"horizontal.alignl.speed": 1}}, "horizontal.alignL.speed"),
        ({"environment": "Bnch"}, "Bench"),
        ({"top": "Jwiy"}, "Jiwy"),
    ],
)
def test_near_names_are_offered(arguments: dict[str, object], meant: str) -> None:
    with pytest.raises(ValueError, match=f"did you mean .{meant}.\\?"):
        cspdiag.load(JIWY).build(**arguments)


def test_an_unknown_target_is_named() -> None:
    with pytest.raises(ValueError, match="unknown target 'folder'"):
        cspdiag.load(JIWY).compile("folder")


@pytest.mark.skipif(not any(map(shutil.which, ("cc", "gcc", "clang"))), reason="no C compiler: install gcc or clang")
def test_every_target_and_level_runs_the_same() -> None:
    program = cspdiag.load(JIWY.parents[1] / "watchdog/watchdog.csp")
    runs = [program.run(until=3, target=target, level=level) for target in ("python", "c") for level in (0, 1)]
    assert len(runs[0].communications) > 10
    for run in runs[1:]:
        assert [c[:3] for c in run.communications] == [c[:3] for c in runs[0].communications]


def test_the_reference_runs_the_same() -> None:
    program = cspdiag.load(JIWY)
    meaning = program.run(until="50 ms", level="reference", set={"Tsh": "10 ms"})
    assert len(meaning.communications) > 10
    expected = program.run(until="50 ms", level=0, set={"Tsh": "10 ms"})
    assert [c[:3] for c in meaning.communications] == [c[:3] for c in expected.communications]
    assert meaning.outcome.ended == expected.outcome.ended


def test_the_reference_refuses_what_it_says_nothing_of() -> None:
    program = cspdiag.load(JIWY)
    for other in ({"target": "c"}, {"real_time": True}):
        with pytest.raises(
            cspdiag.ArgumentError, match="the reference semantics is not a target, and has virtual time only"
        ):
            program.run(level="reference", **other)
    text = 'process P python "p.py:P" {}\nprocess Top { communication { p : P } composition { p } }\n'
    with pytest.raises(cspdiag.NoMeaningError, match=r"cannot run `p\.py:P`"):
        cspdiag.parse(text).run(level="reference")


def test_what_cannot_run_is_named() -> None:
    with pytest.raises(ValueError, match="no optimization level 2"):
        cspdiag.load(JIWY).run(level=2)
    with pytest.raises(ValueError, match="the target 'rust' cannot be run"):
        cspdiag.load(JIWY).run(target="rust")


def test_a_program_is_verified() -> None:
    program = cspdiag.load(JIWY)
    assert [(answer.question.text, answer.outcome) for answer in program.verify()] == [
        ("Jiwy deadlock free", "proved"),
        ("Jiwy livelock free", "proved"),
        ("Jiwy schedulable", "proved"),
    ]
    refuted, _ = cspdiag.load(JIWY.parents[1] / "dining" / "deadlock.csp").verify(set={"seats": 2})
    assert refuted.outcome == "refuted"
    assert refuted.counterexample is not None
    assert len(refuted.counterexample.waiting) == 4


def test_a_program_with_errors_is_not_verified(broken: Path) -> None:
    with pytest.raises(ProgramError):
        cspdiag.load(broken).verify()


def test_timing_and_margins_are_objects() -> None:
    program = cspdiag.load(JIWY)
    report = program.timing()
    assert report.is_schedulable is True
    slow = program.timing(measured={"Jiwy.vertical.homing.servo": 2e-3})
    assert slow.is_schedulable is None  # it may never reach homing
    beside = program.timing(kernel=20e-6)
    assert beside.kernel == 20_000
    assert beside.utilization > report.utilization
    found = program.margins(set={"Tsh": "10 ms", "Tsv": "10 ms"})
    assert {loop.margins.is_stable for loop in found.loops if "servo" in loop.opened.cut.name} == {False}


def test_a_program_computes_in_single_precision() -> None:
    program = cspdiag.load("models/jiwy/jiwy.csp", real="float32")
    run = program.run(until=0.05)
    reals = {port.type.bits for port in program.network.external_ports if isinstance(port.type, RealType)}
    assert reals == {32}
    angles = run["feedback_horizontal"]
    assert all(float(angle) == struct.unpack("f", struct.pack("f", float(angle)))[0] for angle in angles)


def test_an_unknown_precision_is_refused() -> None:
    with pytest.raises(cspdiag.ArgumentError, match="float32"):
        cspdiag.load("models/jiwy/jiwy.csp", real="float")  # type: ignore[arg-type]
