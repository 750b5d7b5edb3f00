"""A recording is readable however its run ended, up to the last second, and its name says whether it is whole."""

from __future__ import annotations

import ctypes
import os
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from cspdiag.cli.main import main
from cspdiag.simulate.native.build import CompilerError, find_compiler
from tests.simulate.record.streamed.oracles import Seen, by_mcap, by_rosbags

LOOP = """
process Main {
  in  level : double @ 1 ms
  out valve : double @ 1 ms
  communication { var last : double = 0 }
  composition { mu (level ? last ; valve ! last) }
}

submodel Plant {
  in  valve : double
  out level : double
  level = time / 1<s>
}

environment Bench for Main {
  plant : Plant
  plant.level -> level
  valve -> plant.valve
}
"""

TARGETS = [[], ["--target", "c"]]
_SIGNAL_OF_PARENTS_DEATH = 1
"""PR_SET_PDEATHSIG of prctl."""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "main.csp").write_text(LOOP)
    return tmp_path


def started(folder: Path, name: str, *options: str, limit: int = 0) -> subprocess.Popen[bytes]:
    if "c" in options:
        try:
            find_compiler()
        except CompilerError as problem:
            pytest.skip(str(problem))
    command = [sys.executable, "-m", "cspdiag", "run", "main.csp", "--record", name, *options]

    def limited() -> None:
        # The runs never end by themselves, and would fill the disk if the tests were killed.
        ctypes.CDLL(None).prctl(_SIGNAL_OF_PARENTS_DEATH, signal.SIGKILL)
        if limit:
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

    return subprocess.Popen(command, cwd=folder, stderr=subprocess.PIPE, preexec_fn=limited)


def wait_for(path: Path, size: int, process: subprocess.Popen[bytes]) -> None:
    for _ in range(6000):
        if path.exists() and path.stat().st_size >= size:
            return
        assert process.poll() is None, process.communicate()
        time.sleep(0.01)
    raise AssertionError(f"{path} does not grow")


def table(path: Path) -> Seen:
    rows = [row.split(",") for row in path.read_text().splitlines()]
    assert rows[0] == ["time", "level", "valve"]
    assert all(len(row) == 3 and all(row[:2]) for row in rows[1:]), "each row is whole"
    return {"level": [(round(float(row[0]) * 1e9), [float(row[1])]) for row in rows[1:]]}


def seen(folder: Path, name: str) -> Seen:
    if name.endswith(".csv"):
        return table(folder / name)
    if name.endswith("/"):
        return by_rosbags(folder / name, {"/level": "level", "/valve": "valve"})
    return by_mcap(folder / name)


def require_gapless(found: Seen) -> int:
    """The last instant in milliseconds, of a recording that has all before it."""
    level = found["level"]
    assert [instant for instant, _ in level] == [1_000_000 * step for step in range(1, len(level) + 1)]
    assert [value for _, (value,) in level] == [step * 1_000_000 * 1e-9 for step in range(1, len(level) + 1)] or all(
        abs(value - instant / 1e9) < 1e-9 for instant, (value,) in level
    )
    return len(level)


