"""What the language leaves open, as questions that a run asks: the policy's answers choose the run."""

from __future__ import annotations

from typing import Protocol

from tests.oracle.programs.tree import Law, Port, Value


class Policy(Protocol):
    fine: bool  # others may run after each communication, not only when a process waits
    free: bool  # `[]` may choose any guard that is ready; otherwise it is fair as the page says

    def choose(self, count: int) -> int:
        """Choose one of `count` ways."""
        ...

    def compute(self, law: Law) -> int:
        """How long one run of a law computes, in nanoseconds."""
        ...

    def sample(self, port: Port, now: int) -> Value:
        """The value that the environment has at a sampled input."""
        ...

    def event(self, port: Port, now: int, last: Value) -> Value | None:
        """A new value that the environment offers at an instant of its grid."""
        ...

    def before(self, port: Port) -> Value | None:
        """An event that arrived just before a process checks for it."""
        ...

    def passed(self, channel: str, value: Value, external: bool) -> None:
        """A communication took place."""
        ...


def from_table(port: Port, now: int) -> Value:
    """The value at an instant of the environment that is printed with the program."""
    value = port.values[0][1]
    for begin, later in port.values:
        if now >= begin:
            value = later
    return value


class Unwitnessed:
    """The simplest answers: laws take no time, the environment is the one that is printed."""

    fine = False
    free = False

    def choose(self, count: int) -> int:
        return 0

    def compute(self, law: Law) -> int:
        return 0

    def sample(self, port: Port, now: int) -> Value:
        return from_table(port, now)

    def event(self, port: Port, now: int, last: Value) -> Value | None:
        value = from_table(port, now)
        return None if value == last else value

    def before(self, port: Port) -> Value | None:
        return None

    def passed(self, channel: str, value: Value, external: bool) -> None:
        pass
