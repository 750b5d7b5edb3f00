"""Which variables a run may read without a value: only what an interrupt or a catch may have left out."""

from __future__ import annotations

import pytest

from cspdiag.network.checks.unwritten import may_be_unwritten, ports_of_unwritten
from tests.network import programs

ABANDONED = "((u ? x) interrupt after 1 ms -> skip)"


@pytest.mark.parametrize(
    ("composition", "found"),
    [
        ("u ? x ; y ! x", set()),
        (f"{ABANDONED} ; y ! x", {"x"}),
        (f"{ABANDONED} ; x := 3 ; y ! x", set()),
        ("((u ? x) catch Timeout -> skip) ; y ! x", {"x"}),
        ("((u ? x) catch Timeout -> x := 0) ; y ! x", set()),
        ("((u ? x) catch Timeout -> raise Odd) ; y ! x", set()),
        (f"{ABANDONED} ; (if z > 0 then x := 1 else x := 2) ; y ! x", set()),
        (f"{ABANDONED} ; (if z > 0 then x := 1) ; y ! x", {"x"}),
        (f"{ABANDONED} ; (mu u ? x until x > 3) ; y ! x", set()),
        (f"{ABANDONED} ; ((u ? x -> skip) [] (after 2 ms -> skip)) ; y ! x", {"x"}),
        (f"{ABANDONED} ; ((when x > 2 & u ? x -> skip) [] (after 2 ms -> skip))", {"x"}),
        (f"{ABANDONED} ; (u ? x || wait 1 ms) ; y ! x", set()),
    ],
)
def test_variables(composition: str, found: set[str]) -> None:
    network = programs.network(
        f"""
exception Odd
process Main {{
  in u : int
  out y : int
  communication {{ var x : int  var z : int = 0 }}
  composition {{ z := z + 1 ; y ! z ; {composition} }}
}}
"""
    )
    assert may_be_unwritten(network)["Main"] == found


@pytest.mark.parametrize(
    ("body", "composition", "found"),
    [
        ("", "u ? v ; law ; y ! x", set()),
        ("", "u ? v ; mu law until x > 3", set()),
        ("", "u ? v ; (law interrupt after 5 ms -> skip) ; y ! x", {"x"}),
        ("", "((u ? v) interrupt after 5 ms -> skip) ; law ; y ! x", {"v"}),
        (' c "law.c"', "u ? v ; law ; y ! x", {"v", "x"}),
    ],
)
def test_variables_that_a_law_writes(body: str, composition: str, found: set[str]) -> None:
    """Of a law in another language nothing is known."""
    network = programs.network(f"""
submodel Law{body} {{ in v : double  out y : double  {"" if body else "y = 2 * v"} }}
process Main {{
  in u : double
  out y : double
  communication {{ var x : double  var v : double  law : Law  v -> law.v  law.y -> x }}
  composition {{ (skip interrupt after 5 ms -> skip) ; {composition} }}
}}
""")
    assert may_be_unwritten(network)["Main"] == found


def test_ports_that_lead_to_such_a_variable() -> None:
    network = programs.network("""
process Find { in u : int  out place : int  communication { var x : int }  composition { u ? x ; place ! x } }
process Go { in place : int  out y : int  communication { var x : int }  composition { place ? x ; y ! x } }
process Both { in place : int  out y : int  communication { go : Go  place -> go.place  go.y -> y }  composition { go } }
process Main {
  in u : int
  out y : int
  communication { find : Find  both : Both  u -> find.u  find.place -> found : int -> both.place  both.y -> y }
  composition { (find interrupt after 5 ms -> skip) ; both }
}
""")
    assert may_be_unwritten(network)["Main"] == {"found"}
    ports = ports_of_unwritten(network)
    assert ports["Go"] == ports["Both"] == {("place", None)}
    assert ports["Find"] == set()
