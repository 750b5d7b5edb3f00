"""A signal that ends the process while it writes leaves neither a mixture of two results nor anything beside them."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from cspdiag.base.files.whole import replace_files

ROOT = Path(__file__).parents[3]

SIGNALLED = """\
import os, signal, sys
from cspdiag.cli.main import main

kind, call, count, *words = sys.argv[1:]
function, calls = getattr(os, call), 0

def signalled(*arguments, **options):
    global calls
    calls += "out/" in str(arguments[0])
    if calls == int(count):
        os.kill(os.getpid(), signal.Signals[kind])
    return function(*arguments, **options)

setattr(os, call, signalled)
sys.exit(main(words))
"""

BLINK = """\
process Blink {
  out light : int @ 10 ms
  communication { var n : int = 0 }
  composition { mu (n := n + TOP ; light ! n ; wait 10 ms) }
}
"""


def run(folder: Path, *words: str) -> int:
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        [sys.executable, *words], cwd=folder, env=environment, capture_output=True, text=True, timeout=60
    )
    assert "Traceback" not in done.stderr, done.stderr
    return done.returncode


def contents(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


ENDS = [("SIGINT", 130), ("SIGTERM", -signal.SIGTERM), ("SIGHUP", -signal.SIGHUP)]


@pytest.mark.parametrize(("kind", "code"), ENDS)
@pytest.mark.parametrize(("call", "count"), [("mkdir", 1), ("makedirs", 9), ("replace", 2)])
def test_a_package_is_replaced_as_a_whole(tmp_path: Path, kind: str, code: int, call: str, count: int) -> None:
    for name, top in (("blink.csp", "1"), ("later/blink.csp", "2")):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text(BLINK.replace("TOP", top))
    compiled = ("-m", "cspdiag", "compile", "--target", "c")
    assert run(tmp_path, *compiled, "blink.csp", "-o", "out") == 0
    assert run(tmp_path, *compiled, "later/blink.csp", "-o", "expected") == 0
    options = ("compile", "--target", "c", "later/blink.csp", "-o", "out")
    assert run(tmp_path, "-c", SIGNALLED, kind, call, str(count), *options) == code
    assert contents(tmp_path / "out") == contents(tmp_path / "expected")
    assert os.listdir(tmp_path / "out") == ["blink"]


@pytest.mark.parametrize(("kind", "code"), ENDS)
def test_pictures_of_a_folder_change_together(tmp_path: Path, kind: str, code: int) -> None:
    (tmp_path / "blink.csp").write_text(BLINK.replace("TOP", "1") + BLINK.replace("Blink", "Flash").replace("TOP", "2"))
    options = ("draw", "blink.csp", "--all", "--format", "svg", "-o", "out/")
    assert run(tmp_path, "-m", "cspdiag", *options) == 0
    expected = contents(tmp_path / "out")
    assert len(expected) > 1
    for name in expected:
        (tmp_path / "out" / name).write_text("old")
    assert run(tmp_path, "-c", SIGNALLED, kind, "replace", "2", *options) == code
    assert contents(tmp_path / "out") == expected


WRITING = """\
import os, signal, sys
from cspdiag.base.files.whole import whole_file

with whole_file("result") as file:
    file.write(b"half")
    os.kill(os.getpid(), signal.Signals[sys.argv[1]])
    file.write(b"whole")
"""


@pytest.mark.parametrize("kind", ["SIGTERM", "SIGHUP"])
def test_a_file_that_is_being_written_stays_as_it_was(tmp_path: Path, kind: str) -> None:
    (tmp_path / "result").write_text("before")
    assert run(tmp_path, "-c", WRITING, kind) == -signal.Signals[kind]
    assert contents(tmp_path) == {"result": b"before"}


BETWEEN = """\
import os, signal, sys
from cspdiag.base.files.whole import whole_file

set_handler, calls = signal.signal, 0

def signalled(*arguments):
    global calls
    calls += 1
    before = set_handler(*arguments)
    if calls == int(sys.argv[1]):
        os.kill(os.getpid(), signal.SIGTERM)
    return before

signal.signal = signalled
with whole_file("result") as file:
    file.write(b"whole")
"""


def test_a_signal_between_two_handlers_ends_the_process(tmp_path: Path) -> None:
    """The first handlers are those of the whole, the last ones are taken out when all is done."""
    (tmp_path / "result").write_text("before")
    codes, texts = [], []
    for count in range(1, 100):
        codes.append(run(tmp_path, "-c", BETWEEN, str(count)))
        ((_, text),) = contents(tmp_path).items()
        texts.append(text)
        if codes[-1] == 0:
            break
    assert codes == [-signal.SIGTERM] * (len(codes) - 1) + [0]
    assert len(codes) > 20
    assert {*texts} == {b"before", b"whole"}
    assert texts == sorted(texts)


def test_a_new_folder_does_not_stay_empty(tmp_path: Path) -> None:
    folder = tmp_path / "new"
    with pytest.raises(FileNotFoundError):
        replace_files({f"{folder}/first": b"1", f"{folder}/missing/second": b"2"}, folder)
    assert not folder.exists()
    replace_files({f"{folder}/first": b"1"}, folder)
    with pytest.raises(FileNotFoundError):
        replace_files({f"{folder}/first": b"3", f"{folder}/missing/second": b"2"}, folder)
    assert contents(folder) == {"first": b"1"}
