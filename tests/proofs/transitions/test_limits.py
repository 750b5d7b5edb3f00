"""Programs whose transition system would be too large are refused in one line."""

from __future__ import annotations

import pytest

from cspdiag.proofs.transitions import channel_events
from cspdiag.proofs.transitions.threads import explore
from cspdiag.proofs.transitions.threads.explore import TransitionError
from cspdiag.proofs.transitions.threads.silent.follow import Follower
from cspdiag.proofs.transitions.threads.thread import Configuration
from tests.proofs.transitions.building import system_of

ANY = (
    "process P { out c : int composition { mu (c ! 1) } }\n"
    "process Q { in c : int communication { var x : int } composition { mu (c ? x) } }\n"
    "process Main { communication { p[3] : P q[3] : Q channel c : int any for i < 3 { p[i].c -> c  c -> q[i].c } }"
    " composition { (par i < 3 : p[i]) || (par i < 3 : q[i]) } }"
)
LONG = "process Main { out b : int composition { seq i < 100 : b ! i } }"
SILENT = (
    "process Main { out b : int communication { var n : int = 0 }"
    " composition { (seq i < 60000 : n := n + 1) ; (seq i < 300 : (seq k < 300 : skip)) ; b ! n } }"
)
COUNTS = (
    "process Main { out b : int communication { var n : int = 0 var m : int = 0 }"
    " composition { mu (b ! 1 ; m := m + 1 ; if m == 10 then (m := 0 ; n := n + 1)) until n == 30 } }"
)


def test_too_many_meetings_on_one_channel(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(channel_events, "MOST_COMBINATIONS", 8)
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


def test_a_long_loop_that_only_computes_ends() -> None:
    assert [len(component.edges) for component in system_of(SILENT).components] == [2]


def test_the_iterations_of_a_communicating_loop_are_distinguished() -> None:
    assert len(system_of(LONG.replace("b ! i", "b ! 1")).components[0].edges) == 101


def test_values_are_given_up_before_a_process_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    assert len(system_of(COUNTS).components[0].edges) == 301
    monkeypatch.setattr(explore, "MANY_STATES", 100)
    system = system_of(COUNTS)
    assert len(system.components[0].edges) <= 31
    assert any("`n`" in abstraction.what for abstraction in system.abstractions)


def _silent_steps(guests: int, monkeypatch: pytest.MonkeyPatch) -> int:
    """The number of silent steps taken to build the system of a porter who counts."""
    taken = 0
    step = Follower._step

    def counted(follower: Follower, configuration: Configuration) -> Configuration | None:
        nonlocal taken
        taken += 1
        return step(follower, configuration)

    with monkeypatch.context() as patched:
        patched.setattr(Follower, "_step", counted)
        system = system_of(
            f"process Main {{ in come[{guests}], go[{guests}] : bool communication {{ var here : int = 0 var x : bool "
            f"}}"
            f" composition {{ mu ( (alt i < {guests} : when here < {guests} & come[i] ? x -> here := here + 1)"
            f" [] (alt i < {guests} : when here > 0 & go[i] ? x -> here := here - 1) ) }} }}"
        )
    assert len(system.components[0].edges) > guests
    return taken


def test_a_choice_of_many_guards_is_prepared_once_however_many_lead_to_it(monkeypatch: pytest.MonkeyPatch) -> None:
    few, many = (_silent_steps(guests, monkeypatch) for guests in (8, 16))
    # Twice as many guards, and twice as many states; from each state twice as many steps back to the choice: 4 times as
    # many, not 8 times.
    assert 3 * few < many < 5 * few
