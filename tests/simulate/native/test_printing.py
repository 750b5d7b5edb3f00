"""Bodies in C print what they like, and as much: it does not get among the records of a run."""

from __future__ import annotations

from pathlib import Path

import pytest

import cspdiag
from cspdiag.simulate.native.build import CompilerError, find_compiler

PROGRAM = """
driver Board() c "board.c" { out level : double }

process Top {
  in  level : double @ 10 ms
  communication { var t : double = 0 }
  composition { mu (level ? t) }
}

environment Real for Top {
  board : Board()
  board.level -> level
}
"""
HEADER = """#include <stdbool.h>
struct board { double level; };
bool board_open(struct board *self);
void board_close(struct board *self);
bool board_read_level(struct board *self);
"""
DRIVER = """
#include "board.h"
#include <stdio.h>
bool board_open(struct board *self) { (void)self; return true; }
void board_close(struct board *self) { (void)self; }
bool board_read_level(struct board *self)
{
    for (int line = 0; line < 2000; line++) {
        (void)fprintf(%s, "a line that is long enough to fill the pipe of a program before it has ended\\n");
    }
    self->level += 1.0;
    return true;
}
"""


@pytest.mark.parametrize("stream", ["stdout", "stderr"])
def test_a_driver_prints_more_than_a_pipe_holds(stream: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    try:
        find_compiler()
    except CompilerError as problem:
        pytest.skip(str(problem))
    (tmp_path / "board.h").write_text(HEADER)
    (tmp_path / "board.c").write_text(DRIVER % stream)
    (tmp_path / "main.csp").write_text(PROGRAM)
    run = cspdiag.load(str(tmp_path / "main.csp")).run(until="35 ms", target="c")
    assert list(run["level"]) == [1.0, 2.0, 3.0]
    output = capfd.readouterr()
    assert output.out == ""
    assert output.err.count("a line that is long enough") == 6000
