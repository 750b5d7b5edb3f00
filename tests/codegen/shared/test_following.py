"""What laws compute from parameters of the program alone is computed once, and again after a change."""

from __future__ import annotations

from cspdiag.codegen.shared.laws.following import Following, following_apart
from cspdiag.network.ir.actions import RunLaw
from cspdiag.network.ir.equations import SubmodelEquation
from cspdiag.network.ir.network import ProcessClass
from cspdiag.network.ir.walk import parts
from cspdiag.optimize import optimize
from tests.codegen.packages import package
from tests.codegen.python.fast.test_processes import network

PROGRAM = """
struct Gains {{ kp: double  ti: double }}
parameter gains : Gains = Gains(kp = 2.0, ti = 3.0)
parameter count : int = 3
submodel Law {{
  in  x : double
  in  n : int
  out y : double
  out m : int
  {equations}
}}
process P {{
  in  x : double @ 1 ms
  in  n : int @ 1 ms
  out y : double @ 1 ms
  out m : int @ 1 ms
  communication {{ law : Law  x -> law.x  n -> law.n  law.y -> y  law.m -> m }}
  composition {{ mu law }}
}}
"""


def following(equations: str) -> Following:
    classes = optimize(network(PROGRAM.format(equations=equations))).classes
    (entry,) = (item for item in classes if isinstance(item, ProcessClass))
    (law,) = (part for part in parts(entry.body) if isinstance(part, RunLaw))
    return following_apart(law, frozenset(item.name for item in entry.constants))


def names(equations: tuple[SubmodelEquation, ...]) -> list[str]:
    return [item.name.partition(" ")[2].rpartition(" ")[0] or item.name for item in equations]


def test_equations_over_parameters_alone_are_apart() -> None:
    found = following("let f = 1 / (sample + gains.ti * 1<s>)  y = f * x * 1<s>  m = n + 1")
    assert names(found.equations) == ["law.f"]
    assert [item.name for item in found.law.equations] == ["law.y", "law.m"]


def test_nothing_that_may_fail_comes_before_what_may_have_failed_first() -> None:
    found = following("let r = n / (n + 1)  let s = 7 / count  y = x  m = r + s")
    assert not found.equations
    first = following("let s = 7 / count  let r = n / (n + 1)  y = x  m = r + s")
    assert names(first.equations) == ["law.s"]


def test_parts_of_equations_that_follow_and_cannot_fail_are_terms() -> None:
    found = following("y = gains.kp * gains.ti * x + abs(x - gains.kp)  m = if n > 2 then n / count else n")
    assert names(found.terms) == ["gains_kp_ti", "gains_kp", "count"]


def test_a_zero_keeps_its_sign() -> None:
    found = following("y = x / (gains.kp * 0.0) + x * (gains.kp * -0.0)  m = n")
    assert names(found.terms) == ["gains_kp", "gains_kp"]


def test_laws_without_parameters_stay_as_they_are() -> None:
    found = following("y = x * sample / 1<s>  m = n")
    assert not found.parameters
    assert not found.terms


def test_the_gains_of_jiwy_are_looked_up_once() -> None:
    text = package("jiwy", 1)["jiwy/joint_control.py"]
    looked_up = [line for line in text.splitlines() if "gains.value." in line]
    assert len(looked_up) == 2 * len(("tauD", "beta", "kp", "tauI", "friction", "tolerance"))
