"""What a run tells about itself."""

from __future__ import annotations

from typing import Any


class Observer:
    """Told of what happens in a run; subclasses override what they want to know.

    Times are nanoseconds, channels and paths are hierarchical names; ``writer`` and ``reader`` are ``""`` for the
    environment.
    """

    wants_communications: bool = True
    """Whether to be told of communications at all."""

    communication_log: list[Any] | None = None
    """Where an observer gives a list, it is extended by the arguments of ``communication`` instead of a call, which is
    faster.
    """

    def communication(self, time: int, channel: str, value: Any, writer: str, reader: str) -> None:
        """A value has passed through an external port or a channel that is not a variable."""

    sample_log: list[Any] | None = None
    """Where an observer gives a list, it is extended by the time, the port and the value of every sample of a sampled
    input, read or not.
    """

    def process_started(self, time: int, path: str, class_name: str) -> None:
        """A process that is no submodel begins."""

    def process_ended(self, time: int, path: str) -> None:
        """It has ended, in whatever way."""

    def group_started(self, time: int, path: str) -> None:
        """A labelled part begins."""

    def group_ended(self, time: int, path: str) -> None:
        """It has ended, in whatever way."""

    def released(self, time: int, port: str, value: Any) -> None:
        """An output of the outermost process was handed its safe value at the end of the run."""