@pytest.mark.parametrize("options", TARGETS, ids=" ".join)
@pytest.mark.parametrize(
    ("name", "part"),
    [
        ("run.csv", "run.part.csv"),
        ("run.mcap", "run.part.mcap"),
        ("bag/", "bag.part/"),
        ("run.npz", "run.part.mcap"),
        ("run.parquet", "run.part.mcap"),
    ],
)
def test_a_killed_run_leaves_a_part_that_others_read(
    folder: Path, name: str, part: str, options: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    process = started(folder, name, *options)
    inside = folder / part / "bag_0.mcap" if part.endswith("/") else folder / part
    wait_for(inside, 50_000, process)
    # A process stops between two writes; a signal that kills it may cut one (test_mcap_reader.py).
    process.send_signal(signal.SIGSTOP)
    os.waitpid(process.pid, os.WUNTRACED)
    process.kill()
    process.communicate()
    assert not (folder / name).exists()
    assert require_gapless(seen(folder, part)) > 100
    assert main(["show", str(folder / part)]) == 1
    assert "not whole: the run was cut off; it has everything up to " in capsys.readouterr().out


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("name", ["run.csv", "run.mcap", "bag/", "run.npz", "run.parquet"])
def test_a_stopped_run_has_a_whole_recording(folder: Path, name: str, number: int) -> None:
    part = {"run.npz": "run.part.mcap", "run.parquet": "run.part.mcap", "bag/": "bag.part/bag_0.mcap"}.get(
        name, name.replace("run", "run.part")
    )
    process = started(folder, name)
    wait_for(folder / part, 50_000, process)
    process.send_signal(number)
    assert f"wrote {name}" in process.communicate()[1].decode()
    assert process.returncode == 128 + number
    assert sorted(path.name for path in folder.iterdir()) == sorted(["main.csp", name.rstrip("/")])


@pytest.mark.parametrize(
    ("first", "second"),
    [("run.mcap", "run.npz"), ("run.parquet", "run.mcap"), ("run.csv", "run.csv")],
)
def test_a_second_run_does_not_take_the_part_of_the_first(
    folder: Path, first: str, second: str, capsys: pytest.CaptureFixture[str]
) -> None:
    process = started(folder, first)
    part = "run.part.csv" if first == "run.csv" else "run.part.mcap"
    wait_for(folder / part, 50_000, process)
    assert main(["run", str(folder / "main.csp"), "--for", "1 s", "--record", f"{folder}/{second}"]) == 2
    assert "another run writes to the same recording" in capsys.readouterr().err
    process.send_signal(signal.SIGTERM)
    assert f"wrote {first}" in process.communicate()[1].decode()
    assert sorted(path.name for path in folder.iterdir()) == sorted(["main.csp", first])


def test_the_end_of_a_run_that_was_stopped_is_in_the_file(folder: Path) -> None:
    from mcap.reader import make_reader

    process = started(folder, "run.mcap")
    wait_for(folder / "run.part.mcap", 50_000, process)
    process.send_signal(signal.SIGTERM)
    process.communicate()
    with open(folder / "run.mcap", "rb") as file:
        metadata = {each.name: each.metadata for each in make_reader(file).iter_metadata()}
    assert metadata["cspdiag.end"]["ended"] == "stopped"


@pytest.mark.parametrize("options", TARGETS, ids=" ".join)
@pytest.mark.parametrize(
    ("name", "part"),
    [
        ("run.csv", "run.part.csv"),
        ("run.mcap", "run.part.mcap"),
        ("bag/", "bag.part/"),
        ("run.npz", "run.part.mcap"),
        ("run.parquet", "run.part.mcap"),
    ],
)
def test_a_full_disk_ends_the_recording_and_not_the_run(folder: Path, name: str, part: str, options: list[str]) -> None:
    process = started(folder, name, "--for", "150s", *options, limit=2_500_000)
    text = process.communicate()[1].decode()
    assert process.returncode == 2
    assert f"cspdiag: {name}: file too large; {part} has everything up to " in text
    assert "reached the time limit at 150 s" in text
    assert "wrote" not in text
    last = require_gapless(seen(folder, part))
    said = float(text.partition("up to ")[2].partition(" s")[0])
    assert 0 < last / 1000 <= said


@pytest.mark.parametrize("name", ["run.mcap", "bag/", "run.npz"])
def test_a_disk_with_less_room_than_a_block_has_what_fits(folder: Path, name: str) -> None:
    """A native run passes tens of thousands of values at a time."""
    process = started(folder, name, "--for", "150s", "--target", "c", limit=300_000)
    text = process.communicate()[1].decode()
    part = "bag.part/" if name == "bag/" else "run.part.mcap"
    last = require_gapless(seen(folder, part))
    assert last / 1000 == pytest.approx(float(text.partition("up to ")[2].partition(" s")[0]), abs=0.1)
    written = folder / part / "bag_0.mcap" if name == "bag/" else folder / part
    assert written.stat().st_size > 250_000


def test_a_full_device_is_reported(folder: Path) -> None:
    os.symlink("/dev/full", folder / "run.csv")
    process = started(folder, "run.csv", "--for", "2s")
    text = process.communicate()[1].decode()
    assert process.returncode == 2
    assert "run.csv: no space left on device" in text


def test_a_run_that_does_not_begin_leaves_nothing(folder: Path) -> None:
    (folder / "main.csp").write_text(
        LOOP.replace("plant.level -> level", "card.level -> level").replace(
            "  plant : Plant", "  plant : Plant\n  card : Card"
        )
        + '\ndriver Card python "missing.py:Card" { out level : double }\n'
    )
    for name in ("run.csv", "run.mcap", "bag/", "run.npz"):
        process = started(folder, name, "--for", "1s")
        process.communicate()
        assert process.returncode == 2 or process.returncode == 1
        assert sorted(path.name for path in folder.iterdir()) == ["main.csp"]


@pytest.mark.parametrize("name", ["run.csv", "run.mcap", "run.npz", "run.parquet", "bag/"])
def test_a_device_that_is_not_there_leaves_the_recording_of_an_earlier_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], name: str
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("main.csp").write_text(
        LOOP
        + """
driver Card python "card.py:Card" { out level : double }
environment Wired for Main { card : Card card.level -> level valve -> _ }
"""
    )
    Path("card.py").write_text("class Card:\n    def open(self):\n        raise OSError('the card is not there')\n")
    if name == "bag/":
        earlier = None
    else:
        assert main(["run", "main.csp", "--environment", "Bench", "--for", "50ms", "--record", name]) == 0
        earlier = Path(name).read_bytes()
    before = sorted(path.name for path in tmp_path.iterdir())
    capsys.readouterr()
    assert main(["run", "main.csp", "--environment", "Wired", "--for", "50ms", "--record", name]) == 1
    printed = capsys.readouterr().err
    assert "failed to open at port Main.level: OSError: the card is not there" in printed
    assert f"nothing was recorded, so {name} was not written" in printed
    assert "wrote" not in printed
    assert sorted(path.name for path in tmp_path.iterdir() if path.name != "__pycache__") == before
    assert earlier is None or Path(name).read_bytes() == earlier


def test_a_native_program_that_breaks_off_leaves_its_recording(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """As if the system had killed it."""
    from cspdiag.simulate.native import run as native

    try:
        find_compiler()
    except CompilerError as problem:
        pytest.skip(str(problem))
    (tmp_path / "drive.csp").write_text(LOOP)
    place = tmp_path / "run.csv"
    monkeypatch.setattr(native, "_outcome", lambda *_: None)
    command = ["run", str(tmp_path / "drive.csp"), "--target", "c", "--for", "50ms", "--record", str(place)]
    assert main(command) == 1
    assert f"{tmp_path / 'run.part.csv'} has what was recorded until then" in capsys.readouterr().err
    assert not place.exists()
    assert len((tmp_path / "run.part.csv").read_text().splitlines()) > 50
