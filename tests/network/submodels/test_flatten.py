"""Submodels become flat, sorted classes."""

from __future__ import annotations

import math
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cspdiag.base import Report
from cspdiag.network.ir.equations import ExternalCall
from cspdiag.network.ir.expression_walk import walk
from cspdiag.network.ir.expressions import LiteralValue
from cspdiag.network.ir.network import SubmodelClass
from cspdiag.network.submodels.classes import LawUse, flatten, needs_sample
from cspdiag.semantics.equations.laws import Law
from cspdiag.semantics.values import FaultError
from cspdiag.syntax import ast
from tests.network.submodels.compiled import MS, instance, program, submodel

GAIN = """
submodel Gain(k: double, offset: double = k) {
  in  x : double
  out y : double
  let wasted = 17 * x
  y = k * x + offset
}
"""


def names(cls: SubmodelClass) -> dict[str, list[str]]:
    return {
        "constants": [c.name for c in cls.constants],
        "states": [s.name for s in cls.states],
        "equations": [e.name for e in cls.equations],
    }


def test_nested_submodels_are_inlined_under_the_names_of_their_instances() -> None:
    text = (
        GAIN
        + """
    submodel Twice(k: double) {
      in  x : double
      out y : double
      y = second.y
      second.x = first.y
      first  : Gain(k = k)
      second : Gain(k = 2 * k, offset = 1)
      first.x = x
    }"""
    )
    cls, _ = submodel(text, "Twice", {"k": 3.0})
    assert names(cls) == {
        "constants": ["second.k", "second.offset"],
        "states": [],
        "equations": ["first.x", "first.y", "second.x", "second.y", "y"],
    }
    assert instance(text, "Twice", k=3.0).evaluate(x=1.0)["y"] == 6 * (3 + 3) + 1


def test_an_unconnected_input_with_a_default_is_a_constant() -> None:
    text = """
    submodel Sum { in a : double  in b : double = 4  out y : double  y = a + b }
    submodel Outer { in x : double  out y : double  sum : Sum  sum.a = x  y = sum.y }
    """
    cls, _ = submodel(text, "Outer")
    assert names(cls)["constants"] == ["sum.b"]
    assert instance(text, "Outer").evaluate(x=1.0)["y"] == 5


def test_equations_over_parameters_only_are_computed_once() -> None:
    text = """
    submodel Law(tau: time, k: double) {
      in  x : double
      out y : double
      out c : double
      let b = 2 * a
      let a = sample / tau
      y = b * x
      c = 3 * k
    }"""
    cls, _ = submodel(text, "Law", {"tau": 10 * MS, "k": 2.0}, 2 * MS)
    assert names(cls) == {"constants": ["a", "b"], "states": [], "equations": ["y", "c"]}
    found = instance(text, "Law", 2 * MS, tau=10 * MS, k=2.0).evaluate(x=1.0)
    assert (found["y"], found["c"]) == (pytest.approx(0.4), 6.0)


def test_instances_with_other_arguments_share_a_class() -> None:
    text = """
    submodel Law(tau: time, poles: double[2]) {
      in  x : double
      out y : double
      y = lag(x, tau) + transfer([1], poles, x)
    }"""
    one, first = submodel(text, "Law", {"tau": 10 * MS, "poles": (0.1, 1.0)}, MS)
    other, second = submodel(text, "Law", {"tau": 20 * MS, "poles": (0.3, 1.0)}, 2 * MS)
    assert one == other
    assert first["sample"] == 0.001
    assert second["sample"] == 0.002
    assert first["transfer_1_a1"] != second["transfer_1_a1"]


def test_sizes_make_classes_of_their_own() -> None:
    text = """
    submodel Line(n: int) {
      in  x : double[n]
      out y : double
      y = delay(x[n - 1], n, 0)
    }"""
    one, _ = submodel(text, "Line", {"n": 3})
    other, _ = submodel(text, "Line", {"n": 4})
    assert one != other
    block = instance(text, "Line", n=2)
    assert [block.sample(x=(0.0, float(k)))["y"] for k in range(4)] == [0, 0, 0, 1]


