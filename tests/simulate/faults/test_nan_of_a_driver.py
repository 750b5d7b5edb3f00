"""A NaN that a driver delivers is a value; storing or writing what follows from it is a fault."""

from __future__ import annotations

from pathlib import Path

import pytest

import cspdiag
from cspdiag.simulate.native.build import CompilerError, find_compiler

PROGRAM = """
driver Board() {language} "board.{ending}" {{
  out level : double
}}

process Top {{
  in  level : double @ 10 ms
  out y : double
  communication {{ var t : double = 0  var n : double = 0 }}
  composition {{ mu (level ? t ; if t == t then y ! t else (y ! -1 ; n := t + 1)) catch Fault -> y ! -2 }}
}}

environment Real for Top {{
  board : Board()
  board.level -> level
  y -> _
}}
"""
PYTHON = """
class Board:
    count = 0

    def read(self, port):
        self.count += 1
        return float("nan") if self.count == 3 else float(self.count)
"""
HEADER = """#include <stdbool.h>
struct board { double level; int count; };
bool board_open(struct board *self);
void board_close(struct board *self);
bool board_read_level(struct board *self);
"""
C = """
#include "board.h"
#include <math.h>
bool board_open(struct board *self) { self->count = 0; return true; }
void board_close(struct board *self) { (void)self; }
bool board_read_level(struct board *self)
{
    self->count++;
    self->level = self->count == 3 ? NAN : self->count;
    return true;
}
"""
WANTED = [1.0, 2.0, -1.0, -2.0]


@pytest.mark.parametrize("level", [0, 1])
def test_in_python(level: int, tmp_path: Path) -> None:
    (tmp_path / "board.py").write_text(PYTHON)
    (tmp_path / "main.csp").write_text(PROGRAM.format(language="python", ending="py:Board"))
    run = cspdiag.load(str(tmp_path / "main.csp")).run(until="35 ms", level=level)
    assert list(run["y"][:4]) == WANTED


@pytest.mark.parametrize("level", [0, 1])
def test_in_c(level: int, tmp_path: Path) -> None:
    try:
        find_compiler()
    except CompilerError as problem:
        pytest.skip(str(problem))
    (tmp_path / "board.h").write_text(HEADER)
    (tmp_path / "board.c").write_text(C)
    (tmp_path / "main.csp").write_text(PROGRAM.format(language="c", ending="c"))
    run = cspdiag.load(str(tmp_path / "main.csp")).run(until="35 ms", target="c", level=level)
    assert list(run["y"][:4]) == WANTED
