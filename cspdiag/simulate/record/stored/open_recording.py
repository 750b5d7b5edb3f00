"""Opens a recording, whatever its format."""

from __future__ import annotations

import os
from collections.abc import Sequence

from cspdiag.simulate.record.stored.described import RecordedPort
from cspdiag.simulate.record.stored.mcap_reader import open_mcap
from cspdiag.simulate.record.stored.recording import RecordingError, StoredRecording, reading
from cspdiag.simulate.record.stored.tables import open_archive, open_parquet, open_table


def open_recording(path: str, ports: Sequence[RecordedPort] | None = None) -> StoredRecording:
    """The recording in a file or a bag folder; the columns of a table are those of ``ports``, if they are given.

    Raises RecordingError, MissingPackageError, and OSError.
    """
    with reading(path):
        return _opened(path, ports)


def _opened(path: str, ports: Sequence[RecordedPort] | None) -> StoredRecording:
    if os.path.isdir(path):
        return _opened_bag(path)
    ending = os.path.splitext(path)[1]
    match ending:
        case ".mcap":
            return open_mcap(path)
        case ".csv":
            return open_table(path, ports)
        case ".npz":
            return open_archive(path)
        case ".parquet":
            return open_parquet(path)
        case _:
            raise RecordingError(
                f"{path} is no recording: those end in .mcap, .csv, .npz or .parquet, or are bag folders"
            )


def _opened_bag(path: str) -> StoredRecording:
    files = sorted(name for name in os.listdir(path) if name.endswith(".mcap"))
    if not files:
        raise RecordingError(f"{path} is no bag folder with an MCAP file: bags with other storage are not read")
    if len(files) > 1:
        raise RecordingError(f"{path} has several MCAP files: name the one that is meant")
    found = open_mcap(os.path.join(path, files[0]))
    return StoredRecording(
        path, "ROS 2 bag folder", found.head, found.read, found.whole, found.ended, found.time, found.typed
    )
