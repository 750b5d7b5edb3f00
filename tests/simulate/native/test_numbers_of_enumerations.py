"""A driver in C that gives an enumeration a number which none of its values has."""

import shutil
from pathlib import Path

import pytest

from cspdiag.cli.main import main

PROGRAM = """
enum Mode { off, on }
struct Held { level : int  modes : Mode[2] }
driver Board c "board.c" {
  out mode : Mode
  out held : Held
}
process Top {
  in  mode  : Mode @ 1 ms
  in  held  : Held @ 1 ms
  out shown : Mode
  out kept  : Held
  communication {
    var m : Mode = Mode.off
    var h : Held = Held(level = 0, modes = [Mode.off, Mode.off])
  }
  composition { mu (mode ? m ; shown ! m ; held ? h ; kept ! h) }
}
environment Real for Top {
  board : Board
  board.mode -> mode
  board.held -> held
  shown -> _
  kept -> _
}
"""
HEADER = """
#ifndef BOARD_H
#define BOARD_H
#include "types.h"
struct board { enum top_mode mode; struct top_held held; };
bool board_open(struct board *self);
void board_close(struct board *self);
bool board_read_mode(struct board *self);
bool board_read_held(struct board *self);
#endif
"""
SOURCE = """
#include "board.h"
bool board_open(struct board *self) { (void)self; return true; }
void board_close(struct board *self) { (void)self; }
bool board_read_mode(struct board *self) { self->mode = (enum top_mode)MODE; return true; }
bool board_read_held(struct board *self)
{
    self->held.level = 3;
    self->held.modes.at[0] = TOP_MODE_ON;
    self->held.modes.at[1] = (enum top_mode)INNER;
    return true;
}
"""


@pytest.mark.skipif(shutil.which("cc") is None, reason="there is no C compiler")
@pytest.mark.parametrize(("mode", "inner"), [("7", "1"), ("1", "-1")])
@pytest.mark.parametrize(
    "wanted", [("--trace", "x.jsonl"), ("--record", "x.csv"), ("--record", "x.npz"), ("--record", "x.mcap")]
)
def test_it_is_reported_in_place_of_a_recording(
    wanted: tuple[str, str], mode: str, inner: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "top.csp").write_text(PROGRAM)
    (tmp_path / "board.h").write_text(HEADER)
    (tmp_path / "board.c").write_text(SOURCE.replace(")MODE;", f"){mode};").replace("INNER", inner))
    option, name = wanted
    run = ["run", str(tmp_path / "top.csp"), "--target", "c", "--for", "20ms", option, str(tmp_path / name)]
    assert main(run) == 1
    assert f"a value of Mode has the number {mode if mode == '7' else inner}" in capsys.readouterr().err
    assert not (tmp_path / name).exists()
