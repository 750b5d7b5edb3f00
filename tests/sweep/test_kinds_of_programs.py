"""Sweeps of programs with arrays and structs, in single precision, without ports, and with laws written in C."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

import cspdiag
from cspdiag.model.types import Real

pytestmark = pytest.mark.skipif(
    not any(map(shutil.which, ("cc", "gcc", "clang"))), reason="no C compiler: install gcc or clang"
)

MOVER = """\
struct Pose {
  x     : double<m>
  turns : int
}

parameter stride : double<m> = 1<m>

process Mover {
  in  gyro : double[3] @ 10 ms
  out pose : Pose      @ 10 ms

  communication {
    walk : Walk

    gyro      -> walk.gyro
    walk.pose -> pose
  }

  composition {
    mu walk
  }
}

submodel Walk {
  in  gyro : double[3]
  out pose : Pose
  state n : int       = 0
  state d : double<m> = 0
  next n = n + 1
  next d = d + stride * gyro[1]
  pose = Pose(x = d, turns = n)
}

submodel Top(rate: double = 2) {
  in  pose : Pose
  out gyro : double[3]
  gyro = [rate, sin(time / 1<s>), time / 1<s>]
}

environment Floor for Mover step 10 ms {
  top : Top
  pose     -> top.pose
  top.gyro -> gyro
}
"""


@pytest.mark.parametrize("real", ["double", "float32"])
def test_parts_of_arrays_and_structs_are_measured(real: Real) -> None:
    program = cspdiag.parse(MOVER, real=real)
    measures = ["max(pose.x)", "last(pose.turns)", "mean(gyro[1])", "rms(gyro[0])"]
    given = {"stride": "1:2:2", "top.rate": "1,2"}
    native = program.sweep(given, measures, until="0.5 s", target="c")
    assert native.rows == program.sweep(given, measures, until="0.5 s", target="python", workers=1).rows
    assert [row["last(pose.turns)"] for row in native.rows] == [48.0] * 4
    assert native.rows[1]["rms(gyro[0])"] == pytest.approx(2)


def test_a_program_without_ports() -> None:
    text = """\
parameter n : int = 3

process Counter {
  communication {
    var i : int = 0
  }

  composition {
    mu (i := i + 1 ; wait 1 s) until i >= n
  }
}
"""
    sweep = cspdiag.parse(text).sweep({"n": "1:3:3"}, target="c")
    assert [row["time"] for row in sweep.rows] == [1.0, 2.0, 3.0]


IN_C = """\
process Main {
  in  level   : double @ 10 ms
  out opening : double @ 10 ms

  communication {
    valve : Valve(gain = 1)

    level         -> valve.level
    valve.opening -> opening
  }

  composition {
    mu valve
  }
}

submodel Valve(gain: double) c "valve.c" {
  in  level   : double
  out opening : double
}

submodel Water(content: double = 1) {
  in  opening : double
  out level   : double
  state left : double = content
  der left = (0.5 - opening * 0.2) / 1<s>
  level = left
}

environment Bench for Main {
  water : Water
  opening     -> water.opening
  water.level -> level
}
"""

HEADER = """\
#ifndef VALVE_H
#define VALVE_H
struct valve { double level; double gain; double opening; };
void valve_initialize(struct valve *self, double gain);
void valve_reset(struct valve *self);
void valve_calculate(struct valve *self);
#endif
"""

SOURCE = """\
#include "valve.h"
#include <stdlib.h>

static double calls; /* which a new process does not have */

void valve_initialize(struct valve *self, double gain) { self->gain = gain; }
void valve_reset(struct valve *self) { (void)self; }
void valve_calculate(struct valve *self)
{
    calls += 1.0;
    self->opening = self->gain * calls;
    if (self->level > 2.5) {
        abort();
    }
}
"""


def test_what_a_law_in_c_keeps_does_not_reach_the_next_run_nor_does_its_end(tmp_path: Path) -> None:
    for name, content in (("main.csp", IN_C), ("valve.h", HEADER), ("valve.c", SOURCE)):
        (tmp_path / name).write_text(content)
    program = cspdiag.load(tmp_path / "main.csp")
    sweep = program.sweep({"water.content": "1,3,2"}, "last(opening)", until="50 ms", target="c", workers=1)
    assert [row["last(opening)"] for row in sweep.rows] == [4.0, None, 4.0]
    assert [row["ended"] for row in sweep.rows] == ["time limit", "crashed", "time limit"]
    assert sweep.rows[1]["error"] == "the process was ended by SIGABRT"


def test_a_module_in_python_that_fails_is_the_reason_in_each_row(tmp_path: Path) -> None:
    (tmp_path / "main.csp").write_text(IN_C.replace('c "valve.c"', 'python "valve.py:Valve"'))
    (tmp_path / "valve.py").write_text("import a_module_that_is_missing\n\n\nclass Valve:\n    pass\n")
    program = cspdiag.load(tmp_path / "main.csp")
    sweep = program.sweep({"water.content": "1,2"}, "last(opening)", until="50 ms", workers=1)
    assert sweep.made.startswith("in Python: ")
    assert [row["ended"] for row in sweep.rows] == ["failed", "failed"]
    assert "a_module_that_is_missing" in str(sweep.rows[0]["error"])
