"""Runs on the C target: the same results, recordings and messages as in Python, from a cache that rebuilds what
changed.
"""

from __future__ import annotations

import array
import fcntl
import os
import resource
import shutil
import signal
import stat
import subprocess
import sys
import termios
import threading
import time
from pathlib import Path

import pytest

from cspdiag import pipeline
from cspdiag.base import SourceFile
from cspdiag.base.sources import read_source
from cspdiag.codegen.c.package.messages import explained
from cspdiag.codegen.shared.target_error import TargetError
from cspdiag.network.ir.network import Network
from cspdiag.runtime.kernel.exceptions import described
from cspdiag.simulate.native import run as native
from cspdiag.simulate.native.build import Build, CompilationTimeoutError, CompilerError, find_compiler
from cspdiag.simulate.native.rows import PassedRows
from cspdiag.simulate.native.stream import StreamReader
from cspdiag.simulate.record.recorder import Recorder
from cspdiag.simulate.result import Run
from cspdiag.simulate.run import execute

needs_compiler = pytest.mark.skipif(
    not any(shutil.which(name) for name in ("cc", "gcc", "clang")), reason="there is no C compiler"
)

MODELS = Path(__file__).parents[3] / "models"
SECOND = 1_000_000_000
FAST = ("-O1",)


def network_of(text: str, folder: Path | None = None) -> Network:
    name = "case.csp" if folder is None else str(folder / "case.csp")
    built = pipeline.build(SourceFile(name=name, text=text), read_source)
    assert built.network is not None, [found.message for found in built.checked.report.diagnostics]
    return built.network


def model(name: str) -> Network:
    network = pipeline.build(read_source(str(MODELS / name)), read_source).network
    assert network is not None
    return network


def both(network: Network, level: int, until: int | None = None) -> tuple[Run, Run]:
    """The run in Python at -O0 and the native one."""
    files = pipeline.generate(network, read_source)
    reference = execute.simulate(network, files, until=until)
    return reference, native.simulate(network, read_source, level=level, until=until, options=FAST)


@needs_compiler
@pytest.mark.parametrize("level", [0, 1])
@pytest.mark.parametrize(
    "name", ["jiwy/jiwy.csp", "watchdog/watchdog.csp", "emergency/emergency.csp", "dining/deadlock.csp"]
)
def test_a_native_run_gives_the_same_files(name: str, level: int, tmp_path: Path) -> None:
    reference, found = both(model(name), level, until=3 * SECOND)
    for suffix in ("csv", "jsonl"):
        for run, stem in ((reference, "python"), (found, "c")):
            path = tmp_path / f"{stem}.{suffix}"
            run.to_csv(path) if suffix == "csv" else run.to_trace(path)
        assert (tmp_path / f"c.{suffix}").read_bytes() == (tmp_path / f"python.{suffix}").read_bytes()
    assert found.outcome.ended == reference.outcome.ended
    assert found.outcome.time == reference.outcome.time
    assert found.outcome.missed == reference.outcome.missed
    assert found.activities == reference.activities
    assert found.releases == reference.releases
    if reference.outcome.deadlock is not None:
        assert found.outcome.deadlock is not None
        assert found.outcome.deadlock.text == reference.outcome.deadlock.text


FAULTY = """\
submodel Law {
  in  x : double
  out y : double
  state n : int8 = 100
  next n = n + 10
  y = x / double(n)
}

process Main {
  in  x : double @ 10 ms
  out y : double @ 10 ms
  communication { law : Law x -> law.x law.y -> y }
  composition { mu law }
}

submodel Source { out x : double x = time / 1<s> }
submodel Sink { in y : double }

environment Bench for Main {
  source : Source
  sink   : Sink
  source.x -> x
  y -> sink.y
}
"""


@needs_compiler
@pytest.mark.parametrize("level", [0, 1])
def test_a_fault_has_the_words_and_the_place_of_the_python_one(level: int) -> None:
    reference, found = both(network_of(FAULTY), level)
    assert reference.outcome.error is not None
    assert found.outcome.error is not None
    assert described(found.outcome.error) == described(reference.outcome.error)
    assert "130 is outside int8 (-128 .. 127), in Main.law (case.csp:5)" in described(found.outcome.error)
    assert list(found.communications)[:3] != []


