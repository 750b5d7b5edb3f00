"""Hand-written laws."""

from __future__ import annotations


class Trimmed:
    """Adds a trim, and sums up its outputs."""

    def __init__(self, *, trim: float, lag: int) -> None:
        self.trim = trim
        self.total = 0.0

    def reset(self) -> None:
        self.total = 0.0

    def calculate(self, x: float, gain: float) -> tuple[float, float]:
        y = x * gain + self.trim
        self.total += y
        return y, self.total


class Motor:
    """Keeps its own time."""

    def __init__(self, *, inertia: float) -> None:
        self.inertia = inertia
        self.angle = 0.0
        self.last = 0.0

    def calculate(self, voltage: float, time: float) -> float:
        self.angle += (voltage + 1.0) / self.inertia * (time - self.last)
        self.last = time
        return self.angle
