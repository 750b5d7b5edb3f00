"""Programs whose transition system would be too large are refused in one line."""

from __future__ import annotations

import pytest

from cspdiag.analyses.transitions import assembly, explore
from cspdiag.analyses.transitions.explore import TransitionError
from tests.analyses.transitions.building import system_of

ANY = (
    "process P { out c : int composition { mu (c ! 1) } }\n"
    "process Q { in c : int communication { var x : int } composition { mu (c ? x) } }\n"
    "process Main { communication { p[3] : P q[3] : Q channel c : int any for i < 3 { p[i].c -> c  c -> q[i].c } }"
    " composition { (par i < 3 : p[i]) || (par i < 3 : q[i]) } }"
)
LONG = "process Main { out b : int composition { seq i < 100 : b ! i } }"
COUNTS = (
    "process Main { out b : int communication { var n : int = 0 var m : int = 0 }"
    " composition { mu (b ! 1 ; m := m + 1 ; if m == 10 then (m := 0 ; n := n + 1)) until n == 30 } }"
)


def test_too_many_meetings_on_one_channel(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(assembly, "MOST_MEETINGS", 8)
    with pytest.raises(TransitionError, match=r"^on `Main.c` 9 ways to communicate") as refused:
        system_of(ANY)
    assert "\n" not in str(refused.value)


def test_too_many_states_of_one_process(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(explore, "MANY_STATES", 20)
    assert len(system_of(LONG).components[0].edges) == 101
    monkeypatch.setattr(explore, "MOST_STATES", 50)
    with pytest.raises(TransitionError, match=r"^`Main` has more than 50 states") as refused:
        system_of(LONG)
    assert "\n" not in str(refused.value)


def test_values_are_given_up_before_a_process_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    assert len(system_of(COUNTS).components[0].edges) == 301
    monkeypatch.setattr(explore, "MANY_STATES", 100)
    system = system_of(COUNTS)
    assert len(system.components[0].edges) <= 31
    assert any("`n`" in abstraction.what for abstraction in system.abstractions)