def test_arrays_of_ports_and_of_instances() -> None:
    text = (
        GAIN
        + """
    submodel Both {
      in  x[2] : double
      out y[2] : double
      gain[i < 2] : Gain(k = double(i + 1))
      gain[0].x = x[0]
      gain[1].x = x[1]
      y[0] = gain[1].y
      y[1] = gain[0].y
    }"""
    )
    cls, _ = submodel(text, "Both")
    assert [p.name for p in cls.ports] == ["x[0]", "x[1]", "y[0]", "y[1]"]
    found = instance(text, "Both").evaluate(**{"x[0]": 10.0, "x[1]": 20.0})
    assert (found["y[0]"], found["y[1]"]) == (42.0, 11.0)


def test_continuous_states_are_integrated_and_held_signals_are_not_computed_again() -> None:
    text = """
    submodel Plant step 100 us {
      in  u : double
      out y : double
      state x : double = 1
      let held = lag(u, 10 ms)
      let double_u = 2 * u
      let force = held + double_u - x
      der x = force / 1<s>
      y = x
    }"""
    cls, _ = submodel(text, "Plant")
    assert [e.name for e in cls.derivative_equations] == ["force"]
    assert (cls.method, cls.step) == ("rk4", 100_000)
    block = instance(text, "Plant", 10 * MS)
    block.sample(u=0.0)
    assert block.states["x"] == pytest.approx(math.exp(-0.01), abs=1e-12)


def test_euler_integrates_in_single_steps() -> None:
    text = "submodel Plant method = euler { out y : double state x : double = 1 der x = -x / 1<s> y = x }"
    block = instance(text, "Plant", 100 * MS)
    block.sample()
    assert block.states["x"] == pytest.approx(0.9)


def test_time_advances_within_an_integration() -> None:
    text = "submodel Ramp { out y : double<s^2> state x : double<s^2> = 0 der x = 2 * time  y = x }"
    block = instance(text, "Ramp", 500 * MS, environment=True)
    for _ in range(4):
        block.sample()
    assert block.states["x"] == pytest.approx(4.0)


def test_nested_external_submodels_are_calls() -> None:
    text = """
    submodel Plant(inertia: double = 2) python "plant.py:Plant" { in u : double  out x, v : double }
    submodel Both { in u : double  out y : double  plant : Plant  plant.u = 2 * u  y = plant.x + plant.v }
    """
    cls, parameters = submodel(text, "Both")
    (call, _) = cls.equations
    assert isinstance(call, ExternalCall)
    assert [(a, v.value) for a, v in call.arguments if isinstance(v, LiteralValue)] == [("inertia", 2.0)]
    block = Law(cls, parameters, externals={"plant": lambda u: (u, 10 * u)})
    assert block.evaluate(u=1.0)["y"] == 22


def test_an_outer_external_submodel_has_ports_only() -> None:
    text = 'submodel Plant(inertia: double) python "plant.py:Plant" { in u : double  out x : double }'
    cls, _ = submodel(text, "Plant", {"inertia": 1.0})
    assert cls.external is not None
    assert cls.external.target == "plant.py:Plant"
    assert not cls.equations


def test_what_nothing_needs_is_left_out_of_nested_submodels_only() -> None:
    text = GAIN + "submodel Outer { in x : double out y : double let mine = x g : Gain(1) g.x = x y = g.y }"
    cls, _ = submodel(text, "Outer")
    assert "mine" in names(cls)["equations"]
    assert "g.wasted" not in names(cls)["equations"]


def test_units_leave_only_conversions() -> None:
    text = """
    const limit_angle = 90<deg>
    submodel Law {
      in  x : double<deg>
      out y : double<rad>
      out z : double<rad>
      y = convert(x, rad)
      z = convert(limit_angle, rad)
    }"""
    found = instance(text, "Law").evaluate(x=180.0)
    assert found["y"] == math.pi
    assert found["z"] == pytest.approx(math.pi / 2)


