"""``cspdiag verify --timing``, with its picture, its measured times, and what it refuses."""

from __future__ import annotations

import json
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest

from tests.analyses.timing.programs import loops_of
from tests.cli.conftest import Command
from tests.models.programs import MODELS

JIWY = MODELS / "jiwy" / "jiwy.csp"


@pytest.fixture(autouse=True)
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A cache of answers that is not shared with other tests."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))


@pytest.fixture
def late(tmp_path: Path) -> Path:
    path = tmp_path / "late.csp"
    path.write_text(
        loops_of(("a", "1 ms", "600 us"), ("b", "10 ms", "900 us"), order="||>") + "assert Main schedulable\n"
    )
    return path


@pytest.fixture
def silent(tmp_path: Path) -> Path:
    path = tmp_path / "silent.csp"
    path.write_text(loops_of(("a", "1 ms", None), ("b", "10 ms", "900 us")) + "assert Main schedulable\n")
    return path


def test_jiwy_is_schedulable(cspdiag: Command) -> None:
    result = cspdiag("verify", "--timing", JIWY)
    assert result.code == 0
    assert result.out.startswith("SCHEDULABLE: Jiwy: all 8 sampled loops are ready before their next samples\n")
    (servo,) = [line for line in result.out.splitlines() if line.startswith("vertical.motionControl.servo  ")]
    figures = "1 ms 60 us 6.0 % 60 us 0 120 us 880 us 1 ms 0 control_vertical"
    assert " ".join(servo.split()) == f"vertical.motionControl.servo {figures}"


def test_a_late_loop_is_reported_with_advice(cspdiag: Command, late: Path) -> None:
    result = cspdiag("verify", "--timing", late)
    assert result.code == 1
    assert result.out.startswith(
        "NOT SCHEDULABLE: Main: `a` is late: when every law takes its longest time, the sample of t = 11 ms is ready "
        "at t = 12.1 ms\n"
    )
    assert "no order of priorities is known that meets every deadline with these steps" in result.out


def test_a_process_that_states_no_time_is_named(cspdiag: Command, tmp_path: Path) -> None:
    path = tmp_path / "counting.csp"
    path.write_text(
        "process Main {\n  in  x : double @ 1 ms\n  out y : double @ 1 ms\n"
        "  communication { var n : int = 0  var v : double = 0 }\n"
        "  composition { mu (x ? v ; n := 0 ; (while n < 1000 do n := n + 1) ; y ! v) }\n}\n"
    )
    said = "what `Main` computes counts as zero: a process states its time by `wcet`"
    assert said in cspdiag("verify", "--timing", path).out
    path.write_text(path.read_text().replace("Main {", "Main wcet 100 us {"))
    assert "counts as zero" not in cspdiag("verify", "--timing", path).out


def test_json_has_all_figures_in_nanoseconds(cspdiag: Command, late: Path) -> None:
    result = cspdiag("verify", "--timing", "--format", "json", late)
    assert result.code == 1
    report = json.loads(result.out)
    assert report["schedulable"] is False
    (loop,) = [loop for loop in report["loops"] if loop["name"] == "a"]
    assert (loop["response"], loop["slack"], loop["met"], loop["latency"]) == (
        1_499_999,
        -499_999,
        False,
        [1_000_000, 2_000_000],
    )


def test_missing_times_are_named_with_their_place_and_the_way_to_write_them(cspdiag: Command, silent: Path) -> None:
    result = cspdiag("verify", "--timing", silent)
    assert result.code == 1
    assert "REFUSED: Main: `Main.a` does not say its worst-case execution time" in result.out
    assert f"--> {silent}:1:10" in result.out
    assert "`submodel Law_a(...) wcet 100 us {`" in result.out


def test_measured_times_are_taken_from_a_trace(cspdiag: Command, silent: Path, tmp_path: Path) -> None:
    trace = tmp_path / "trace.json"
    trace.write_text(
        json.dumps({"traceEvents": [], "executionTimes": {"Main.a": {"longest": 12.5e-6, "steps": 9, "what": "law"}}})
    )
    result = cspdiag("verify", "--timing", "--format", "json", "--wcet-from", trace, silent)
    assert result.code == 0, result
    report = json.loads(result.out)
    assert {loop["name"]: loop["work"] for loop in report["loops"]} == {"a": 12_500, "b": 900_000}
    assert report["measured"] == ["Main.a"]
    assert cspdiag("verify", "--format", "json", "--wcet-from", trace, silent) == result