@needs_compiler
def test_a_channel_that_nobody_uses_is_in_no_record() -> None:
    text = """process A { out c : int composition { skip } }
process B { in c : int out d : int composition { d ! 1 } }
process C { in d : int communication { var v : int } composition { d ? v } }
process Top {
  communication { a : A b : B c : C a.c -> c1 : int -> b.c b.d -> c2 : int -> c.d }
  composition { a || b || c }
}
"""
    reference, done = both(network_of(text), 0)
    assert [entry[1:3] for entry in done.communications] == [("Top.c2", 1)]
    assert done.outcome.ended == reference.outcome.ended == "terminated"


@needs_compiler
def test_an_environment_that_fails_ends_the_run() -> None:
    broken = FAULTY.replace("x = time / 1<s>", "x = 1 / (time / 1<s> - 0.02)").replace("n + 10", "n")
    reference, found = both(network_of(broken), 1)
    assert reference.outcome.error is not None
    assert found.outcome.error is not None
    assert found.outcome.ended == "failed"
    assert str(found.outcome.error) == str(reference.outcome.error)


@needs_compiler
def test_ports_alone_can_be_recorded() -> None:
    network = model("jiwy/jiwy.csp")
    ports = native.simulate(network, read_source, until=SECOND, observed="ports", options=FAST)
    everything = native.simulate(network, read_source, until=SECOND, options=FAST)
    assert {channel for _, channel, *_ in ports.communications} <= {f"Jiwy.{p.name}" for p in network.external_ports}
    assert len(ports.communications) <= len(everything.communications)
    none = native.simulate(network, read_source, until=SECOND, observed="none", options=FAST)
    assert none.communications == []
    assert none.activities == everything.activities


# ---- Bodies in other languages


def test_a_submodel_in_python_is_refused_with_what_to_write_instead() -> None:
    source = "submodel Source { out x : double x = time / 1<s> }"
    network = network_of(FAULTY.replace(source, 'submodel Source python "s.py:S" { out x : double }'))
    words = r'body of the submodel `Source` is a Python class(?s:.*)submodel Source c "s\.c"'
    with pytest.raises(TargetError, match=words):
        pipeline.generate(network, read_source, "c")


def test_devices_are_left_out_of_a_package_and_refused_in_a_run() -> None:
    device = 'driver Lamp python "lamp.py:Lamp" { in y : double }'
    driven = FAULTY.replace("submodel Sink { in y : double }", device).replace("sink   : Sink", "sink : Lamp")
    network = network_of(driven)
    files = pipeline.generate(network, read_source, "c")
    assert "main_simulation.c" not in files
    with pytest.raises(TargetError, match="the driver `Lamp` is a Python class"):
        native.simulate(network, read_source)


VALVE_HEADER = """\
#ifndef VALVE_H
#define VALVE_H
struct valve {
    double x, y;   /* ports */
    double gain;
    double before; /* a state */
};
void valve_initialize(struct valve *self, double gain);
void valve_reset(struct valve *self);
void valve_calculate(struct valve *self);
#endif
"""

VALVE_SOURCE = """\
#include "valve.h"
void valve_initialize(struct valve *self, double gain)
{
    self->gain = gain;
    valve_reset(self);
}
void valve_reset(struct valve *self)
{
    self->before = 0.0;
}
void valve_calculate(struct valve *self)
{
    self->y = self->gain * (self->x + self->before);
    self->before = self->x;
}
"""


