"""A transition system does what the semantics of the language does over all schedules, construct by construct.

The explorers do not step the interpreter: a system has no times, few values, and separate components, where the
interpreter has one state with all of that. Instead, their results for a program without times are compared: how often
each channel may have communicated when the program has ended or is stuck. With times, and with interrupts, which may
come at any moment in a system, the system may only allow more.
"""

from __future__ import annotations

import pytest

from cspdiag.base import SourceFile
from tests.conformance.sources import network_of
from tests.proofs.transitions.building import system_of
from tests.proofs.transitions.outcomes import outcomes_of_meaning, outcomes_of_system


def program(channels: str, composition: str) -> str:
    """A process without ports; its branches share no variable that both write."""
    variables = " ".join(f"var {name} : int = 0" for name in "uvwxyz")
    return (
        f"exception Enough\nprocess Main {{\n  communication {{ {channels} {variables} }}\n"
        f"  composition {{ {composition} }}\n}}\n"
    )


C = "channel c : int "
CD = "channel c : int channel d : int "

EXACT = {
    "rendezvous": (C, "c ! 1 || c ? x"),
    "partners in another order": (CD, "(c ! 1 ; d ! 2) || (d ? x ; c ? y)"),
    "partners in one order": (CD, "(c ! 1 ; d ! 2) || (c ? x ; d ? y)"),
    "parallel within sequence": (CD, "((c ! 1 || d ! 2) ; c ! 3) || (d ? x ; c ? x ; c ? x)"),
    "several writers": ("channel c : int any ", "c ! 1 || (c ! 2 ; c ! 3) || (c ? x ; c ? x)"),
    "several readers": ("channel c : int any ", "(c ! 1 ; c ! 2) || c ? x || (c ? y ; c ? y)"),
    "alternative": (CD, "(c ? x -> skip [] d ? x -> skip) || (c ! 1 -> skip [] d ! 2 -> skip)"),
    "alternative of one of two": (CD, "((c ? x -> skip [] d ? x -> c ? x)) || c ! 1 || d ! 1"),
    "prioritized alternative": (CD, "(c ? x -> skip []> d ? x -> c ? x) || (c ! 1 ; d ! 1)"),
    "alternative that need not wait": (C, "(c ? x -> skip [] skip -> c ? x) || c ! 1"),
    "alternatives on both sides": (CD, "(c ! 1 -> d ? x [] d ? x -> c ! 2) || (c ? y -> d ! 3 [] d ! 4 -> c ? y)"),
    "guard that does not read": (C, "(c -> c ? x) || c ! 1"),
    "condition of a guard": (CD, "(when x > 0 & c ? x -> skip [] d ? x -> c ? x) || (d ! 1 ; c ! 1)"),
    "buffer": ("channel c : int buffer 2 ", "(c ! 1 ; c ! 2 ; c ! 3) || c ? x"),
    "buffer in another order": (f"{CD} buffer 1 ", "(d ! 1 ; c ! 2) || (c ? x ; d ? y)"),
    "overwriting": ("channel c : int overwrite 1 ", "(c ! 1 ; c ! 2) || c ? x"),
    "broadcast": ("channel c : int broadcast ", "(c ! 1 ; c ! 2) || (c ? x ; c ? x) || c ? y"),
    "broadcast to alternatives": (f"{C} broadcast channel d : int ", (
        "(c ! 1) || (c ? x -> d ? x [] d ? x -> c ? x) || (c ? y ; d ! 1)"
    )),
    "loop": (CD, "mu (c ! x ; x := x + 1) until x == 3 || seq i < 3 : (c ? y)"),
    "condition": (CD, "(if x == 0 then c ! 1 else d ! 1) || (c ? y ; d ? y)"),
    "exception": (CD, "((c ! 1 ; raise Enough) || d ! 1) catch Enough -> skip || (c ? x ; d ? x)"),
    "exception among partners": (CD, (
        "((c ! 1 ; raise Enough) || (d ! 1 ; d ! 2)) catch Enough -> skip || (c ? x || d ? y)"
    )),
    "stop": (C, "(c ! 1 ; stop) || c ? x"),
}  # fmt: skip

INCLUDED = {
    "delays": (CD, "(wait 1 ms ; c ! 1) || (wait 2 ms ; d ! 1) || (c ? x -> stop [] d ? x -> c ? x)"),
    "time-out": (C, "(wait 1 ms ; c ! 1) || (c ? x -> skip [] after 2 ms -> skip)"),
    "priority": (CD, "c ! 1 ||> (d ! 1 ||> (c ? x -> skip [] d ? x -> c ? x))"),
    "interrupt": (CD, "((c ! 1 ; c ! 2) interrupt d ? x -> skip) || (c ? y ; d ! 1)"),
    "interrupt in interrupt": (CD, "(((c ! 1 ; stop) interrupt c ? x -> skip) interrupt d ? y -> skip) || (d ! 1)"),
}


@pytest.mark.parametrize(("channels", "composition"), EXACT.values(), ids=EXACT)
def test_the_transition_system_does_what_the_reference_does(channels: str, composition: str) -> None:
    text = program(channels, composition)
    network = network_of(SourceFile(name="small.csp", text=text))
    assert outcomes_of_system(system_of(text)) == outcomes_of_meaning(network)


@pytest.mark.parametrize(("channels", "composition"), INCLUDED.values(), ids=INCLUDED)
def test_the_transition_system_does_no_less_than_the_reference(channels: str, composition: str) -> None:
    text = program(channels, composition)
    network = network_of(SourceFile(name="small.csp", text=text))
    meaning = outcomes_of_meaning(network)
    assert meaning
    assert outcomes_of_system(system_of(text)) >= meaning


def test_outcomes_distinguish_programs() -> None:
    one, other = (system_of(program(*EXACT[f"partners in {how} order"])) for how in ("one", "another"))
    assert outcomes_of_system(one) == {((("Main.c", 1), ("Main.d", 1)), "terminated")}
    assert outcomes_of_system(other) == {((), "deadlock")}
