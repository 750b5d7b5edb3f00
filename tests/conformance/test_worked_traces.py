"""Programs whose traces were worked out from the language reference: they end in lines ``//> 1 ms Top.channel value``
and ``//> terminated at 1 ms``.

``test_targets`` checks that all other targets do the same as the reference.
"""

from __future__ import annotations

import re

import pytest

from cspdiag.semantics.trace import Execution
from tests.conformance.kit import parsed
from tests.conformance.sources import JUST_AFTER, PROGRAMS, read
from tests.conformance.targets import READABLE, REFERENCE, TARGETS, Target

_LINE = re.compile(r"^//> (.*)$", re.MULTILINE)

WORKED = {name: worked for name in PROGRAMS if (worked := _LINE.findall(read(name).text))}


def trace_lines(execution: Execution) -> list[str]:
    """An execution in the notation of the programs; values as the language writes them."""
    lines = [f"{_milliseconds(time)} {channel} {_value(value)}" for time, channel, value, *_ in execution.trace]
    return [*lines, f"{execution.ending.ended} at {_milliseconds(execution.ending.time)}"]


def _milliseconds(time: int) -> str:
    return f"{time / 1e6:g} ms"


def _value(value: object) -> str:
    return str(value).lower() if isinstance(value, bool) else repr(value)


@pytest.mark.parametrize("target", [REFERENCE, READABLE], ids=["meaning", "readable code"])
@pytest.mark.parametrize("name", WORKED)
def test_the_trace_is_the_worked_one(name: str, target: Target) -> None:
    assert trace_lines(target.run(parsed(name), None, 100_000_000 + JUST_AFTER)) == WORKED[name]


LAST = 9_223_372_036 * 10**9
"""The last instant of all runs in virtual time, after 292 years: nothing happens later."""


@pytest.mark.parametrize("target", [REFERENCE, *TARGETS.values()], ids=lambda target: target.name)
def test_runs_end_at_the_last_instant(target: Target) -> None:
    why = target.unavailable()
    if why is not None:
        pytest.skip(why)
    execution = target.run(parsed("tests/conformance/programs/the_end_of_time.csp"), None, 2**63 - 1)
    reached = [(time, channel, value) for time, channel, value, *_ in execution.trace]
    assert reached == [
        (9 * 10**18, "Waits.reached[0]", 9 * 10**18),
        (LAST, "Waits.reached[2]", LAST),
    ]
    assert execution.ending[:2] == ("time limit", LAST)


def test_there_are_such_programs() -> None:
    assert len(WORKED) >= 10
