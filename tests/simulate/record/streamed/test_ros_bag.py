"""What a bag says of itself when its recording broke off."""

from __future__ import annotations

import errno
import json
from pathlib import Path

import numpy
import pytest

from cspdiag.model.types import DOUBLE
from cspdiag.simulate.record.stored.described import RecordedPort, RecordingHead
from cspdiag.simulate.record.streamed.blocks import Block
from cspdiag.simulate.record.streamed.mcap import ros_bag
from cspdiag.simulate.record.streamed.mcap.ros_bag import RosBag
from cspdiag.simulate.record.streamed.part_file import PartFile
from tests.simulate.record.streamed.oracles import by_rosbags

HEAD = RecordingHead("Main", "Bench", "main.csp", (RecordedPort("level", DOUBLE, "in", 1_000_000),))
VALUES = 10


@pytest.mark.parametrize("has_room", [True, False])
def test_a_bag_that_lost_its_last_block_says_what_it_has(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, has_room: bool
) -> None:
    """There was no room for the end of the file behind that block; without it there is, perhaps also for another
    description beside the old one.
    """
    bag = RosBag(str(tmp_path / "bag"), HEAD)
    for chunk in range(2):
        time = numpy.arange(VALUES * chunk + 1, VALUES * (chunk + 1) + 1) * 1_000_000
        bag.write([Block(0, time, time / 1e9)])
    write, failed = PartFile.write, list[bool]()

    def full_once(file: PartFile, data: bytes | memoryview) -> object:
        if not failed:
            failed.append(True)
            raise OSError(errno.ENOSPC, "no space left on device")
        return write(file, data)

    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, "no space left on device")

    monkeypatch.setattr(PartFile, "write", full_once)
    if not has_room:
        monkeypatch.setattr(ros_bag.os, "replace", full)
    bag.abandon()
    folder = tmp_path / "bag.part"
    assert len(by_rosbags(folder, {"/level": "level"})["level"]) == VALUES
    about = json.loads((folder / "metadata.yaml").read_text())["rosbag2_bagfile_information"]
    assert about["message_count"] == VALUES
    assert about["topics_with_message_count"][0]["message_count"] == VALUES
    assert about["duration"]["nanoseconds"] == (VALUES - 1) * 1_000_000
    assert sorted(path.name for path in folder.iterdir()) == ["bag_0.mcap", "metadata.yaml"]
