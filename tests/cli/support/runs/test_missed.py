"""A run that ends with a missed sample reports what its reader did meanwhile, and what helps, in the same way on all
targets.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from cspdiag.cli.main import main
from tests.cli.support.files.test_written import PROGRAM

PARTNERS = """
process Slow {
  in x : double
  communication { var v : double = 0 }
  composition { mu (wait 5 ms ; x ? v) }
}

process Fast {
  in  a : double @ 1 ms
  out x : double
  communication { var v : double = 0 }
  composition { mu (a ? v ; x ! v) }
}

process Main {
  in a : double @ 1 ms
  communication {
    fast : Fast
    slow : Slow
    a -> fast.a
    fast.x -> slow.x
  }
  composition { fast || slow }
}

submodel Source {
  out y : double
  y = time / 1<s>
}

environment Bench for Main {
  source : Source
  source.y -> a
}
"""


def explanation(text: str, tmp_path: Path, capsys: pytest.CaptureFixture[str], *options: str) -> list[str]:
    path = tmp_path / "main.csp"
    path.write_text(text)
    assert main(["run", str(path), "--for", "1s", *options]) == 1
    lines = capsys.readouterr().err.splitlines()
    return lines[next(number for number, line in enumerate(lines) if line.startswith("  missed samples")) :]


@pytest.mark.parametrize("options", [(), ("-O0",), ("--target", "c")])
def test_what_the_reader_did_is_reported(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], options: tuple[str, ...]
) -> None:
    assert explanation(PROGRAM, tmp_path, capsys, *options) == [
        "  missed samples: Main.a 1",
        "  between two reads of `a` it waits 2 ms (main.csp:6, W0707)",
        "  count samples of `a` instead, wait in a process in parallel, or put what reads `a` into a process of its "
        "own, "
        "which follows the samples only while it runs",
    ]


@pytest.mark.parametrize("options", [(), ("-O0",), ("--target", "c")])
def test_the_place_is_reported_for_a_file_with_parentheses_in_its_name(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], options: tuple[str, ...]
) -> None:
    path = tmp_path / "barrier(new).csp"
    path.write_text(PROGRAM.replace("wait 2 ms", "wait 700 us ; wait 800 us"))
    assert main(["run", str(path), "--for", "1s", *options]) == 1
    assert "  between two reads of `a` it waits 1500 us (barrier(new).csp:6, W0707)\n" in capsys.readouterr().err


def test_without_a_certain_cause_the_rule_is_reported(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    _, rule, remedy = explanation(PARTNERS, tmp_path, capsys)
    assert "Main.fast takes each sample before the next one comes" in rule
    assert "cspdiag explain W0707" in remedy


def test_other_ends_are_left_alone(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "main.csp"
    path.write_text(PROGRAM)
    assert main(["run", str(path), "--for", "1ms"]) == 0
    assert "between two reads of `a` it" not in capsys.readouterr().err
