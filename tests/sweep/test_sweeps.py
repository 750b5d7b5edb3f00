"""Sweeps: native ones and those in Python are equal, also to single runs; how runs end; processes that die."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
from math import inf
from pathlib import Path

import pytest

import cspdiag
from cspdiag.base.sources import read_source
from cspdiag.base.span import SourceFile
from cspdiag.sweep.execute import Jobs, Pool, native_job
from cspdiag.sweep.plan import Plan, Request, plan_sweep
from cspdiag.sweep.workers import Job, Worker
from tests.sweep.programs import FATES, HEATER

needs_compiler = pytest.mark.skipif(
    not any(map(shutil.which, ("cc", "gcc", "clang"))), reason="no C compiler: install gcc or clang"
)

MEASURES = (
    *("max(power)", "min(temperature)", "peak(room.t)", "mean(power)", "rms(temperature)", "last(room.t)"),
    *("integral(abs(temperature - power))", "settling(room.t, 20, 0.5)", "overshoot(temperature, 18)"),
)


@pytest.fixture(scope="module")
def heater() -> cspdiag.LoadedProgram:
    return cspdiag.parse(HEATER, name="heater.csp")


def planned(program: str, given: dict[str, str], *measures: str, until: int | None = None) -> Plan:
    source = SourceFile(name="program.csp", text=program)
    return plan_sweep(
        Request(source=source, given=given, measures=measures, environment=None, until=until), read_source
    )


def test_a_plan_says_how_far_it_is() -> None:
    source = SourceFile(name="heater.csp", text=HEATER)
    given = {"gain": "0.3:2:3", "room.volume": "1:4:2", "T": "100ms,250ms"}
    seen: list[tuple[int, int]] = []
    request = Request(source=source, given=given, measures=(), environment=None, until=None)
    plan_sweep(request, read_source, lambda known, total: seen.append((known, total)))
    assert seen == [(number, 4) for number in range(1, 5)], "each value of T with each of the volume"


@needs_compiler
def test_native_sweeps_and_those_in_python_are_equal_to_the_bit(heater: cspdiag.LoadedProgram) -> None:
    given = {"gain": "0.3:2:3", "room.volume": "1:4:2", "T": "100ms,250ms"}
    native = heater.sweep(given, MEASURES, until="20 s", target="c")
    slow = heater.sweep(given, MEASURES, until="20 s", target="python", workers=1)
    assert native.rows == slow.rows
    assert len(native) == 12
    assert len({row["mean(power)"] for row in native.rows}) == 12
    assert {row["ended"] for row in native.rows} == {"time limit"}


@needs_compiler
def test_measures_are_those_of_single_runs(heater: cspdiag.LoadedProgram) -> None:
    sweep = heater.sweep({"gain": "0.3:2:2", "room.volume": "1,4"}, ["max(power)", "min(temperature)"], until="20 s")
    for row in sweep.rows:
        settings = {name: value for name in ("gain", "room.volume") if isinstance(value := row[name], float)}
        run = heater.run(until="20 s", set=settings, target="c")
        # At the end the output is set to its safe value, which is no measurement of the program.
        assert row["max(power)"] == run["power"].max()
        assert row["min(temperature)"] == run["temperature"].min()


def test_parameters_need_one_program_and_constants_one_for_each_value() -> None:
    plan = planned(HEATER, {"gain": "1:2:5", "room.volume": "1:2:7", "T": "10ms:30ms:3", "target": "21"})
    assert plan.variants == 3
    assert sorted(plan.tunable.values()) == [("gain", ()), ("room.volume", ()), ("target", ())]


SIZED = (
    HEATER.replace("let mass = 0.5 * volume", "let mass = if volume > 2 then 1 else 0.5 * volume")
    .replace("room : Room\n", "room : Room(stages = 2)\n")
    .replace(
        "submodel Room(volume: double = 2, loss: double = 0.1) {",
        "submodel Room(volume: double = 2, loss: double = 0.1, stages: int = 2) {",
    )
    .replace("  temperature = t\n", "  temperature = delay(t, stages, 15)\n")
)
"""``stages`` is the number of states."""


def test_a_parameter_that_decides_what_is_compiled_needs_a_program_for_each_value() -> None:
    plan = planned(SIZED, {"room.stages": "1:3:3", "room.volume": "1,2,3"}, until=0)
    assert plan.variants == 3
    assert list(plan.tunable.values()) == [("room.volume", ())]


CHOSEN = HEATER.replace(
    "const T = 100 ms",
    """\
