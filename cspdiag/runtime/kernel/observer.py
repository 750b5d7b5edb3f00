"""What a run tells about itself."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


class Observer:
    """Notified of what happens in a run; subclasses override the methods that they need.

    Times are nanoseconds, channels and paths are hierarchical names; ``writer`` and ``reader`` are ``""`` for the
    environment.
    """

    wants_communications: bool = True
    """Whether ``communication`` is to be called at all."""

    communication_log: list[Any] | None = None
    """If this is a list, the arguments of ``communication`` are added to it instead of a call, which is faster."""

    def communication(self, time: int, channel: str, value: Any, writer: str, reader: str) -> None:
        """A value has passed through an external port or a channel that is not a variable."""

    sample_log: list[Any] | None = None
    """If this is a list, the time, the port and the value of every sample of a sampled input are added to it, whether
    read or not.
    """

    port_logs: Mapping[str, tuple[Any, Any]] | None = None
    """If this is a mapping, only what external ports show is noted, which is faster still: the instants and the values
    are added to the two sequences of each port. Those of a sampled input are its samples, read or not.
    """

    def process_started(self, time: int, path: str, class_name: str) -> None:
        """A process that is not a submodel begins."""

    def process_ended(self, time: int, path: str) -> None:
        """It has ended, in whatever way."""

    def group_started(self, time: int, path: str) -> None:
        """A labelled part begins."""

    def group_ended(self, time: int, path: str) -> None:
        """It has ended, in whatever way."""

    def released(self, time: int, port: str, value: Any) -> None:
        """An output of the outermost process was handed its safe value at the end of the run."""

    def changed(self, time: int, parameter: str, path: tuple[int, ...], value: Any) -> None:
        """A parameter of the program, or the part of it at a path of positions, has a new value."""
