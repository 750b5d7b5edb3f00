"""Damaged recordings of every format are refused by their names, and never read as something else."""

from __future__ import annotations

import random
from pathlib import Path

import numpy
import pytest

from cspdiag.model.types import BOOL, DOUBLE, INT, EnumType
from cspdiag.simulate.record.stored.described import RecordedPort, RecordingHead
from cspdiag.simulate.record.stored.open_recording import open_recording
from cspdiag.simulate.record.stored.recording import RecordingError, plain
from cspdiag.simulate.record.streamed.blocks import Block
from cspdiag.simulate.record.streamed.formats import open_writer

PORTS = (
    RecordedPort("level", DOUBLE, "in", 1_000_000),
    RecordedPort("count", INT, "in"),
    RecordedPort("mode", EnumType("Mode", ("idle", "busy")), "in"),
    RecordedPort("open", BOOL, "out", 1_000_000),
)
ROWS = 40
Values = list[tuple[list[int], list[object]]]


def written(folder: Path, name: str) -> Path:
    """The file that has the data of a recording."""
    writer = open_writer(str(folder / name) + name[len(name.rstrip("/")) :], RecordingHead("Main", "", "", PORTS))
    time = numpy.arange(1, ROWS + 1) * 1_000_000
    numbers = numpy.arange(ROWS)
    values = (numbers / 7, numbers * 3, numpy.array(numbers % 2, "i4"), numbers % 3 == 0)
    writer.write([Block(position, time, value) for position, value in enumerate(values)])
    writer.close("terminated", ROWS * 1_000_000)
    found = folder / name
    return next(found.glob("*.mcap")) if found.is_dir() else found


def values(path: Path) -> tuple[bool, Values]:
    """Whether a recording is whole, and all that is in it."""
    found = open_recording(str(path), PORTS if path.suffix == ".csv" else None)
    parts = (found.values(port.name) for port in found.head.ports)
    return found.whole, [(times.tolist(), plain(own)) for times, own in parts]


def harm(data: bytes, chance: random.Random) -> bytes:
    """The data with some bytes changed, removed, or cut off."""
    found = bytearray(data)
    place = chance.randrange(len(found))
    match chance.randrange(3):
        case 0:
            del found[place:]
        case 1:
            del found[place : place + chance.randrange(1, 60)]
        case _:
            for _ in range(chance.choice((1, 4, 30))):
                found[chance.randrange(len(found))] = chance.randrange(256)
    return bytes(found)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("name", ["run.mcap", "bag/", "run.parquet", "run.csv", "run.npz"])
def test_damage_is_refused_or_does_not_matter(tmp_path: Path, name: str) -> None:
    path = written(tmp_path, name)
    data = path.read_bytes()
    _, right = values(path)
    refusals = []
    for seed in range(100, 220):
        path.write_bytes(harm(data, random.Random(seed)))
        try:
            whole, found = values(path)
        except RecordingError as problem:
            refusals.append(str(problem))
        else:
            assert found == right or not whole or name == "run.csv", seed
    assert len(refusals) > 20
    assert all(path.name in refusal and refusal.isprintable() for refusal in refusals)


@pytest.mark.parametrize("name", ["run.mcap", "run.parquet", "run.csv", "run.npz"])
def test_an_empty_file_is_refused(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    path.touch()
    with pytest.raises(RecordingError, match=f"{name}.* is no "):
        open_recording(str(path))
