"""What specifications allow for single runs: agreement with the search over all of them, and values that a proof leaves
open.
"""

from __future__ import annotations

import pytest

from cspdiag.proofs.refine.allowed import RunEnd, violation
from cspdiag.proofs.refine.labels import Label, Labels
from cspdiag.proofs.refine.words import forbidden_refusal
from cspdiag.proofs.transitions.systems.system import Component, Event, System
from cspdiag.proofs.verdict import LimitError, Limits
from tests.proofs.systems.known import compose, cycle

ONE_PLACE = compose([cycle("buffer", "accept", "deliver")], visible=["accept", "deliver"])

LAMP = System(
    (Component("Lamp", (((0, 1), (1, 0)), ((1, 0),)), frozenset({0})),),
    (
        Event("Lamp.level", (0,), "external", "on", visible=True),
        Event("Lamp.level", (0,), "external", "off", visible=True),
    ),
)
"""It is switched on and off, and never on twice; it may end when it is off."""

ENDED = RunEnd(ended=True)
BUSY = RunEnd(ended=False)


def violation_of(
    specification: System,
    trace: list[Label],
    rest: RunEnd = BUSY,
    *,
    hidden: tuple[str, ...] = (),
    failures: bool = False,
) -> str | None:
    return violation(specification, Labels(specification, hidden), trace, rest, Limits(), failures=failures)


def test_a_run_that_is_a_trace_of_the_specification_does_nothing_wrong() -> None:
    assert violation_of(ONE_PLACE, []) is None
    assert violation_of(ONE_PLACE, [("accept", None), ("deliver", None), ("accept", None)]) is None


def test_a_run_that_does_too_much_is_reported_with_what_was_allowed() -> None:
    reported = violation_of(ONE_PLACE, [("accept", None), ("accept", None)])
    assert reported == "it does `accept`, where the specification allows only `deliver`"


def test_the_value_decides_if_the_specification_distinguishes_values() -> None:
    assert violation_of(LAMP, [("level", "off"), ("level", "on")]) is None
    reported = violation_of(LAMP, [("level", "on"), ("level", "on")])
    assert reported == "it does `level.on`, where the specification allows only `level.off`"


def test_an_end_is_judged_by_the_end_of_the_specification() -> None:
    reported = violation_of(LAMP, [("level", "on")], ENDED)
    assert reported == "it ends, where the specification allows only `level.off`"
    assert violation_of(ONE_PLACE, [("accept", None)], ENDED) is not None


def test_a_refusal_counts_in_failures_and_at_rest_only() -> None:
    rest = RunEnd(ended=False, offers=frozenset({("accept", None)}))
    trace: list[Label] = [("accept", None)]
    assert violation_of(ONE_PLACE, trace, rest) is None
    assert violation_of(ONE_PLACE, trace, BUSY, failures=True) is None
    reported = violation_of(ONE_PLACE, trace, rest, failures=True)
    assert reported == "it refuses `deliver` and offers only `accept`, where the specification demands `deliver`"
    assert violation_of(ONE_PLACE, [], rest, failures=True) is None


def test_a_process_that_offers_any_value_offers_each() -> None:
    any_value = RunEnd(ended=False, offers=frozenset({("level", None)}))
    one_value = RunEnd(ended=False, offers=frozenset({("level", "on")}))
    on: list[Label] = [("level", "on")]
    assert violation_of(LAMP, on, any_value, failures=True) is None
    reported = violation_of(LAMP, on, one_value, failures=True)
    assert reported == "it refuses `level.off` and offers only `level.on`, where the specification demands `level.off`"


def test_the_limits_hold() -> None:
    with pytest.raises(LimitError):
        violation(ONE_PLACE, Labels(ONE_PLACE), [], BUSY, Limits(seconds=-1.0), failures=False)


def test_an_unknown_value_may_be_the_wrong_one() -> None:
    reported = forbidden_refusal({("level", None)}, [{("level", "on")}])
    assert reported == "it refuses `level.on` and offers only `level`, where the specification demands `level.on`"
