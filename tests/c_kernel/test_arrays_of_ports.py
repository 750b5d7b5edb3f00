"""Arrays of ports are arrays in the structures of `NAME_api.h`, for C and C++."""

from __future__ import annotations

from pathlib import Path

import pytest

from cspdiag import pipeline
from cspdiag.base import SourceFile
from tests.c_kernel.building import STRICT, need, run
from tests.conformance.sources import network_of, read
from tests.support.compiling import compile_once

AXES = """
/// Positions of an axis.
struct Place { at : double }

process Axes {
  /// Positions of the axes.
  in  feedback[2] : Place  @ 10 ms
  in  scale       : double @ 10 ms
  out control[2]  : double @ 10 ms
  out lamp[3]     : bool

  communication {
    var first  : Place
    var second : Place
    var factor : double = 0
  }

  composition {
    mu (
      (feedback[0] ? first || feedback[1] ? second) ;
      scale ? factor ;
      control[0] ! first.at * factor ;
      control[1] ! second.at * factor ;
      seq i < 3 : (lamp[i] ! second.at > double(i))
    )
  }
}
"""
MAIN = """
#include <stdio.h>
#include "axes_api.h"

static bool sample(void *context, axes_input input, axes_inputs *inputs)
{
    (void)context;
    if (input == AXES_IN_SCALE) {
        inputs->scale = 10.0;
    } else { /* the names of the elements of an array follow each other */
        const int axis = (int)input - (int)AXES_IN_FEEDBACK_0;
        inputs->feedback[axis].at = 1.0 + (double)axis;
    }
    return true;
}

static void actuate(void *context, axes_output output, const axes_outputs *outputs, bool safe)
{
    (void)context;
    if (safe) {
        return;
    }
    if (output >= AXES_OUT_LAMP_0) {
        (void)printf("lamp %d: %d\\n", (int)output - (int)AXES_OUT_LAMP_0,
            (int)outputs->lamp[(int)output - (int)AXES_OUT_LAMP_0]);
    } else if (output == AXES_OUT_CONTROL_1) {
        (void)printf("control: %g, %g\\n", outputs->control[0], outputs->control[1]);
    }
}

int main(void)
{
    static axes_memory memory;
    axes_hooks hooks = axes_hooks();
    hooks.sample = sample;
    hooks.actuate = actuate;
    axes_instance *const self = axes_begin(&memory, sizeof memory, &hooks, NULL);
    return (axes_advance(self, 20000000, 100U) == AXES_MORE) ? 0 : 1;
}
"""


@pytest.mark.parametrize("level", [0, 1])
@pytest.mark.parametrize(("compiler", "standard"), [("gcc", "-std=c99"), ("g++", "-std=c++11")])
def test_arrays_of_ports_are_arrays_for_their_owner(level: int, compiler: str, standard: str, tmp_path: Path) -> None:
    need("gcc", compiler, "make")
    for path, text in pipeline.generate(network_of(SourceFile(name="axes.csp", text=AXES)), read, "c", level).items():
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_text(text)
    run("make", "axes.o", cwd=tmp_path)
    main = tmp_path / ("main.c" if compiler == "gcc" else "main.cpp")
    main.write_text(MAIN if compiler == "g++" else MAIN.replace("= axes_hooks()", "= {0}"))
    warnings = [flag for flag in STRICT if not flag.startswith("-std")]
    compile_once(compiler, standard, *warnings, main, "axes.o", "-lm", "-o", "program", cwd=tmp_path)
    lamps = ["lamp 0: 1", "lamp 1: 1", "lamp 2: 0"]
    assert run(tmp_path / "program").splitlines() == [*lamps, "control: 10, 20", *lamps]
    assert (
        "    struct axes_place feedback[2]; /* Positions of the axes, every 10 ms. */\n"
        in (tmp_path / "axes_api.h").read_text()
    )