def test_the_time_of_the_kernel_comes_before_every_process(cspdiag: Command, silent: Path, tmp_path: Path) -> None:
    trace = tmp_path / "times.json"
    trace.write_text(json.dumps({"executionTimes": {"Main.a": 100e-6}, "kernelTime": 20e-6}))
    result = cspdiag("verify", "--timing", "--format", "json", "--wcet-from", trace, silent)
    report = json.loads(result.out)
    assert report["kernel"] == 20_000
    without = tmp_path / "without.json"
    without.write_text(json.dumps({"executionTimes": {"Main.a": 100e-6}}))
    faster = json.loads(cspdiag("verify", "--timing", "--format", "json", "--wcet-from", without, silent).out)
    responses = {loop["name"]: loop["response"] for loop in report["loops"]}
    assert all(responses[loop["name"]] >= loop["response"] + 20_000 for loop in faster["loops"])
    assert report["utilization"] == pytest.approx(faster["utilization"] + 0.02)
    shown = cspdiag("verify", "--timing", "--wcet-from", trace, silent).out
    assert "execution times of `Main.a` and of the kernel, 20 us at each instant, were measured" in shown


def test_measured_times_are_multiplied(cspdiag: Command, silent: Path, tmp_path: Path) -> None:
    trace = tmp_path / "times.json"
    trace.write_text(json.dumps({"executionTimes": {"Main.a": 100e-6}, "kernelTime": 1.5e-6}))
    command = ("verify", "--format", "json", "--wcet-from", trace, "--wcet-factor", "1.1", silent)
    report = json.loads(cspdiag(*command).out)
    assert {loop["name"]: loop["work"] for loop in report["loops"]} == {"a": 110_000, "b": 900_000}
    assert report["kernel"] == 1_650
    alone = cspdiag("verify", "--timing", "--wcet-factor", "1.1", silent)
    assert (alone.code, alone.err.count("\n")) == (2, 1)
    assert "give them with --wcet-from FILE" in alone.err
    assert "expected 1 to 1000 times" in cspdiag("verify", "--wcet-from", trace, "--wcet-factor", "0.5", silent).err


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        ("{", "is not JSON (Expecting property name"),
        ("[" * 5000 + "]" * 5000, "is not JSON (nested too deeply)"),
        ("\x00\udcff", "is not text, so not JSON: write it with cspdiag run --real-time --target c --trace"),
        ("[]", "has no execution times"),
        ('{"traceEvents": []}', "has no execution times: write it with cspdiag run --real-time --target c"),
        ('{"executionTimes": {"Main.a": "fast"}}', "the execution time of Main.a is not a number of seconds"),
        (
            '{"executionTimes": {"Main.a": {"longest": 1e-6, "what": "thing"}}}',
            "is a law, a process or a thread, not 'thing'",
        ),
        ('{"executionTimes": {"Main.a": 1e-6}, "kernelTime": -1}', "`kernelTime` is not a number of seconds"),
        ('{"executionTimes": {"Other.law": 1e-6}}', "none of its names is a law of Main, a process that"),
    ],
)
def test_a_trace_without_times_is_refused(
    cspdiag: Command, silent: Path, tmp_path: Path, content: str, reason: str
) -> None:
    trace = tmp_path / "trace.json"
    trace.write_text(content, errors="surrogateescape")
    result = cspdiag("verify", "--timing", "--wcet-from", trace, silent)
    assert (result.code, result.out, result.err.count("\n")) == (2, "", 1)
    assert reason in result.err
    assert "Traceback" not in result.err


def test_files_may_have_spaces_in_their_names(cspdiag: Command, silent: Path, tmp_path: Path) -> None:
    folder = tmp_path / "my measured times"
    folder.mkdir()
    program, trace, picture = folder / "a loop.csp", folder / "a trace.json", folder / "a chart.svg"
    program.write_text(silent.read_text())
    trace.write_text(json.dumps({"executionTimes": {"Main.a": 12.5e-6}}))
    assert cspdiag("verify", "--timing", "--wcet-from", trace, "--gantt", picture, program).code == 0
    assert picture.exists()
    trace.write_text("{}")
    result = cspdiag("verify", "--wcet-from", trace, program)
    assert result.err.endswith(f"--trace '{trace}', or with -O0\n")


def test_a_missing_trace_is_reported_in_one_line(cspdiag: Command, silent: Path) -> None:
    result = cspdiag("verify", "--timing", "--wcet-from", "nowhere.json", silent)
    assert result == (2, "", "cspdiag: nowhere.json: no such file or directory\n")


def test_a_program_without_samples_needs_a_period(cspdiag: Command, tmp_path: Path) -> None:
    path = tmp_path / "events.csp"
    path.write_text(
        "process Main { in e : int out y : double communication { var k : int = 0 } composition { mu (e ? k ; y ! 1.0) "
        "} }"
    )
    result = cspdiag("verify", "--timing", path)
    assert result.code == 0
    assert result.out.splitlines() == [
        "SCHEDULABLE: Main: no loop follows a sample period",
        "  = help: give the inputs that `Main` samples a period, `in x : double @ 1 ms`",
    ]


