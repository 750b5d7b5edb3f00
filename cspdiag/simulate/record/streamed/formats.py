"""The formats of recordings, by the ending of their names."""

from __future__ import annotations

import os
from importlib.util import find_spec
from typing import TYPE_CHECKING, Literal

from cspdiag.base.errors import ArgumentError, missing_package
from cspdiag.simulate.record.stored.described import RecordingHead
from cspdiag.simulate.record.streamed.blocks import Writer
from cspdiag.simulate.record.streamed.part_file import PartFile, part_name

if TYPE_CHECKING:
    from cspdiag.simulate.record.stored.recording import StoredRecording

ENDINGS = (".csv", ".npz", ".mcap", ".parquet")
FOLDER = "/"
"""What a name ends in that is a ROS 2 bag folder."""
Encoding = Literal["ros2", "json"]


def is_bag(name: str) -> bool:
    """Whether a recording of this name is a ROS 2 bag folder."""
    return name.endswith((FOLDER, os.sep))


def require_format(name: str) -> None:
    """Raise ArgumentError for a name that no format has, MissingPackageError if a package for it is missing."""
    ending = os.path.splitext(name)[1]
    if is_bag(name):
        return
    if ending not in ENDINGS:
        raise ArgumentError(f"a recording ends in {', '.join(ENDINGS)}, or in / for a ROS 2 bag folder: {name}")
    if ending == ".parquet" and find_spec("pyarrow") is None:
        raise missing_package("pyarrow", "parquet")


def open_writer(name: str, head: RecordingHead, encoding: Encoding = "ros2") -> Writer:
    """What writes a recording of this name. Raises as ``require_format`` does, and OSError."""
    require_format(name)
    if is_bag(name):
        from cspdiag.simulate.record.streamed.mcap.ros_bag import RosBag

        return RosBag(name, head)
    ending = os.path.splitext(name)[1]
    if ending == ".csv":
        from cspdiag.simulate.record.streamed.table import Table

        return Table(PartFile(name), head)
    if ending == ".mcap":
        from cspdiag.simulate.record.streamed.mcap.mcap_file import McapRecording

        return McapRecording(PartFile(name), head, encoding)
    from cspdiag.simulate.record.streamed.journal import Journal

    if ending == ".npz":
        from cspdiag.simulate.record.streamed.archive import write_archive

        return Journal(name, head, write_archive)
    from cspdiag.simulate.record.streamed.parquet import write_parquet

    return Journal(name, head, write_parquet)


def save(recording: StoredRecording, name: str) -> None:
    """Write a stored recording under another name, by way of a file that is none of its parts. Raises as
    ``open_writer`` does.
    """
    require_format(name)
    aside = f"{os.path.realpath(name.rstrip(os.sep))}.saving"
    ending = os.path.splitext(name)[1]
    if not is_bag(name) and ending in (".npz", ".parquet"):
        from cspdiag.simulate.record.streamed.archive import write_archive
        from cspdiag.simulate.record.streamed.parquet import write_parquet

        file = PartFile(name, aside)
        try:
            (write_archive if ending == ".npz" else write_parquet)(recording, file)
        except BaseException:
            file.discard()
            raise
        file.put_in_place()
        return
    from cspdiag.simulate.record.streamed.mcap.mcap_file import McapRecording
    from cspdiag.simulate.record.streamed.mcap.ros_bag import RosBag
    from cspdiag.simulate.record.streamed.table import Table

    writer: Writer
    if is_bag(name):
        writer = RosBag(name, recording.head, aside)
    elif ending == ".csv":
        writer = Table(PartFile(name, aside), recording.head)
    else:
        writer = McapRecording(PartFile(name, aside), recording.head, "ros2")
    try:
        for blocks in recording.blocks():
            writer.write(blocks)
        writer.close(recording.ended or "incomplete", recording.time)
    except BaseException:
        writer.discard()
        raise


def part_of(name: str) -> str:
    """Where the recording is while it is not whole, as messages name it."""
    if is_bag(name):
        return f"{name.rstrip(os.sep)}.part{os.sep}"
    ending = os.path.splitext(name)[1]
    return part_name(name, ".mcap" if ending in (".npz", ".parquet") else None)
