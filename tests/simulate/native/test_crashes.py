"""Bodies and drivers in C that crash or call ``exit``: what did that is named, and outputs get their safe values."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from cspdiag.cli.main import main

pytestmark = pytest.mark.skipif(not any(map(shutil.which, ("cc", "gcc", "clang"))), reason="there is no C compiler")

PROGRAM = """\
submodel Law c "law.c" { in level : double  out valve : double }
driver Board c "board.c" { out level : double  in valve : double }
process Main {
  in  level : double @ 10 ms
  out valve : double @ 10 ms safe -7
  communication { law : Law  level -> law.level  law.valve -> valve }
  composition { mu law }
}
process Through {
  in  level : double @ 10 ms
  out valve : double @ 10 ms safe -7
  communication { var x : double = 0 }
  composition { mu (level ? x ; valve ! x) }
}
environment Real for Main { board : Board  board.level -> level  valve -> board.valve }
environment Simulated for Through { plant : Law  plant.valve -> level  valve -> plant.level }
"""

LAW = """\
#include "law.h"
#include <pthread.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include "csp_internal.h"
static void *die(void *nothing) { abort(); return nothing; }
static void damage(void) { ((csp_process *)csp_owned()->current)->kind = (const csp_class *)8; abort(); }
static void die_elsewhere(void) { pthread_t other; pthread_create(&other, NULL, die, NULL); for (;;) { } }
void law_initialize(struct law *self) { self->count = 0; (void)damage; (void)die_elsewhere; }
void law_calculate(struct law *self)
{
    self->valve = self->level;
    self->count++;
    if (self->count == 5) { FAULT; }
}
"""

LAW_H = """\
#pragma once
struct law { double level; double valve; int count; };
void law_initialize(struct law *self);
void law_calculate(struct law *self);
"""

BOARD = """\
#include "board.h"
#include <stdio.h>
#include <stdlib.h>
bool board_open(struct board *self) { self->level = 0; return true; }
void board_close(struct board *self) { (void)self; }
bool board_read_level(struct board *self)
{
    self->level++;
    if (self->level == 5) { READING; }
    return true;
}
void board_write_valve(struct board *self)
{
    fprintf(stderr, "valve %g\\n", self->valve);
    if (self->valve == -7) { RELEASING; }
}
"""

BOARD_H = """\
#pragma once
#include <stdbool.h>
struct board { double level; double valve; };
bool board_open(struct board *self);
void board_close(struct board *self);
bool board_read_level(struct board *self);
void board_write_valve(struct board *self);
"""

SEGFAULT = "*(volatile int *)0 = 1"


def run(folder: Path, *options: str, law: str = "", reading: str = "", releasing: str = "") -> int:
    """The exit code of a run in which the law, the reading of an input or the safe value of the output does this."""
    (folder / "main.csp").write_text(PROGRAM)
    (folder / "law.c").write_text(LAW.replace("FAULT", law))
    (folder / "law.h").write_text(LAW_H)
    (folder / "board.c").write_text(BOARD.replace("READING", reading).replace("RELEASING", releasing))
    (folder / "board.h").write_text(BOARD_H)
    return main(["run", str(folder / "main.csp"), "--for", "100ms", "--target", "c", "--quiet", *options])


@pytest.mark.parametrize("level", ["-O0", "-O1"])
def test_the_law_that_crashes_is_named_after_the_signal(
    level: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(tmp_path, level, law=f'fprintf(stderr, "hot\\n"); {SEGFAULT}') == 1
    said = capsys.readouterr().err
    assert "has failed: it was ended by SIGSEGV, a crash such as that of a body in C or an FMU\n" in said
    crash = said.index("\n  hot\n  a crash in Main.law (")
    assert "main.csp:1): the outputs are released\n" in said[crash:]
    assert said.endswith("\n  valve -7\n")
    assert said.count("valve -7") == 1


def test_the_law_that_calls_exit_is_named_after_the_code(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(tmp_path, law="exit(3)") == 1
    said = capsys.readouterr().err
    assert "has failed: exit code 3 before the end of the run, as if a body in C or an FMU had called exit\n" in said
    assert "\n  exit was called in Main.law (" in said
    assert said.endswith("\n  valve -7\n")


@pytest.mark.parametrize(
    ("reading", "releasing", "named"),
    [
        (SEGFAULT, "", "a crash in the device function of Main.level"),
        ("exit(2)", "", "exit was called in the device function of Main.level"),
        ("", SEGFAULT, "a crash in the safe value of Main.valve"),
    ],
)
def test_the_port_whose_driver_ends_the_program_is_named(
    reading: str, releasing: str, named: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    assert run(tmp_path, "--real-time", reading=reading, releasing=releasing) != 0
    assert f"\n{named}: the outputs are released\n" in capfd.readouterr().err


def test_a_model_that_crashes_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(tmp_path, "--environment", "Simulated", law="abort()") == 1
    said = capsys.readouterr().err
    assert "SIGABRT, a crash such as that of a body in C or an FMU\n  a crash in the environment: the outputs" in said


def test_a_crash_in_another_thread_is_not_that_of_the_process(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(tmp_path, law="die_elsewhere()") == 1
    said = capsys.readouterr().err
    assert "\n  a crash in another thread: the outputs are released\n" in said
    assert said.endswith("\n  valve -7\n")


def test_damage_that_prevents_the_words_does_not_prevent_the_release(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(tmp_path, law="damage()") == 1
    said = capsys.readouterr().err
    assert "ended by SIG" in said
    assert said.endswith("\n  valve -7\n")
    assert said.count("valve -7") == 1


def test_files_of_an_earlier_run_are_said_to_be_such(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    record, trace, other = (str(tmp_path / name) for name in ("run.csv", "run.jsonl", "run.json"))
    outputs = ("--record", record, "--trace", trace)
    assert run(tmp_path, *outputs) == 0
    earlier = Path(record).read_bytes(), Path(trace).read_bytes()
    capsys.readouterr()
    assert run(tmp_path, *outputs, "--json", other, law="abort()") == 1
    assert (Path(record).read_bytes(), Path(trace).read_bytes()) == earlier
    assert f"cspdiag: {record} and {trace} are of an earlier run\n" in capsys.readouterr().err
    Path(record).unlink()
    assert run(tmp_path, *outputs, law="abort()") == 1
    assert f"cspdiag: {trace} is of an earlier run\n" in capsys.readouterr().err


def test_the_signal_that_a_law_raises_is_reported(tmp_path: Path) -> None:
    assert run(tmp_path, law="raise(SIGINT)") == 130
    assert run(tmp_path, law="raise(SIGTERM)") == 143
