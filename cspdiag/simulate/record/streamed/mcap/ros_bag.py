"""ROS 2 bag folders: ``metadata.yaml`` and an MCAP file, which both are whole whenever something was written."""

from __future__ import annotations

import errno
import json
import os
from collections.abc import Sequence

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

    def discard(self) -> None:
        """See ``Writer.discard``."""
        self._file.discard()
        os.unlink(os.path.join(self._part, "metadata.yaml"))
        os.rmdir(self._part)

    def _describe(self) -> None:
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
        target = os.path.join(self._part, "metadata.yaml")
        with open(f"{target}.new", "w", encoding="utf-8") as file:
            file.write(text)
        os.replace(f"{target}.new", target)
