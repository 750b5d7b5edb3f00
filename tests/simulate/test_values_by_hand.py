"""Values that bodies and devices in Python give: of the type of the output, rounded, and finite."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

import cspdiag

PROGRAM = """\
struct Pair {
  first  : double
  second : int
}

submodel Law(gain: double) python "bodies.py:Law" {
  in  x     : double
  out y     : double
  out pair  : Pair
  out three : double[3]
}

process Ramp python "bodies.py:Ramp" {
  in  x : double
  out y : double
  out z : double
}

driver Card python "bodies.py:Card" {
  out x : double
}

submodel Plant python "bodies.py:Plant" {
  out x : double
}

process Main {
  in  x     : double @ 1 ms
  out y     : double @ 1 ms
  out pair  : Pair @ 1 ms
  out three : double[3] @ 1 ms
  out ramp  : double @ 1 ms
  out other : double @ 1 ms

  communication {
    law  : Law(gain = 1.1)
    line : Ramp

    x         -> law.x
    law.y     -> y
    law.pair  -> pair
    law.three -> three
    x         -> line.x
    line.y    -> ramp
    line.z    -> other
  }

  composition {
    mu law || line
  }
}

environment Real for Main {
  card : Card

  card.x -> x
  y      -> _
  pair   -> _
  three  -> _
  ramp   -> _
  other  -> _
}

environment Bench for Main {
  plant : Plant

  plant.x -> x
  y       -> _
  pair    -> _
  three   -> _
  ramp    -> _
  other   -> _
}
"""

BODIES = """\
import math

from cspdiag.runtime import Alternative, Output, Process


class Law:
    def __init__(self, *, gain):
        self.gain = gain

    def calculate(self, x):
        return x * self.gain, (x / 3, 7), [x / 3, x / 7, LAW]


LAW = 1
PLANT = 0.1
CARD = 0.1


class Ramp(Process):
    def __init__(self, name, *, x, y, z):
        super().__init__(name)
        self.x = x.reader(self)
        self.y = y
        self.alternative = Alternative(Output(z, 0.1))

    async def run(self):
        while True:
            value = await self.x.read()
            await self.y.write(value / 3)
            await self.alternative.select(values={0: value / 7})


class Plant:
    def calculate(self):
        return PLANT


class Card:
    def read(self, port):
        return CARD
"""


def run(folder: Path, *, real: Any, level: int, environment: str = "Bench", **values: str) -> cspdiag.Run:
    text = BODIES
    for name, value in values.items():
        text += f"\n\n{name} = {value}\n"
    (folder / "bodies.py").write_text(text)
    (folder / "main.csp").write_text(PROGRAM)
    program = cspdiag.load(folder / "main.csp", real=real)
    return program.run(environment, until=0.0021, level=level)


def passed(run: cspdiag.Run) -> dict[str, Any]:
    return {each.channel.removeprefix("Main."): each.value for each in run.communications}


def single(value: float) -> float:
    import numpy as np

    return float(np.float32(value))


@pytest.mark.parametrize("environment", ["Bench", "Real"])
@pytest.mark.parametrize("level", [0, 1])
def test_values_are_rounded_to_single_precision(tmp_path: Path, level: int, environment: str) -> None:
    found = passed(run(tmp_path, real="float32", level=level, environment=environment))
    x, gain = single(0.1), single(1.1)
    assert found == {
        "x": x,
        "y": single(x * gain),
        "pair": (single(x / 3), 7),
        "three": (single(x / 3), single(x / 7), 1.0),
        "ramp": single(x / 3),
        "other": single(x / 7),
    }
    assert type(found["three"][2]) is float


@pytest.mark.parametrize("real", ["double", "float32"])
@pytest.mark.parametrize("level", [0, 1])
def test_a_law_whose_output_is_not_a_number_faults_at_its_place(tmp_path: Path, level: int, real: str) -> None:
    outcome = run(tmp_path, real=real, level=level, LAW="math.nan").outcome
    assert outcome.ended == "failed"
    assert str(outcome.error) == "a real value is infinite or not a number, in Main.law (main.csp:6)"


@pytest.mark.parametrize("real", ["double", "float32"])
@pytest.mark.parametrize("level", [0, 1])
def test_what_an_environment_hands_over_is_finite(tmp_path: Path, level: int, real: str) -> None:
    outcome = run(tmp_path, real=real, level=level, PLANT="math.inf").outcome
    assert outcome.ended == "failed"
    line = PROGRAM.splitlines().index("  plant.x -> x") + 1
    reason = f"the environment Bench failed: Fault: a real value is infinite or not a number, in main.csp:{line}"
    assert str(outcome.error) == reason


@pytest.mark.parametrize("level", [0, 1])
def test_a_number_that_single_precision_does_not_have_faults_at_the_port(tmp_path: Path, level: int) -> None:
    outcome = run(tmp_path, real="float32", level=level, environment="Real", CARD="1e39").outcome
    assert outcome.ended == "failed"
    reason = "driver Card failed to read at port Main.x: Fault: 1e+39 is too large for single precision"
    assert str(outcome.error) == reason
    assert run(tmp_path, real="double", level=level, environment="Real", CARD="1e39").outcome.ended == "time limit"