def test_more_work_than_time_has_no_bound(cspdiag: Command, late: Path) -> None:
    late.write_text(late.read_text().replace("600 us", "1600 us"))
    result = cspdiag("verify", "--timing", late)
    assert result.code == 1
    assert "no bound" in result.out
    assert "more work than time: no order of priorities helps" in result.out


def test_the_schedule_is_drawn(cspdiag: Command, late: Path, tmp_path: Path) -> None:
    picture = tmp_path / "gantt.svg"
    result = cspdiag("verify", "--timing", "--gantt", picture, late)
    assert (result.code, result.err) == (1, f"wrote {picture}\n")
    assert cspdiag("verify", "--timing", "--gantt", picture, late, "--quiet").err == ""
    root = ElementTree.fromstring(picture.read_text())
    titles = [title.text or "" for title in root.iter("{http://www.w3.org/2000/svg}title")]
    assert len(titles) == 11
    assert any(title.startswith("a @ 1 ms: 1.5 ms to 2.1 ms") for title in titles)


def test_no_schedule_is_drawn_of_times_that_are_not_known(cspdiag: Command, silent: Path, tmp_path: Path) -> None:
    picture = tmp_path / "gantt.svg"
    result = cspdiag("verify", "--timing", "--gantt", picture, silent)
    assert result.code == 1
    assert result.err == f"cspdiag: not all execution times are known, so {picture} was not written\n"
    assert not picture.exists()


@pytest.mark.parametrize("name", ["gantt.txt", "nowhere/gantt.svg"])
def test_a_picture_that_cannot_be_written_is_refused_first(
    cspdiag: Command, late: Path, tmp_path: Path, name: str
) -> None:
    result = cspdiag("verify", "--timing", "--gantt", tmp_path / name, late)
    assert result.code == 2
    assert result.out == ""


def test_for_other_tools_it_is_the_answer_to_the_assertion(cspdiag: Command, late: Path) -> None:
    for form in ("github", "sarif", "concise"):
        assert cspdiag("verify", "--timing", "--format", form, late) == cspdiag("verify", "--format", form, late)
    github = cspdiag("verify", "--timing", "--format", "github", late)
    assert github.code == 1
    assert github.out.startswith(f"::error file={late},line=26,")
    assert "title=E1106%3A" in github.out
    concise = cspdiag("verify", "--timing", "--format", "concise", late)
    assert concise.out == ""
    assert concise.err.startswith(f"{late}:26:1: error[E1106] ")


def test_junit_has_one_test_for_the_process(cspdiag: Command, late: Path, silent: Path, tmp_path: Path) -> None:
    trace = tmp_path / "trace.json"
    trace.write_text(json.dumps({"executionTimes": {"Main.a": 12.5e-6}}))
    cases = {"failure": (late,), "error": (silent,), "system-out": ("--wcet-from", trace, silent)}
    for kind, options in cases.items():
        result = cspdiag("verify", "--timing", "--format", "junit", *options)
        assert result.code == (0 if kind == "system-out" else 1)
        (case,) = ElementTree.fromstring(result.out).iter("testcase")
        assert case.attrib["name"] == "assert Main schedulable"
        assert [part.tag for part in case] == [kind]


def test_without_an_assertion_the_process_is_marked(cspdiag: Command, late: Path) -> None:
    late.write_text(late.read_text().replace("assert Main schedulable\n", ""))
    result = cspdiag("verify", "--timing", "--format", "github", late)
    assert result.out.startswith(f"::error file={late},line=11,endLine=11,col=9,endColumn=13,title=E1106")


@pytest.mark.parametrize(
    "option", [("--method", "sat"), ("--engine", "spin"), ("--trace-out", "trace.json"), ("--draw", "deadlock.svg")]
)
def test_options_of_proofs_are_refused(cspdiag: Command, late: Path, option: tuple[str, str]) -> None:
    result = cspdiag("verify", "--timing", *option, late)
    assert (result.code, result.out) == (2, "")
    assert result.err.startswith(f"cspdiag: {option[0]} belongs to proofs")


def test_assertions_are_answered(cspdiag: Command, late: Path, silent: Path) -> None:
    refuted = cspdiag("verify", "--no-cache", late)
    assert refuted.code == 1
    assert "REFUTED  Main schedulable" in refuted.out + refuted.err
    assert (
        "error[E1106]: `Main` is not schedulable: `a` is late: when every law takes its longest time, the"
        in refuted.out + refuted.err
    )
    unknown = cspdiag("verify", "--no-cache", silent)
    assert unknown.code == 1
    assert "UNKNOWN  Main schedulable" in unknown.out + unknown.err
    assert "error[E1107]" in unknown.out + unknown.err
