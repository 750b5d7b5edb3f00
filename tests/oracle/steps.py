"""Steps of the programs that are written in tests of the oracle."""

from __future__ import annotations

from tests.oracle.programs.tree import INT, Lit, Port, Read, Target, Write

O = Port("o", False, INT)  # noqa: E741


def read(channel: str, variable: str = "v") -> Read:
    return Read(channel, Target(variable, INT))


def write(channel: str, value: int) -> Write:
    return Write(channel, Lit(value, INT))