const T = 100 ms
const narrow = false
const width = 2.0
const band = if narrow then width else 0.0
""",
).replace("(target - temperature)", "max(target - temperature, band)")


def test_values_with_equal_programs_share_one() -> None:
    plan = planned(CHOSEN, {"narrow": "true,false", "width": "1:4:4"})
    assert plan.variants == 8
    jobs = Jobs(plan, read_source, "python")
    made = [jobs[number] for number in range(8)]
    assert len({id(job) for job in made}) == 5
    assert made[4] is made[5] is made[6] is made[7]


LATE = """\
process Main {
  in  level : double @ 10 ms
  out seen  : double @ 10 ms
  communication { var x : double = 0 }
  composition { mu (level ? x ; seen ! x) }
}

/// Its signal is late by two samples if both values are 3.
submodel Pipe(length: double = 1, width: double = 1, tau: time = 2 s) {
  in  seen  : double
  out level : double
  let share = 1<s> / tau
  level = delay(length + width + share, if length == 3 and width == 3 then 2 else 1, 0)
}

environment Bench for Main {
  pipe : Pipe
  seen       -> pipe.seen
  pipe.level -> level
}
"""


@needs_compiler
@pytest.mark.parametrize(
    "given", [{"pipe.length": "1:6:6", "pipe.width": "3"}, {"pipe.length": "1,3", "pipe.width": "1,3"}]
)
def test_each_combination_of_values_has_the_program_that_it_needs(given: dict[str, str]) -> None:
    plan = planned(LATE, given)
    assert plan.variants == 2
    assert plan.structural_names
    program = cspdiag.parse(LATE)
    native = program.sweep(given, ["min(seen)", "last(seen)"], until="25 ms", target="c")
    slow = program.sweep(given, ["min(seen)", "last(seen)"], until="25 ms", target="python", workers=1)
    assert native.rows == slow.rows
    assert [row["last(seen)"] for row in native.rows if row["pipe.length"] == row["pipe.width"] == 3] == [0.0]


@needs_compiler
def test_a_time_that_the_environment_uses_in_seconds_is_one_in_each_run() -> None:
    sweep = cspdiag.parse(LATE).sweep({"pipe.tau": "500ms,2s"}, "last(seen)", until="25 ms", target="c")
    assert [row["last(seen)"] for row in sweep.rows] == [4.0, 2.5]


@needs_compiler
@pytest.mark.parametrize("target", ["c", "python"])
def test_how_runs_end_is_a_column(target: str) -> None:
    program = cspdiag.parse(FATES, name="fates.csp")
    sweep = program.sweep({"fate": "0:4:5"}, ["max(answer)", "mean(answer)"], until="3 s", target=target, workers=1)
    assert [(row["ended"], row["time"]) for row in sweep.rows] == [
        ("terminated", 1.0), ("failed", 0.0), ("deadlock", 0.0), ("time limit", 3.0), ("failed", 0.02),
    ]  # fmt: skip
    assert sweep.rows[0]["max(answer)"] == 7.0
    assert sweep.rows[2]["max(answer)"] is None
    errors = [row["error"] for row in sweep.rows]
    assert errors == [
        *("", "Fault: division by zero, in Fates (fates.csp:20)", "", "", "Broken, in Fates (fates.csp:23)"),
    ]
    assert sweep.summary() == "1 terminated, 2 failed, 1 deadlock, 1 time limit"


LARGE = """
parameter gain = 1.0
process Main {
  out p : double @ 10 ms
  composition { mu (wait 10 ms ; p ! gain) }
}
environment Bench for Main { p -> _ }
"""


@needs_compiler
@pytest.mark.parametrize("target", ["c", "python"])
def test_a_measure_that_becomes_too_large_is_infinite(target: str) -> None:
    sweep = cspdiag.parse(LARGE).sweep({"gain": "2,1e200"}, "rms(p)", until="1 s", target=target, workers=1)
    assert [row["rms(p)"] for row in sweep.rows] == [pytest.approx(2.0), inf]


@needs_compiler
@pytest.mark.parametrize("target", ["c", "python"])
def test_values_that_the_program_cannot_have_are_refused_in_their_row(target: str) -> None:
    text = HEATER.replace("const strongest = 4 * gain", "const strongest = 4 / gain")
    sweep = cspdiag.parse(text).sweep({"gain": "0,1"}, "max(power)", until="1 s", target=target, workers=1)
    assert [row["ended"] for row in sweep.rows] == ["refused", "time limit"]
    assert sweep.rows[0]["error"] == "this divides by zero"
    assert sweep.rows[0]["max(power)"] is None


@needs_compiler
def test_constants_with_which_a_program_is_wrong_are_refused_in_their_rows(heater: cspdiag.LoadedProgram) -> None:
    sweep = heater.sweep({"T": "0ms,100ms"}, "max(power)", until="1 s")
    assert [row["ended"] for row in sweep.rows] == ["refused", "time limit"]
    assert sweep.rows[0]["error"]


def test_without_a_compiler_runs_are_made_in_python(
    heater: cspdiag.LoadedProgram, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("CC", "no-such-compiler")
    sweep = heater.sweep({"gain": 1}, until="1 s", workers=1)
    assert sweep.made == "in Python: CC is no-such-compiler, and there is no such command"
    with pytest.raises(cspdiag.CompilerError):
        heater.sweep({"gain": 1}, until="1 s", target="c")


def test_a_program_with_errors_is_refused() -> None:
    with pytest.raises(cspdiag.ProgramError):
        cspdiag.parse(HEATER.replace("mu law", "mu lawn")).sweep({"gain": 1}, until=1)


class Killed(Worker):
    """A worker whose process is killed before it makes a run; ``times`` times."""

    def __init__(self, times: int) -> None:
        super().__init__()
        self.times = times

    def _started(self, job: Job):  # type: ignore[no-untyped-def]
        process = super()._started(job)
        if self.times > 0:
            self.times -= 1
            os.kill(process.pid, signal.SIGKILL)
        return process


@pytest.fixture(scope="module")
def job() -> tuple[Plan, Job]:
    plan = planned(HEATER, {"gain": "0.3:2:8"}, "mean(power)", until=10**9)
    return plan, native_job(plan, plan.variant(0), read_source)


@needs_compiler
def test_a_process_that_is_killed_makes_no_difference(job: tuple[Plan, Job]) -> None:
    _, native = job
    whole, killed = Worker(), Killed(1)
    try:
        expected = dict(whole.results(native, range(8)))
        assert dict(killed.results(native, range(8))) == expected
        assert len(expected) == 8
    finally:
        for worker in (whole, killed):
            worker.close()
            worker.end()


@needs_compiler
def test_a_run_in_which_processes_die_is_a_row_of_its_own(job: tuple[Plan, Job]) -> None:
    _, native = job
    worker = Killed(2)
    try:
        found = dict(worker.results(native, range(4)))
    finally:
        worker.close()
        worker.end()
    assert [found[run].ended for run in range(4)] == ["crashed", "time limit", "time limit", "time limit"]
    assert found[0].error == "the process was ended by SIGKILL"


@needs_compiler
def test_a_pool_that_is_left_early_leaves_no_process_behind(job: tuple[Plan, Job]) -> None:
    _, native = job
    with Pool(2) as pool:
        next(iter(pool.results(native, range(8))))


def test_jobs_say_why_runs_are_made_in_python(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", "no-such-compiler")
    plan = planned(HEATER, {"gain": "1"}, until=1)
    jobs = Jobs(plan, read_source, "auto")
    assert jobs.made == "as a native program"
    assert isinstance(jobs[0], Job)
    assert "no-such-compiler" in jobs.made


def test_tables(heater: cspdiag.LoadedProgram, tmp_path: Path) -> None:
    pandas = pytest.importorskip("pandas")
    sweep = heater.sweep({"gain": "1,2", "T": "100ms"}, "settling(room.t, 99, 1)", until="1 s", workers=1)
    frame = sweep.to_dataframe()
    assert list(frame.columns) == ["gain", "T", "settling(room.t, 99, 1)", "ended", "time", "error"]
    assert frame["settling(room.t, 99, 1)"].isna().all()
    assert frame.attrs["units"] == {"time": "s", "T": "s", "settling(room.t, 99, 1)": "s"}
    sweep.to_csv(tmp_path / "table.csv")
    again = pandas.read_csv(tmp_path / "table.csv", index_col="run", keep_default_na=False, na_values={"": []})
    assert list(again["gain"]) == [1.0, 2.0]
    pytest.importorskip("pyarrow")
    sweep.to_parquet(tmp_path / "table.parquet")
    assert list(pandas.read_parquet(tmp_path / "table.parquet")["gain"]) == [1.0, 2.0]


@pytest.mark.parametrize("second", ["1", "1,2,3", "1:9:9"])
def test_plots(heater: cspdiag.LoadedProgram, tmp_path: Path, second: str) -> None:
    pytest.importorskip("matplotlib")
    sweep = heater.sweep({"gain": "1:10:10", "room.volume": second}, ["max(power)", "settling(room.t, 15, 1)"], until=0)
    sweep.plot(tmp_path / "plot.svg")
    assert "max(power)" in (tmp_path / "plot.svg").read_text()
    with pytest.raises(cspdiag.ArgumentError, match=r"not as plot\.gif"):
        sweep.plot("plot.gif")


def test_panels_share_one_legend_of_the_lines_that_they_have(heater: cspdiag.LoadedProgram) -> None:
    pytest.importorskip("matplotlib")
    measures = ["max(power)", "settling(room.t, 20, 1)"]
    figure = heater.sweep({"gain": "0.1:2:4", "room.volume": "1,2"}, measures, until="20 s").plot()
    first, second = figure.axes
    assert first.get_xlim() == second.get_xlim()
    assert [panel.get_legend() for panel in figure.axes] == [None, None]
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == ["room.volume = 1", "room.volume = 2"]


def test_wrong_arguments_are_refused(heater: cspdiag.LoadedProgram) -> None:
    with pytest.raises(cspdiag.ArgumentError, match="unknown target"):
        heater.sweep({"gain": 1}, target="fpga")
    with pytest.raises(cspdiag.ArgumentError, match="workers"):
        heater.sweep({"gain": 1}, workers=0)
    with pytest.raises(TypeError, match="set is a mapping"):
        heater.sweep("gain=1")  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="a measure is a str"):
        heater.sweep({"gain": 1}, [3])  # type: ignore[list-item]


@pytest.mark.skipif(sys.platform != "linux", reason="finds processes in /proc")
@pytest.mark.parametrize("target", ["python", pytest.param("c", marks=needs_compiler)])
def test_processes_end_with_the_one_that_sweeps_however_it_ends(target: str) -> None:
    """Even in the middle of a run, which may take very long."""
    program = f"import cspdiag\ncspdiag.parse({HEATER!r}, 'a.csp').sweep({{'gain': 1}}, until=9e9, target={target!r})"
    with subprocess.Popen([sys.executable, "-c", program]) as sweeping:
        try:
            worker = _busy_child(sweeping.pid)
        finally:
            sweeping.kill()
    for _ in range(1500):
        if not _processor_time(worker):
            return
        time.sleep(0.02)
    os.kill(worker, signal.SIGKILL)
    pytest.fail("the process runs on")


def _busy_child(process: int) -> int:
    """The process that makes the runs of this one, as soon as it has used 0.2 s of processor time."""
    while True:
        for children in Path(f"/proc/{process}/task").glob("*/children"):
            for child in map(int, children.read_text().split()):
                try:
                    command = Path(f"/proc/{child}/cmdline").read_text()
                except OSError:
                    # It has ended in between: a compiler.
                    continue
                if ("/programs/" in command or "in_python" in command) and _processor_time(child) > 0.2:
                    return child
        time.sleep(0.02)


def _processor_time(process: int) -> float:
    """In seconds; 0 if it has ended."""
    try:
        state, *fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return 0.0
    return 0.0 if state == "Z" else int(fields[10]) / os.sysconf("SC_CLK_TCK")