def test_constants_keep_their_names() -> None:
    text = "const supply = 12<V>  submodel Law { in x : double  out u : double<V>  u = supply * x }"
    cls, _ = submodel(text, "Law")
    (equation,) = cls.equations
    assert not isinstance(equation, ExternalCall)
    assert [part.name for part in walk(equation.value) if isinstance(part, LiteralValue)] == ["supply"]


def test_structs_enums_arrays_and_integers() -> None:
    text = """
    enum Mode { idle, run }
    struct Pose { x: double<m>  y: double<m> }
    submodel Law {
      in  mode : Mode
      in  pose : Pose
      in  n    : int8
      out back : Pose
      out m    : int8
      out k    : double<m>
      let row = [pose.x, pose.y, 3<m>]
      back = Pose(y = pose.x, x = if mode == Mode.run then pose.y else 0)
      m    = -n / 2 % 4
      k    = row[int(n) - int(n) + 2]
    }"""
    law = instance(text, "Law")
    found = law.evaluate(mode=1, pose=(1.0, 2.0), n=7)
    assert found["back"] == (2.0, 1.0)
    assert found["m"] == -3
    assert found["k"] == 3.0
    with pytest.raises(FaultError):
        law.evaluate(mode=1, pose=(1.0, 2.0), n=-128)


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        ("y = x", False),
        ("y = pre(x, 0) + delay(x, 2, 0)", False),
        ("y = x * sample / 1<s>", True),
        ("y = lag(x, 1 ms)", True),
        ("state s : double = 0  der s = x  y = s", True),
        ("inner : Inner  inner.x = x  y = inner.y", True),
    ],
)
def test_which_equations_need_a_sample_period(body: str, expected: bool) -> None:
    text = f"""
    submodel Inner {{ in x : double  out y : double  y = integral(x, 0<s>) / 1<s> }}
    submodel Outer {{ in x : double  out y : double  {body} }}"""
    model = program(text)
    definition = model.definitions["Outer"]
    assert isinstance(definition, ast.SubmodelDefinition)
    assert needs_sample(model, definition) is expected


def test_an_unstable_discretization_is_warned_of() -> None:
    text = "submodel Law method = euler { in x : double out y : double y = transfer([1], [1e-3, 1], x) + lag(x, 1 ms) }"
    model, report = program(text), Report()
    definition = model.definitions["Law"]
    assert isinstance(definition, ast.SubmodelDefinition)
    flatten(model, LawUse(definition, {}, 10 * MS, {}), report)
    assert [d.code for d in report.diagnostics] == ["W0457", "W0457"]
    assert not report.has_errors


sums = st.lists(st.lists(st.integers(0, 9), min_size=1, max_size=3), min_size=1, max_size=10)


@settings(max_examples=40, deadline=None)
@given(sums, st.randoms(use_true_random=False))
def test_equations_may_be_written_in_any_order_and_in_nested_submodels(graph: list[list[int]], source: Random) -> None:
    """Every equation adds one to the sum of some earlier ones; some are computed by an instance."""
    values: list[int] = []
    texts: list[str] = []
    for k, read in enumerate(graph):
        terms = [f"v{other}" for other in read if other < k]
        values.append(sum(values[other] for other in read if other < k) + 1)
        total = " + ".join([*terms, "0 * x"])
        if source.random() < 0.3:
            texts.append(f"next{k} : Next  next{k}.x = {total}  let v{k} = next{k}.y")
        else:
            texts.append(f"let v{k} = {total} + 1")
    texts.append(f"y = v{len(graph) - 1}")
    source.shuffle(texts)
    text = "submodel Next { in x : double  out y : double  y = x + 1 }"
    text += "submodel Law { in x : double  out y : double " + "\n".join(texts) + "}"
    assert instance(text, "Law").evaluate(x=3.0)["y"] == values[-1]
