"""The last instant of all runs, after 292 years: what would come later does not."""

from __future__ import annotations

import pytest

from tests.conformance.kit import parsed
from tests.conformance.targets import REFERENCE, TARGETS, Target

NAME = "tests/conformance/programs/the_end_of_time.csp"
LAST = 9_223_372_036 * 10**9


@pytest.mark.parametrize("target", [REFERENCE, *TARGETS.values()], ids=lambda target: target.name)
def test_runs_end_at_the_last_instant(target: Target) -> None:
    why = target.unavailable()
    if why is not None:
        pytest.skip(why)
    execution = target.run(parsed(NAME), None, 2**63 - 1)
    reached = [(time, channel, value) for time, channel, value, *_ in execution.trace]
    assert reached == [
        (9 * 10**18, "Waits.reached[0]", 9 * 10**18),
        (LAST, "Waits.reached[2]", LAST),
    ]
    assert execution.ending[:2] == ("time limit", LAST)