@needs_compiler
@pytest.mark.parametrize("level", [0, 1])
@pytest.mark.parametrize("nested", [False, True])
def test_a_submodel_can_be_written_in_c(level: int, nested: bool, tmp_path: Path) -> None:
    (tmp_path / "valve.c").write_text(VALVE_SOURCE)
    (tmp_path / "valve.h").write_text(VALVE_HEADER)
    law = FAULTY[: FAULTY.index("process Main")]
    body = 'submodel Valve(gain: double) c "valve.c" { in x : double out y : double }\n'
    if nested:
        wrapped = "submodel Law { in x : double out y : double inner : Valve(gain = 2) inner.x = x y = inner.y }\n"
        network = network_of(body + wrapped + FAULTY[len(law) :], tmp_path)
    else:
        network = network_of(body + FAULTY[len(law) :].replace("law : Law", "law : Valve(gain = 2)"), tmp_path)
    run = native.simulate(network, read_source, level=level, until=SECOND // 20, options=FAST)
    assert run["y"].tolist()[:4] == [2 * 0.01, 2 * (0.02 + 0.01), 2 * (0.03 + 0.02), 2 * (0.04 + 0.03)]


# ---- The compiler and the cache


def compiler_that(folder: Path, script: str) -> str:
    path = folder / "cc"
    path.write_text(f"#!/bin/sh\n{script}\n")
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return str(path)


def test_without_a_compiler_the_message_says_what_to_install(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(CompilerError, match="install gcc or clang"):
        find_compiler()
    monkeypatch.setenv("CC", "no-such-compiler")
    with pytest.raises(CompilerError, match="CC is no-such-compiler"):
        find_compiler()


def test_a_compiler_that_fails_without_a_message_is_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setenv("CC", "false")
    with pytest.raises(
        CompilerError, match=r"the compiler false ended with exit code 1 and no message\n  help: .*CC=clang"
    ):
        Build({"law.c": "int a;\n"}, ["law.c"], folder=tmp_path / "cache").executable()


def test_messages_of_a_compiler_name_places_in_the_program(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    files = {"law.c": "int a; /* laws.csp:3 */\nint b;\n"}
    script = (
        '[ "$1" = --version ] && echo mine && exit\nfor f; do case $f in */law.c) echo "$f:2:5: error: no b" >&2; exit '
        "1;; esac; done"
    )
    monkeypatch.setenv("CC", compiler_that(tmp_path, script))
    with pytest.raises(CompilerError, match=r"law\.c:2:5: error: no b \[laws\.csp:3\]"):
        Build(files, ["law.c"], folder=tmp_path / "cache").executable()
    assert explained("other.c:1:1: error", files) == "other.c:1:1: error"


def test_of_many_messages_of_a_compiler_the_first_error_is_shown() -> None:
    """What the kernel gives as an example of a place is none."""
    files = {"csp_core.h": 'struct csp_process {\n    const char *where; /* where it is defined: "laws.csp:12" */\n'}
    before = ["a.c:1:1: warning: w"] * 30
    first = ["In file included from tank.h:4,", "                 from tank.c:3:", "csp_core.h:2:5: error: no type"]
    shown = explained("\n".join([*before, *first, *["b.c:9:9: error: e"] * 1000]), files).split("\n")
    assert shown[:3] == first
    assert shown[-1] == "(these are 20 of 1,033 lines)"
    assert len(shown) == 21


def test_a_compiler_that_computes_too_long_is_stopped(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """With everything that it has started; its other options are then not tried."""
    log = tmp_path / "log"
    script = f'[ "$1" = --version ] && echo mine && exit\necho tried >> {log}\nsh -c "while :; do :; done"; exit 1'
    monkeypatch.setenv("CC", compiler_that(tmp_path, script))
    build = Build({"a.c": "int a;\n"}, ["a.c"], folder=tmp_path / "cache")
    with pytest.raises(CompilationTimeoutError, match=r"cc computes for more than 1 s$"):
        build.assembled("a.c", ("-fstack-usage",), (), patience=1)
    assert log.read_text() == "tried\n"


def test_a_build_that_is_interrupted_ends_its_compilers(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    started = tmp_path / "started"
    # The process that compiles is a child of the command, as cc1 of gcc, and keeps its streams open.
    script = f'[ "$1" = --version ] && echo mine && exit\ntouch {started}\nsleep 100\nexit 1'
    monkeypatch.setenv("CC", compiler_that(tmp_path, script))
    build = Build({"a.c": "int a;\n", "b.c": "int b;\n"}, ["a.c", "b.c"], folder=tmp_path / "cache")

    def interrupt() -> None:
        while not started.exists():
            time.sleep(0.01)
        os.kill(os.getpid(), signal.SIGINT)

    threading.Thread(target=interrupt, daemon=True).start()
    began = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        build.executable()
    assert time.monotonic() - began < 80


@needs_compiler
def test_only_what_has_changed_is_compiled_again(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    log = tmp_path / "log"
    real = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
    monkeypatch.setenv("CC", compiler_that(tmp_path, f'echo "$@" >> {log}\nexec {real} "$@"'))
    cache = tmp_path / "cache"
    files = {
        "main.c": '#include "a.h"\nint main(void) { return a() - 1; }\n', "a.c": (
            '#include "a.h"\nint a(void) { return 1; }\n'
        ),
        "a.h": "int a(void);\n", "b.c": "int b;\n",
    }  # fmt: skip

    def compiled(texts: dict[str, str]) -> set[str]:
        log.write_text("")
        Build(texts, ["main.c", "a.c", "b.c"], folder=cache).executable()
        return {name for name in ("main.c", "a.c", "b.c") if f"/{name} " in log.read_text()}

    assert compiled(files) == {"main.c", "a.c", "b.c"}
    assert compiled(files) == set()
    assert compiled({**files, "b.c": "int b = 1;\n"}) == {"b.c"}
    assert compiled({**files, "a.h": "int a(void); /* one */\n"}) == {"main.c", "a.c"}
    assert not [entry for entry in os.listdir(cache) if entry.startswith("building")]


@needs_compiler
def test_a_cache_that_cannot_be_written_is_named(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    with pytest.raises(CompilerError, match=r"cannot be written.*XDG_CACHE_HOME"):
        Build({"main.c": "int main(void) { return 0; }\n"}, ["main.c"]).executable()


@needs_compiler
def test_the_cache_keeps_what_was_used_last(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr("cspdiag.simulate.native.build._LARGEST_CACHE", 1)
    abandoned, present = tmp_path / "building-old", tmp_path / "building-now"
    abandoned.mkdir()
    present.mkdir()
    os.utime(abandoned, (0, 0))
    program = Build({"main.c": "int main(void) { return 0; }\n"}, ["main.c"], folder=tmp_path).executable()
    assert not program.exists()
    assert not abandoned.exists()
    assert present.exists()
    assert not list((tmp_path / "objects").iterdir())


@needs_compiler
def test_an_interrupted_run_is_reported_to_its_end() -> None:
    endless = FAULTY.replace("n + 10", "n")

    def interrupt_later(reader: StreamReader) -> None:
        def interrupt() -> None:
            while reader.now == 0:
                time.sleep(0.001)
            os.kill(os.getpid(), signal.SIGINT)

        threading.Thread(target=interrupt, daemon=True).start()

    run = native.simulate(network_of(endless), read_source, on_start=interrupt_later, observed="ports", options=FAST)
    assert run.outcome.ended == "stopped"
    assert run.releases == [(run.outcome.time, "Main.y", 0.0)]
    assert run.communications[-1].time <= run.outcome.time


@needs_compiler
def test_a_signal_without_a_reader_loses_no_record() -> None:
    """A program that is ahead of its reader waits in the middle of a write, which the signal must not cut short."""
    network = network_of(FAULTY.replace("n + 10", "n"))
    files = pipeline.generate(network, read_source, "c")
    sources = [path for path in files if path.endswith(".c") and not path.endswith("csp_port_posix.c")]
    sources = [path for path in sources if "csp_port_cortex_m" not in path and "csp_port_board" not in path]
    program = Build(files, sources, (*FAST, "-DCSP_TRACE=1")).executable()
    with subprocess.Popen([program, "--observe", "all"], stdout=subprocess.PIPE) as running:
        assert running.stdout is not None
        capacity = fcntl.fcntl(running.stdout, fcntl.F_GETPIPE_SZ)
        waiting = array.array("i", [0])
        while waiting[0] <= capacity - resource.getpagesize():
            assert running.poll() is None
            fcntl.ioctl(running.stdout, termios.FIONREAD, waiting)
        running.send_signal(signal.SIGTERM)
        reader = StreamReader(running.stdout, network, Recorder(), PassedRows(network, keeps_order=True))
        reader.read()
    assert reader.end is not None
    assert reader.end.ending == 4


COUNTING = """
process Main { in x : int @ 1 ms communication { var v : int } composition { mu x ? v } }
submodel S { out x : int x = 1 }
environment E for Main on miss count { s : S s.x -> x }
"""


@needs_compiler
def test_missed_samples_are_reported_once_against_the_clock(tmp_path: Path) -> None:
    (tmp_path / "case.csp").write_text(COUNTING)
    run = [sys.executable, "-m", "cspdiag", "run", "case.csp", "--target", "c", "--real-time", "--for", "20ms"]
    reported = subprocess.run(run, cwd=tmp_path, capture_output=True, text=True, check=True).stderr
    assert reported.count("missed samples: ") == 1
    assert "instants, late by" in reported


@needs_compiler
def test_a_program_that_runs_by_itself_reports_missed_samples_once(tmp_path: Path) -> None:
    files = pipeline.generate(network_of(COUNTING), read_source, "c", 0)
    sources = [path for path in files if path.endswith(".c")]
    real_time = native._chosen_sources(sources, real_time=True)
    program = Build(files, real_time, ("-O0",)).executable()
    reported = subprocess.run([program, "--for", "20000000"], capture_output=True, text=True, check=True).stderr
    assert reported.count("missed samples: ") == 1
    assert "instants, late by" in reported
