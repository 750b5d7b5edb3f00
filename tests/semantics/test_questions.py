"""What an implementation written from the language page alone had to guess: each question has a program whose trace was
worked out.

A program is a file of ``tests/conformance/programs``, or a section of ``docs/semantics.md``. The traces themselves are
compared by ``test_worked_traces`` and ``test_page``.
"""

from __future__ import annotations

import pytest

from tests.conformance.test_worked_traces import WORKED as PROGRAMS
from tests.semantics.test_page import WORKED as ON_PAGE

QUESTIONS = {
    "a law between variables is a place where a cancelled process ends": "law_is_a_place",
    "time advances while a value is latched, and then there is a deadlock": "deadlock_after_latches",
    "when a guard that writes is ready, by kind of channel": "guards_that_write",
    "two ports on one external input have sessions of their own": "sessions_of_samples",
    "an access in sequence with two parallel ones shares with the first": "sessions_of_samples",
    "sessions of a branch outlive it": "sessions_of_samples",
    "the guard of an interrupt has a session besides that of its body": "sessions_of_guards",
    "an alternative that waits begins to follow, one that chooses at once does not": "sessions_of_guards",
    "a process follows since before the latest tick, through another end": "Time-1",
    "the present tick is the latest, however long ago": "Time-1",
    "the read after a Timeout takes the latest sample": "Time-0",
    "own ends come before those of instances": "own_ends_come_first",
    "instances in the order of declaration, not of the composition": "ends_are_served_in_program_order",
    "readers and alternatives interleaved at a broadcast": "ends_are_served_in_program_order",
    "readers and alternatives interleaved at a tick": "served_at_ticks_and_events",
    "events under any by arrival": "served_at_ticks_and_events",
    "the body of an interrupt enters the ready queue": "bodies_that_never_begin",
    "cancelling finds the ended party in the ready queue": "interrupt_by_what_the_body_does_itself",
    "two interrupts that meet abandon both bodies": "Interrupts-2",
    "nested interrupts": "nested_interrupts",
    "which of two guards on one end is chosen": "two_guards_on_one_end",
    "division by zero of reals": "faults_change_nothing",
    "a variable keeps its value where a fault is caught": "Faults-0",
    "priorities are compared like words": "Turns-2",
    "all states integrate together, arrows and time change in the stages": "environment_is_one_system",
    "next is computed from the states before": "environment_is_one_system",
    "inputs of the environment are zero at first, not safe": "environment_is_one_system",
    "how channels are called": "names_of_channels",
    "a write to _ is no communication": "names_of_channels",
    "one communication for each reader of a broadcast": "Channels-0",
    "a buffer communicates when a value is put": "guards_that_write",
    "conversions to whole numbers cut off": "values_go_to_who_waits",
    "wait and after of nothing do not yield": "no_time_at_all",
    "an overwriting channel gives a value to a reader that waits": "values_go_to_who_waits",
}

WORKED = {name.rpartition("/")[2].removesuffix(".csp") for name in PROGRAMS} | {str(case.id) for case in ON_PAGE}


@pytest.mark.parametrize("place", QUESTIONS.values(), ids=QUESTIONS)
def test_question_has_a_worked_trace(place: str) -> None:
    assert place in WORKED
