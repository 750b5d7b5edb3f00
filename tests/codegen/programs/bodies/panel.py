"""A device with three ports."""

from __future__ import annotations


class Panel:
    """Its button counts how often it was read."""

    def __init__(self, *, name: str, rate: int) -> None:
        self.name = name
        self.rate = rate
        self.reads = 0
        self.written: list[tuple[str, float]] = []

    def read(self, port: str) -> int:
        self.reads += 1
        return self.reads // self.rate

    def write(self, port: str, value: float) -> None:
        self.written.append((port, value))
