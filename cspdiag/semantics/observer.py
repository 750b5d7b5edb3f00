"""The observer of a run."""

from __future__ import annotations

from typing import Protocol


class Observer(Protocol):
    """Is notified of everything that happens, in order; times are in nanoseconds. «Traces»"""

    def communication(self, time: int, channel: str, value: object, writer: str, reader: str) -> None:
        """A value passed through a channel or an external port.

        ``writer`` and ``reader`` are the paths of the processes, empty for the environment and for buffers.
        """

    def sampled(self, time: int, port: str, value: object) -> None:
        """A sampled input has a new sample. «Time»"""

    def released(self, time: int, port: str, value: object) -> None:
        """An output is set to its safe value at the end of the run. «Processes and ports»"""

    def process_started(self, time: int, path: str, kind: str) -> None:
        """A process of the class ``kind`` begins, or a named group, for which ``kind`` is empty. «The composition
        diagram»
        """

    def process_ended(self, time: int, path: str) -> None:
        """A process or a named group has ended. «The composition diagram»"""

    def changed(self, time: int, parameter: str, path: tuple[int, ...], value: object) -> None:
        """A parameter of the program, or the part of it at a path of positions, has a new value. «Parameters»"""

    def refused_change(self, time: int, parameter: str, reason: str) -> None:
        """A change was not made, because of the value that it gives, or of what follows from that. «Parameters»"""
