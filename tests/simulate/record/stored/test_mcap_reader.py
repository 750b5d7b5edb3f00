"""MCAP files that were cut or damaged are read up to the last whole chunk, or refused."""

from __future__ import annotations

from pathlib import Path

import numpy
import pytest

from cspdiag.model.types import DOUBLE, INT
from cspdiag.simulate.record.stored.described import RecordedPort, RecordingHead
from cspdiag.simulate.record.stored.mcap_reader import open_mcap
from cspdiag.simulate.record.stored.open_recording import open_recording
from cspdiag.simulate.record.stored.recording import RecordingError
from cspdiag.simulate.record.streamed.blocks import Block
from cspdiag.simulate.record.streamed.formats import open_writer
from cspdiag.simulate.record.streamed.mcap.mcap_file import McapRecording
from cspdiag.simulate.record.streamed.part_file import PartFile

HEAD = RecordingHead("Main", "Bench", "main.csp", (RecordedPort("level", DOUBLE, "in", 1_000_000),))
VALUES = 10


@pytest.fixture
def whole(tmp_path: Path) -> Path:
    path = tmp_path / "run.mcap"
    writer = McapRecording(PartFile(str(path)), HEAD, "ros2")
    for chunk in range(3):
        time = numpy.arange(VALUES * chunk + 1, VALUES * (chunk + 1) + 1) * 1_000_000
        writer.write([Block(0, time, time / 1e9)])
    writer.close("terminated", 30_000_000)
    return path


def test_a_whole_file_has_its_end(whole: Path) -> None:
    found = open_mcap(str(whole))
    assert (found.whole, found.ended, found.time) == (True, "terminated", 30_000_000)
    assert found.head == HEAD
    time, value = found.values("level")
    assert time.tolist() == [1_000_000 * step for step in range(1, 31)]
    assert value.tolist() == [step / 1000 for step in range(1, 31)]


def test_a_file_that_is_cut_anywhere_has_its_whole_chunks(whole: Path) -> None:
    data = whole.read_bytes()
    counts = []
    for size in range(len(data)):
        whole.write_bytes(data[:size])
        try:
            found = open_mcap(str(whole))
        except RecordingError:
            continue
        counts.append(len(found.values("level")[0]))
        assert found.whole == (found.ended != "")
    assert sorted(set(counts)) == [0, VALUES, 2 * VALUES, 3 * VALUES]
    assert counts == sorted(counts)


def test_a_damaged_chunk_is_refused(whole: Path) -> None:
    data = bytearray(whole.read_bytes())
    at = data.index(b"\0\1\0\0")  # The beginning of a message.
    data[at + 6] ^= 1
    whole.write_bytes(data)
    with pytest.raises(RecordingError, match="does not fit its checksum"):
        open_mcap(str(whole)).values("level")


@pytest.mark.parametrize("data", [b"", b"time,x\n1,2\n", b"\x89MCAP0\r\n"])
def test_what_is_no_recording_is_refused(tmp_path: Path, data: bytes) -> None:
    path = tmp_path / "other.mcap"
    path.write_bytes(data)
    with pytest.raises(RecordingError, match=r"other\.mcap is"):
        open_mcap(str(path))


@pytest.mark.parametrize(
    ("name", "old", "new"),
    [
        ("run.mcap", b'"process"', b'"pro\xffess"'),
        ("run.mcap", b'{"value":', 9 * b"["),
        ("run.csv", b"0.003,", b"inf,"),
        ("run.csv", b"0.003,", b"1e300,"),
        ("run.csv", b"0.003,3", b"0.003," + 400 * b"3"),
    ],
)
def test_a_damaged_file_of_any_format_is_refused_with_its_name(
    tmp_path: Path, name: str, old: bytes, new: bytes
) -> None:
    path = tmp_path / name
    head = RecordingHead("Main", "Bench", "main.csp", (RecordedPort("count", INT, "in", 1_000_000),))
    time = numpy.arange(1, VALUES) * 1_000_000
    writer = open_writer(str(path), head, "json")
    writer.write([Block(0, time, time // 1_000_000)])
    writer.close("terminated", 30_000_000)
    data = path.read_bytes()
    assert old in data
    path.write_bytes(data.replace(old, new))
    with pytest.raises(RecordingError, match=name):
        open_recording(str(path), head.ports if name == "run.csv" else None).values("count")
