"""A body with the other end of the channel of its interrupt makes the guard ready: it is cancelled in the middle of the
communication, and the process waits for the guard alone. The same is true of the guards of nested interrupts.
"""

from __future__ import annotations

import pytest

from tests.support.verifying import answer_to

OWN_CHANNEL = """process Main {{
  out o : int
  communication {{
    channel c : int
    var x : int = 0
  }}
  composition {{ {composition} }}
}}
"""
ANY = OWN_CHANNEL.replace("channel c : int", "channel c : int any\n    channel d : int any\n    var y : int = 0")
OWN_PORTS = """process Inner {{
  in i : int
  out c, o : int
  communication {{ var x : int = 0 }}
  composition {{ {composition} }}
}}

process Main {{
  in other_i : int
  out o, other_c, other_o : int
  communication {{
    first : Inner
    inner : Inner
    other_i -> first.i
    first.c -> other_c
    first.o -> other_o
    inner.c -> between : int -> inner.i
    inner.o -> o
  }}
  composition {{ first || inner }}
}}
"""
FORMS = [
    (OWN_CHANNEL, "((wait 1 ms) interrupt c ! 4 -> skip) interrupt c ? x -> skip"),
    (OWN_CHANNEL, "((o ! 5) interrupt c ! 4 -> o ! 6) interrupt c ? x -> o ! 7"),
    (OWN_CHANNEL, "((o ! 5) interrupt c ? x -> o ! 6) interrupt c ! 4 -> o ! 7"),
    (OWN_CHANNEL, "(((o ! 5) interrupt c ! 4 -> o ! 6) interrupt after 1 s -> skip) interrupt c ? x -> o ! 7"),
    (OWN_PORTS, "((wait 1 ms ; o ! 1) interrupt c ! 4 -> skip) interrupt i ? x -> skip"),
    (OWN_CHANNEL, "((c ! 1 -> o ! 1) [] (after 2 ms -> skip)) interrupt c ? x -> stop"),
    (OWN_CHANNEL, "((c ? x) interrupt after 1 ms -> skip) interrupt c ! 0 -> skip"),
    (ANY, "((c ! 3 ; o ! 5) interrupt c ? x -> o ! 1) || (wait 1 ms ; c ? y)"),
    (ANY, "d ? y || (mu (((c ! 2 -> skip) [] (after 2 ms -> skip)) interrupt c ? x -> d ! 1))"),
    (OWN_PORTS, "((c ! 1 -> o ! 1) [] (after 2 ms -> skip)) interrupt i ? x -> stop"),
]


@pytest.mark.parametrize("claim", ["deadlock free", "terminates"])
@pytest.mark.parametrize(("program", "composition"), FORMS)
def test_a_process_that_waits_for_its_own_guard_is_stuck(program: str, composition: str, claim: str) -> None:
    assert answer_to(program.format(composition=composition) + f"\nassert Main {claim}\n").outcome != "proved"


def test_guards_of_different_channels_do_not_meet() -> None:
    text = OWN_CHANNEL.replace("out o : int", "in i : int\n  out o, c2 : int").format(
        composition="((wait 1 ms ; o ! 1) interrupt i ? x -> skip) interrupt c2 ! 4 -> skip"
    )
    assert answer_to(text.replace("    channel c : int\n", "") + "\nassert Main deadlock free\n").outcome == "proved"
