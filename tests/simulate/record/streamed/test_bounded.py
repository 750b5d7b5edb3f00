"""What waits to be written is bounded, however long a run is and however much it passes."""

from __future__ import annotations

from pathlib import Path

import numpy
import pytest

from cspdiag.cli.main import main
from cspdiag.model.types import DOUBLE
from cspdiag.simulate.native.build import CompilerError, find_compiler
from cspdiag.simulate.record.stored.described import RecordedPort, RecordingHead
from cspdiag.simulate.record.streamed.blocks import Block, Pending
from cspdiag.simulate.record.streamed.recording import Recording
from tests.simulate.record.streamed.test_ends import LOOP


@pytest.mark.parametrize("options", [["-O0"], [], ["--target", "c"]], ids=" ".join)
@pytest.mark.parametrize("ending", ["csv", "mcap", "npz", "parquet"])
def test_a_longer_run_keeps_no_more(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, options: list[str], ending: str
) -> None:
    if "c" in options:
        try:
            find_compiler()
        except CompilerError as problem:
            pytest.skip(str(problem))
    (tmp_path / "main.csp").write_text(LOOP)
    taken: list[int] = []
    before = Pending.before

    def counted(self: Pending, instant: int | None) -> list[Block]:
        blocks = before(self, instant)
        taken.append(sum(len(block.time) for block in blocks))
        return blocks

    monkeypatch.setattr(Pending, "before", counted)
    command = ["run", str(tmp_path / "main.csp"), "--quiet", "--record", str(tmp_path / f"run.{ending}"), *options]
    assert main([*command, "--for", "100s"]) == 0
    assert sum(taken) == 200_000
    assert max(taken) <= 3 << 15, "two megabytes of rows, and one that was just read"
    assert len(taken) >= 3


class _Full:
    """A writer whose disk is full after some blocks."""

    can_retry = False

    def __init__(self, blocks: int) -> None:
        self.blocks = blocks
        self.closed = self.abandoned = 0

    def write(self, blocks: list[Block]) -> None:
        self.blocks -= 1
        if self.blocks < 0:
            raise OSError(28, "No space left on device")

    def close(self, ended: str, time: int) -> None:
        self.closed += 1

    def abandon(self) -> None:
        self.abandoned += 1

    def discard(self) -> None:
        raise AssertionError


def test_nothing_is_kept_for_a_file_that_is_full() -> None:
    reported: list[tuple[str, int]] = []
    writer = _Full(2)
    head = RecordingHead("Main", "Bench", "main.csp", (RecordedPort("level", DOUBLE, "in", 1_000_000),))
    recording = Recording(head, writer, on_problem=lambda problem, until: reported.append((str(problem), until)))
    for step in range(1, 100):
        recording.add("Main.level", numpy.array([step]), numpy.array([0.5]))
        recording.pass_time(step + 1)
    recording.finish("terminated", 100, [])
    assert reported == [("[Errno 28] No space left on device", 2)]
    assert (writer.closed, writer.abandoned) == (0, 1)


def test_a_slow_disk_does_not_delay_a_run_against_the_clock_and_is_reported() -> None:
    import threading

    reported: list[str] = []
    proceed = threading.Event()

    class Slow(_Full):
        def write(self, blocks: list[Block]) -> None:
            proceed.wait()

    head = RecordingHead("Main", "Bench", "main.csp", (RecordedPort("level", DOUBLE, "in", 1_000_000),))
    recording = Recording(
        head, Slow(0), on_problem=lambda problem, _: reported.append(str(problem.strerror)), background=True
    )
    for step in range(1, 1000):
        recording.add("Main.level", numpy.array([step]), numpy.array([0.5]))
        recording.pass_time(step + 1)
    assert reported == ["the disk is slower than the run"]
    proceed.set()
    recording.finish("terminated", 1000, [])
