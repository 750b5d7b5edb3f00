"""Searches for random programs that a target does not run as the reference does, and makes them small."""

from __future__ import annotations

import re
from functools import lru_cache
from random import SystemRandom
from zlib import crc32

from cspdiag.base import SourceFile
from cspdiag.model.types import Real
from cspdiag.network.ir.network import Network
from cspdiag.semantics.trace import Execution
from tests.conformance.kit import judge
from tests.conformance.sources import JUST_AFTER, InvalidProgramError, network_of
from tests.conformance.targets import REFERENCE, Target
from tests.properties.drawing import draw_programs

LIMIT = 60_000_000 + JUST_AFTER
"""How long a random program runs, in nanoseconds."""

A_START = 15
"""How many programs are drawn from one start."""


class DifferenceFoundError(Exception):
    """A program, and how it differs."""


@lru_cache(maxsize=64)
def _network(text: str, real: Real) -> Network:
    return network_of(SourceFile(name="random.csp", text=text), real)


@lru_cache(maxsize=64)
def _done_by_reference(text: str, real: Real) -> Execution:
    """This is the same for every target: all are compared on the same programs."""
    return REFERENCE.run(_network(text, real), None, LIMIT)


def hunt(
    target: Target, count: int, start: int | None = None, *, shrink: bool = True, real: Real = "double"
) -> str | None:
    """The smallest program found that differs, with the difference; None if none of ``count`` programs differs."""

    def look(text: str) -> None:
        text = with_parameters(text)
        details = difference_of(target, text, real)
        if details:
            raise DifferenceFoundError(f"{text}\n{details}")

    first = SystemRandom().randrange(2**32) if start is None else start
    try:
        for number in range(0, count, A_START):
            draw_programs(look, min(A_START, count - number), first + number // A_START, shrink=shrink)
    except DifferenceFoundError as found:
        return str(found)
    return None


def with_parameters(text: str) -> str:
    """The program, in a third of them with its named constants as parameters, which then change while it runs."""
    if crc32(text.encode()) % 3:
        return text
    return re.sub(
        r"^const (gain|pause) *= (.*)$",
        lambda found: f"parameter {found[1]} : {'time' if found[1] == 'pause' else 'double'} = {found[2]}",
        text,
        flags=re.MULTILINE,
    )


def difference_of(target: Target, text: str, real: Real = "double") -> str:
    """How a program differs; empty if it does not, or if the target does not support such a program, or single
    precision does not have its numbers.
    """
    try:
        network = _network(text, real)
    except InvalidProgramError:
        if real == "double":
            raise
        return ""
    verdict = judge(target, network, None, LIMIT, expected=_done_by_reference(text, real))
    return verdict.details if verdict.result in ("differs", "crashed") else ""
