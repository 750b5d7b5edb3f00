"""Arguments that are computed from parameters and are infinite, not a number, or faults."""

from __future__ import annotations

import math

import pytest

import cspdiag
from cspdiag.base.sources import read_source
from cspdiag.base.span import SourceFile
from cspdiag.network.ir.expressions import FunctionCall
from cspdiag.network.ir.walk import parts
from cspdiag.pipeline import build

LEVELS = [{"level": 0}, {"level": 1}, {"level": "reference"}, {"target": "c"}]

PROGRAM = """
struct Pair {{ a: double  b: double }}
parameter start : double = 2
parameter large : double = 1

submodel Law(g: double, p: Pair = Pair(a = 0, b = 0)) {{
  in  x : double
  out y : double
  {law}
}}

process Main {{
  in  x : double @ 10 ms
  out y : double @ 10 ms
  out n : int
  communication {{
    law : Law({arguments})
    x     -> law.x
    law.y -> y
  }}
  composition {{ mu (law catch Fault -> n ! 1) }}
}}

environment World for Main on miss count {{ source : Source  source.x -> x  y -> _  n -> _ }}
submodel Source {{ out x : double  x = 1 }}
"""

STATE = "state s : double = 0  next s = {next}  y = limit(s, -5, 5)"


def run(law: str, arguments: str, how: dict[str, object]) -> tuple[list[float], int]:
    """The values of y, and the number of faults, where ``large`` is 1e300 in the third and fourth of six runs."""
    program = cspdiag.parse(PROGRAM.format(law=law, arguments=arguments))
    tune: dict[str | float, dict[str, str | int | float]] = {"25 ms": {"large": 1e300}, "45 ms": {"large": 1}}
    done = program.run(until="75 ms", tune=tune, **how)  # type: ignore[arg-type]
    written = [item for item in done.communications if item.channel == "Main.y"]
    faults = [item for item in done.communications if item.channel == "Main.n"]
    return [item.value for item in written], len(faults)


@pytest.mark.parametrize("how", LEVELS, ids=str)
@pytest.mark.parametrize(
    ("law", "arguments"),
    [
        (STATE.format(next="g"), "g = start * large * 1e300"),
        ("let local = g  " + STATE.format(next="local"), "g = start * large * 1e300"),
        (STATE.format(next="if x / 2 > 0 then g else 0"), "g = start * large * 1e300"),
        (STATE.format(next="p.b"), "g = 1, p = Pair(a = 1, b = large * large)"),
        (STATE.format(next="g"), "g = log(2 - large)"),
        ("y = if g > 1 then 1 else 0", "g = sqrt(2 - large)"),
        ("y = g", "g = start * large * 1e300"),
    ],
    ids=["state", "local value", "condition", "field", "domain", "domain in a condition", "output"],
)
def test_what_would_be_stored_is_a_fault(law: str, arguments: str, how: dict[str, object]) -> None:
    values, faults = run(law, arguments, how)
    assert (len(values), faults) == (4, 2)
    assert all(map(math.isfinite, values))


@pytest.mark.parametrize("how", LEVELS, ids=str)
def test_within_an_expression_they_count_as_what_they_are(how: dict[str, object]) -> None:
    assert run("y = limit(g, -2, 2)", "g = start * large * 1e300", how) == ([2.0] * 6, 0)


@pytest.mark.parametrize("how", LEVELS, ids=str)
def test_what_nothing_depends_on_is_not_computed(how: dict[str, object]) -> None:
    assert run("let unread = g  let neither = unread + 1  y = x", "g = 1 / (large - 1e300)", how) == ([1.0] * 6, 0)


def test_arguments_that_are_not_computed_need_no_tests() -> None:
    text = PROGRAM.format(law=STATE.format(next="g"), arguments="g = start")
    network = build(SourceFile(name="main.csp", text=text), read_source).network
    assert network is not None
    assert "finite" not in {part.function for part in parts(network.classes) if isinstance(part, FunctionCall)}
