"""Looks for random programs that a target does not run as the reference does, and makes them small."""

from __future__ import annotations

from hypothesis import HealthCheck, Phase, given, seed, settings

from cspdiag.diagnostics import SourceFile
from tests.conformance.kit import judge
from tests.conformance.sources import JUST_AFTER, network_of
from tests.conformance.targets import Target
from tests.properties.encounters import encounters
from tests.properties.programs import programs

LIMIT = 60_000_000 + JUST_AFTER
"""Nanoseconds that a random program runs."""


def hunt(target: Target, count: int, start: int | None = None) -> str | None:
    """The smallest program found that differs, with how it does; None where none of so many does."""
    failures: list[str] = []

    @settings(
        max_examples=count,
        deadline=None,
        database=None,
        derandomize=False,
        phases=(Phase.generate, Phase.shrink),
        suppress_health_check=list(HealthCheck),
    )
    @given(programs() | encounters())
    def search(text: str) -> None:
        details = difference_of(target, text)
        if details:
            failures.append(f"{text}\n{details}")
        assert not details

    try:
        (search if start is None else seed(start)(search))()
    except AssertionError:
        return failures[-1]
    return None


def difference_of(target: Target, text: str) -> str:
    """How a program differs; empty where it does not, or where the target takes no such program."""
    network = network_of(SourceFile(name="random.csp", text=text))
    verdict = judge(target, network, None, LIMIT)
    return verdict.details if verdict.result in ("differs", "crashed") else ""
