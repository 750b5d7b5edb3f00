"""ROS 2 bag folders: ``metadata.yaml`` and an MCAP file, which both are whole whenever something was written."""

from __future__ import annotations

import errno
import json
import os
from collections.abc import Sequence
from contextlib import suppress

from cspdiag.simulate.record.stored.described import RecordingHead
from cspdiag.simulate.record.streamed.blocks import Block
from cspdiag.simulate.record.streamed.mcap.mcap_file import McapFile
from cspdiag.simulate.record.streamed.mcap.messages import message_of, topics
from cspdiag.simulate.record.streamed.part_file import PartFile

_VERSION = 5
"""Of the metadata: that of ROS 2 Humble, which later ones read."""


class RosBag:
    """See ``Writer``. The folder is new: as ``ros2 bag record`` does, it replaces none."""

    def __init__(self, path: str, head: RecordingHead, part: str | None = None) -> None:
        self._path = path.rstrip(os.sep)
        if os.path.lexists(self._path):
            raise FileExistsError(errno.EEXIST, "is there already, and bags are not overwritten", path)
        self._part = f"{self._path}.part" if part is None else part
        os.makedirs(self._part, exist_ok=True)
        self._head = head
        self.can_retry = True
        """See ``Writer.can_retry``: not if the values are written and their description fails."""
        self._name = f"{os.path.basename(self._path)}_0.mcap"
        inside = os.path.join(self._part, self._name)
        self._file = PartFile(inside, inside)
        self._mcap = McapFile(self._file, head, "ros2")
        self._describe()

    def write(self, blocks: Sequence[Block]) -> None:
        """See ``Writer.write``."""
        self._mcap.write(blocks)
        self.can_retry = False
        self._describe()
        self.can_retry = True

    def close(self, ended: str, time: int) -> None:
        """See ``Writer.close``."""
        self._mcap.close(ended, time)
        self._file.close()
        self._describe()
        os.rename(self._part, self._path)

    def abandon(self) -> None:
        """See ``Writer.abandon``."""
        self._mcap.abandon()
        self._file.close()
        try:
            self._describe()
        except OSError:
            # There is no room for another file. What is left needs no more room than what was described.
            self._write_description(self._description)

    def discard(self) -> None:
        """See ``Writer.discard``."""
        self._file.discard()
        os.unlink(self._description)
        os.rmdir(self._part)

    @property
    def _description(self) -> str:
        return os.path.join(self._part, "metadata.yaml")

    def _describe(self) -> None:
        """Replaces the description by one of what is in the file now."""
        new = f"{self._description}.new"
        try:
            self._write_description(new)
            os.replace(new, self._description)
        except OSError:
            with suppress(FileNotFoundError):
                os.unlink(new)
            raise

    def _write_description(self, path: str) -> None:
        """Without emptying it before: an old description that is replaced leaves its room to the new one."""
        first, last = self._mcap.span
        counts = self._mcap.counts
        span = {
            "duration": {"nanoseconds": last - first},
            "starting_time": {"nanoseconds_since_epoch": first},
            "message_count": sum(counts.values()),
        }
        about = {
            "version": _VERSION,
            "storage_identifier": "mcap",
            **span,
            "topics_with_message_count": [
                {
                    "topic_metadata": {
                        "name": topic,
                        "type": message_of(port.type).name,
                        "serialization_format": "cdr",
                        "offered_qos_profiles": "",
                    },
                    "message_count": counts[position],
                }
                for position, (port, topic) in enumerate(
                    zip(self._head.ports, topics([port.name for port in self._head.ports]), strict=True)
                )
            ],
            "compression_format": "",
            "compression_mode": "",
            "relative_file_paths": [self._name],
            "files": [{"path": self._name, **span}],
        }
        # JSON is YAML, too.
        text = json.dumps({"rosbag2_bagfile_information": about}, indent=2) + "\n"
        with open(os.open(path, os.O_WRONLY | os.O_CREAT, 0o666), "w", encoding="utf-8") as file:
            file.write(text)
            file.truncate()
