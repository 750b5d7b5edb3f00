"""Values from outside for which operations of a program fault: a replay tries them, whatever the proof left open."""

from __future__ import annotations

import pytest

from tests.support.verifying import answer_to

PROGRAM = """struct Order {{
  id : int
  due : bool
}}
process Main {{
  in  x : {kind}
  out o : int
  communication {{
    var v : {kind} = {first}
    var k : int = 0
    var t : time = 0 s
    var a : int[4] = [1, 2, 3, 4]
    {parts}
  }}
  composition {{
    (mu ({body})) catch Fault -> stop
  }}
}}
assert Main deadlock free
"""


def program(body: str, kind: str = "int", first: str = "0", parts: str = "") -> str:
    return PROGRAM.format(body=body, kind=kind, first=first, parts=parts)


ORDER = "Order(id = 0, due = false)"

CASES = {
    "a divisor that stays zero": (program("x ? v ; (if v != 0 then k := v) ; o ! 100 / k"), "0"),
    "a remainder": (program("x ? v ; (if v > 7 then k := 100 % (v - 10)) ; o ! k"), "10"),
    "a conversion": (program("x ? v ; o ! int(int8(v))"), "128"),
    "a conversion that is bounded above": (program("x ? v ; (if v > 100 then v := 100) ; o ! int(int8(v))"), "-129"),
    "a conversion of a smaller type": (program("x ? v ; o ! int(int8(v / 2))", "int16"), "32767"),
    "a conversion of a real": (program("x ? v ; o ! int(int16(v))", "double"), "32768.0"),
    "an element": (program("x ? v ; o ! a[v]"), "4"),
    "an element below": (program("x ? v ; (if v > 3 then v := 3) ; o ! a[v]"), "-1"),
    "an element that is assigned": (program("x ? v ; a[v] := 1 ; o ! 1"), "4"),
    "a sum": (program("x ? v ; k := v + 10 ; o ! k"), "9223372036854775807"),
    "a difference": (program("x ? v ; k := v - 10 ; o ! k"), "-9223372036854775808"),
    "a negative": (program("x ? v ; k := -v ; o ! k"), "-9223372036854775808"),
    "a product": (program("x ? v ; k := v * 3 ; o ! k"), "9223372036854775807"),
    "a time": (program("x ? v ; t := v + 1 s ; o ! 1", "time", "0 s"), "9223372036854775807 ns"),
    "a field, which is too long to be shown": (program("x ? v ; o ! int(int8(v.id))", "Order", ORDER), None),
}


@pytest.mark.parametrize("name", CASES)
def test_value_at_which_an_operation_faults_is_offered(name: str) -> None:
    text, value = CASES[name]
    answer = answer_to(text)
    assert (answer.outcome, answer.replayed) == ("refuted", True), answer.reason
    assert answer.counterexample is not None
    assert [step.value for step in answer.counterexample.steps if step.channel == "Main.x"] == [value]


def test_faults_that_no_value_leads_to_are_not_found() -> None:
    answer = answer_to(program("x ? v ; (if v < 0 or v > 3 then v := 0) ; o ! a[v]"))
    assert answer.outcome != "refuted"
