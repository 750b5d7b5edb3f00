"""Which states of an environment move by matrices, and that these are those of Runge and Kutta's method."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from random import Random

import pytest

from cspdiag.network.ir.equations import LinearBlock
from cspdiag.network.ir.expression_walk import walk
from cspdiag.network.ir.network import SubmodelClass
from cspdiag.network.submodels.linear_form import LARGEST_TEXT
from cspdiag.runtime.compiled.linear import rk4_matrices
from cspdiag.semantics.equations.laws import Law
from tests.network.submodels.compiled import environment

PROGRAM = """
process Main {{
  in  y : double @ 10 ms
  out u : double @ 10 ms
  out n : int    @ 10 ms

  communication {{
    var v : double = 0
  }}

  composition {{
    mu (y ? v ; u ! v ; n ! 1)
  }}
}}

submodel Plant(gain: double = 4, none: double = 0){head} {{
  in  u : double
  in  n : int
  out y : double

{body}
}}

environment Bench for Main step {step} {{
  plant : Plant

  u       -> plant.u
  n       -> plant.n
  plant.y -> y
}}
"""


def plant(body: str, head: str = "", step: str = "10 ms") -> SubmodelClass:
    found = environment(PROGRAM.format(body=body, head=head, step=step), "Bench").system
    assert found is not None
    return found


def blocks(body: str, head: str = "", step: str = "10 ms") -> list[list[str]]:
    return [[name.removeprefix("plant.") for name in block.states] for block in plant(body, head, step).linear]


LINEAR = {
    "a constant": "der x = 2.0",
    "itself": "der x = x",
    "an input": "der x = u - x",
    "a whole number": "der x = double(n) - x",
    "a parameter": "der x = gain * (u - x) / (gain + 1)",
    "a function of constants": "der x = sqrt(gain) * x",
    "a function of what is held": "der x = limit(u, -1, 1) / (u + 2) - x",
    "a choice between held values": "der x = (if n > 2 then u else -u) - x",
    "a discrete state": "state k : double = 1\n  next k = -k\n  der x = k - x",
    "what an operator keeps": "der x = lag(u, 30 ms) - x",
    "an operator on a state": "der x = lag(x, 30 ms) - x",
    "an equation": "let d = 2 * x - u\n  der x = d - x",
    "an element": "let v = [x, u]\n  der x = v[0] - v[1]",
    "a difference that is zero": "der x = 0.0 * x",
}
OTHERS = {
    "a product of states": "der x = x * x",
    "a state times an input": "der x = u * x",
    "a state divided by an input": "der x = x / (u + 2)",
    "a division by a state": "der x = 1 / (x + 2)",
    "a division by zero": "der x = x / none",
    "a function": "der x = -sin(x)",
    "a power": "der x = x ^ 2",
    "a choice between states": "der x = if n > 2 then x else -x",
    "a choice by a state": "der x = if x > 2 then 1<1/s> else 2<1/s>",
    "the time": "der x = u + 1<1/s> * time",
    "the time in an equation": "let wave = sin(1<1/s> * time)\n  der x = wave - x",
    "an element that a state chooses": "let v = [u, 2 * u]\n  der x = v[int(x)]",
    "a coefficient that is infinite": "der x = x * 1e308 * 1e308",
    "a matrix that is infinite": "der x = 1e100 * x",
}


@pytest.mark.parametrize("kind", LINEAR)
def test_a_derivative_with_known_coefficients_is_linear(kind: str) -> None:
    assert blocks(f"  state x : double = 1\n  {LINEAR[kind]}\n  y = x") == [["x"]]


@pytest.mark.parametrize("kind", OTHERS)
def test_any_other_derivative_is_evaluated_in_stages(kind: str) -> None:
    assert blocks(f"  state x : double = 1\n  {OTHERS[kind]}\n  y = x") == []


def test_states_of_binary32_are_evaluated_in_stages() -> None:
    assert blocks("  state s : float = 0\n  state x : double = 1\n  der s = float(u)\n  der x = u\n  y = x") == [["x"]]


def states(count: int) -> str:
    return "".join(f"  state x{number} : double = 1\n" for number in range(count)) + "  y = x0\n"


def test_states_that_read_each_other_are_one_block_and_others_are_not() -> None:
    body = states(5) + "  der x0 = x1\n  der x1 = u\n  der x2 = x3 - x2\n  der x3 = -x2\n  der x4 = 1.0"
    assert blocks(body) == [["x0", "x1"], ["x2", "x3"], ["x4"]]


def test_an_equation_joins_all_states_that_it_reads() -> None:
    assert blocks(states(3) + "  let d = x0 - x1\n  der x0 = -d\n  der x1 = 1.0\n  der x2 = 2.0") == [
        ["x0", "x1"],
        ["x2"],
    ]


def test_a_block_is_linear_as_a_whole_or_not_at_all() -> None:
    fed = states(3) + "  der x0 = x1 - x0\n  der x1 = -sin(x1)\n  der x2 = u"
    feeding = states(3) + "  der x0 = u - x0\n  der x1 = -sin(x1 + x0)\n  der x2 = u"
    assert blocks(fed) == blocks(feeding) == [["x2"]]


def test_a_block_has_at_most_eight_states() -> None:
    def chain(count: int) -> str:
        return states(count) + "".join(f"  der x{number} = x{(number + 1) % count}\n" for number in range(count))

    assert blocks(chain(8)) == [[f"x{number}" for number in range(8)]]
    assert blocks(chain(9)) == []


def test_how_long_a_step_may_be_decides_whether_the_matrices_are_finite() -> None:
    body = "  state x : double = 1\n  der x = 1e80 * x\n  y = x"
    assert blocks(body, step="10 ms") == []
    assert blocks(body, step="1 ms") == [["x"]]
    assert blocks(body, head=" step 1 ms", step="10 ms") == [["x"]]


def test_euler_and_control_laws_have_no_matrices() -> None:
    assert blocks("  state x : double = 1\n  der x = -x\n  y = x", head=" method = euler") == []


def test_what_is_held_is_computed_once() -> None:
    (block,) = plant("  state x : double = 1\n  let d = u / 3 - 2 * x\n  der x = gain * d + d\n  y = x").linear
    assert [item.name for item in block.equations] == ["plant.d_held", "plant.x_held"]


def test_a_coefficient_of_many_parts_is_its_value() -> None:
    lets = "".join(f"  let d{k} = d{k - 1} * gain - d{k - 1} / gain\n" for k in range(1, 12))
    system = plant(f"  state x : double = 1\n  let d0 = -x\n{lets}  der x = d11\n  y = x")
    (((coefficient,),),) = (block.matrix for block in system.linear)
    assert coefficient is not None
    assert len(list(walk(coefficient))) <= LARGEST_TEXT
    law = Law(system, {})
    assert law.value(coefficient, law.constants) == pytest.approx(-((4 - 0.25) ** 11))


# ---- Against exact arithmetic

Exact = dict[str, Fraction]


def exact_step(a: Mapping[tuple[int, int], float], r: list[float], x: list[Fraction], h: Fraction) -> list[Fraction]:
    """The classical Runge-Kutta method as textbooks have it, in four stages."""
    size = range(len(x))

    def slope(at: list[Fraction]) -> list[Fraction]:
        return [sum((Fraction(a[i, j]) * at[j] for j in size if (i, j) in a), Fraction(r[i])) for i in size]

    def moved(by: Fraction, k: list[Fraction]) -> list[Fraction]:
        return [x[i] + by * k[i] for i in size]

    k1 = slope(x)
    k2 = slope(moved(h / 2, k1))
    k3 = slope(moved(h / 2, k2))
    k4 = slope(moved(h, k3))
    return [x[i] + h / 6 * (k1[i] + 2 * k2[i] + 2 * k3[i] + k4[i]) for i in size]


@pytest.mark.parametrize("seed", range(20))
def test_trajectories_are_those_of_exact_runge_kutta_steps(seed: int) -> None:
    draw = Random(seed)
    size = draw.randint(1, 5)
    a = {
        (i, j): draw.choice([1.0, -1.0, draw.uniform(-90, 90)])
        for i in range(size)
        for j in range(size)
        if i == j or draw.random() < 0.5
    }
    held = [draw.choice([0.0, draw.uniform(-9, 9)]) for _ in range(size)]
    body = states(size)
    for i in range(size):
        terms = [f"{a[i, j]!r} * x{j}" for j in range(size) if (i, j) in a]
        body += f"  der x{i} = {' + '.join(terms)} + {held[i]!r} * u\n"
    system = plant(body, head=" step 3 ms")
    assert sum(len(block.states) for block in system.linear) == size
    law = Law(system, {})
    exact = [Fraction(1)] * size
    for number in range(20):
        duration = draw.choice([0.01, 0.004, 0.002])
        u = draw.uniform(-2, 2)
        law.advance(law.evaluate(u=u, n=0), duration)
        steps = -(-round(duration * 1e9) // 3_000_000)
        for _ in range(steps):
            exact = exact_step(a, [part * u for part in held], exact, Fraction(duration) / steps)
        size_of_all = max(abs(x) for x in exact)
        for i, x in enumerate(exact):
            found = Fraction(law.states[f"plant.x{i}"])
            assert abs(found - x) <= 1e-13 * (number + 1) * float(size_of_all)


@pytest.mark.parametrize("seed", range(20))
def test_matrices_are_the_polynomial(seed: int) -> None:
    draw = Random(seed)
    size = range(draw.randint(1, 6))
    h = draw.choice([1e-3, 0.02])
    a = tuple(tuple(draw.choice([0.0, 1.0, draw.uniform(-500, 500)]) for _ in size) for _ in size)
    m, n = rk4_matrices(a, h)
    given = {(i, j): a[i][j] for i in size for j in size}
    for j in size:
        unit = [float(i == j) for i in size]
        column = exact_step(given, [0.0] * len(size), [Fraction(x) for x in unit], Fraction(h))
        forced = exact_step(given, unit, [Fraction(0)] * len(size), Fraction(h))
        largest = max(1.0, *(abs(float(x)) for x in column))
        assert [m[i][j] for i in size] == pytest.approx([float(x) for x in column], rel=1e-12, abs=1e-13 * largest)
        assert [n[i][j] for i in size] == pytest.approx([float(x) for x in forced], rel=1e-12, abs=1e-13 * largest * h)


def test_matrices_of_the_last_steps_are_remembered() -> None:
    a = ((-1.0, 0.5), (0.0, 2.0))
    assert rk4_matrices(a, 0.25) is rk4_matrices(a, 0.25)


# ---- Which entries a step needs


def rows(body: str) -> list[tuple[tuple[int, ...], tuple[int, ...], bool]]:
    block: LinearBlock = plant(body).linear[0]
    return [(row.of, row.held, row.keeps) for row in block.rows]


def test_a_row_has_the_states_that_four_factors_reach_and_the_inputs_that_three_do() -> None:
    chain = states(6) + "  der x5 = u\n" + "".join(f"  der x{k} = x{k + 1}\n" for k in range(5))
    assert rows(chain) == [
        ((0, 1, 2, 3, 4), (), True),
        ((1, 2, 3, 4, 5), (), True),
        ((2, 3, 4, 5), (5,), True),
        ((3, 4, 5), (5,), True),
        ((4, 5), (5,), True),
        ((5,), (5,), True),
    ]


def test_a_state_that_comes_back_to_itself_has_a_coefficient() -> None:
    circle = states(5) + "".join(f"  der x{k} = x{(k + 1) % 5}\n" for k in range(5))
    assert [keeps for _, _, keeps in rows(circle)] == [True] * 5
    circle = states(4) + "".join(f"  der x{k} = x{(k + 1) % 4}\n" for k in range(4))
    assert [keeps for _, _, keeps in rows(circle)] == [False] * 4
