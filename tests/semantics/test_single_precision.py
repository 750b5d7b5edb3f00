"""With ``--real float32`` every target behaves like the reference too, and that like numbers of binary32."""

from __future__ import annotations

import os
from itertools import product

import numpy as np
import pytest

import cspdiag
from cspdiag.model.types import RealType
from cspdiag.network.ir.network import Network
from tests.conformance.hunt import A_START, hunt
from tests.conformance.kit import judge, parsed
from tests.conformance.sources import JUST_AFTER, MODELS, PROGRAMS, InvalidProgramError, environments
from tests.conformance.targets import TARGETS, Target
from tests.support.thorough import in_turn, usual_or_thorough

EXAMPLES = int(os.environ.get("CONFORMANCE_EXAMPLES", "30")) // 2
COMPARED = ("python-O0", "python-O1", "c-O0", "c-O1")

HUGE = {
    f"tests/conformance/programs/{name}.csp"
    for name in (
        "computed_arguments_that_are_not_finite",
        "faults_change_nothing",
        "faults_of_constants",
        "faults_of_laws_known_before_the_run",
        "functions_of_special_values",
        "resets_to_values_that_are_not_finite",
        "sum_of_states_overflows",
        "unused_state_becomes_infinite",
    )
}
"""Programs about overflow, with numbers that single precision does not have."""


@pytest.fixture
def target(request: pytest.FixtureRequest) -> Target:
    target: Target = TARGETS[request.param]
    reason = target.unavailable()
    if reason is not None:
        pytest.skip(f"{target.name}: {reason}")
    return target


def network_in_single(name: str) -> Network:
    network = parsed(name, "float32")
    doubles = [net.path for net in network.nets if isinstance(net.type, RealType) and net.type.bits == 64]
    assert doubles == [], "a channel of the program is in double precision"
    return network


@pytest.mark.parametrize(
    ("name", "target"),
    [*product(MODELS, COMPARED), *in_turn(sorted(set(PROGRAMS) - HUGE), COMPARED)],
    indirect=["target"],
)
def test_program(target: Target, name: str) -> None:
    network = network_in_single(name)
    for environment in environments(network):
        verdict = judge(target, network, environment, 100_000_000 + JUST_AFTER, name, real="float32")
        if verdict.result == "refused":
            pytest.skip(f"{target.name}: {verdict.details}")
        assert verdict.result == "equal", verdict.details


@pytest.mark.parametrize("name", sorted(HUGE))
def test_numbers_that_are_too_large_are_refused(name: str) -> None:
    with pytest.raises(InvalidProgramError, match="E0908"):
        parsed(name, "float32")


@pytest.mark.parametrize("target", COMPARED, indirect=True)
@pytest.mark.parametrize("start", range(EXAMPLES // A_START))
def test_random_programs(target: Target, start: int) -> None:
    found = hunt(target, usual_or_thorough(5, A_START), start, shrink=False, real="float32")
    assert found is None, found


LAW = """
const third = 1.0 / 3

/// A low-pass, an integrator with a constant of its own, and functions.
submodel Law(tau: time, k: double = 0.1) {
  in  x : double
  out y : double
  out z : double

  state low : double = 0.7
  state sum : double = k * third
  let a = sample / (tau + sample)
  let gain = 1 - exp(0 - sample / tau)
  let next_low = low + a * (x - low)
  y = limit(next_low * 1.1, -0.25, 0.25) / third
  z = sqrt(abs(sum)) + sin(x) * gain + y / tau * 1 s
  next low = next_low
  next sum = sum + k * x
}

process Main {
  in  x : double @ 1 ms
  out y : double @ 1 ms
  out z : double @ 1 ms

  communication {
    law : Law(tau = 7 ms)

    x     -> law.x
    law.y -> y
    law.z -> z
  }

  composition {
    mu law
  }
}

submodel Signal {
  out x : double

  state s : double = 0.3
  x = s
  next s = 3.7 * s * (1 - s)
}

environment Bench for Main {
  signal : Signal

  signal.x -> x
  y        -> _
  z        -> _
}
"""


def by_hand(count: int) -> list[tuple[float, float, float]]:
    """The law above in numpy's binary32, the signal in double precision."""
    single = np.float32
    sample, tau, k = single(0.001), single(0.007), single(0.1)
    third = 1.0 / 3
    # What depends on parameters alone is computed in double precision, and rounded.
    a = single(float(sample) / (0.007 + float(sample)))
    gain = single(1 - np.exp(0 - float(sample) / 0.007))
    low, total = single(0.7), single(float(k) * third)
    signal, found = 0.3, []
    for _ in range(count):
        signal = 3.7 * signal * (1 - signal)
        x = single(signal)
        next_low = low + a * (x - low)
        y = min(max(next_low * single(1.1), single(-0.25)), single(0.25)) / single(third)
        z = np.sqrt(np.abs(total)) + single(np.sin(float(x))) * gain + y / tau * single(1)
        low, total = next_low, total + k * x
        found.append((float(x), float(y), float(z)))
    return found


@pytest.mark.parametrize("options", [{"level": "reference"}, {"level": 0}, {"level": 1}, {"target": "c"}], ids=str)
def test_a_law_is_that_of_numpy(options: dict[str, str | int]) -> None:
    run = cspdiag.parse(LAW, "law.csp", real="float32").run(until=0.2005, **options)  # type: ignore[arg-type]
    expected = by_hand(200)
    passed: dict[str, list[object]] = {name: [] for name in "xyz"}
    for communication in run.communications:
        passed[communication[1].removeprefix("Main.")].append(communication[2])
    assert passed["x"] == [x for x, _, _ in expected]
    assert passed["y"] == [y for _, y, _ in expected[: len(passed["y"])]]
    assert passed["z"] == [z for _, _, z in expected[: len(passed["z"])]]
    assert len(passed["z"]) >= 199


@pytest.mark.parametrize("value", [1e50, -1e50, 1e-50])
def test_a_setting_that_single_precision_does_not_have_is_refused(value: float) -> None:
    with pytest.raises(cspdiag.ProgramError) as refused:
        cspdiag.parse(LAW, "law.csp", real="float32").run(until=0.001, set={"law.k": value})
    (found,) = refused.value.diagnostics
    assert (found.code, found.span.line) == ("E0908", 5)
    assert f"{value!r} is too {'large' if abs(value) > 1 else 'small'}" in found.message


def test_an_argument_is_reported_once_with_those_that_follow_from_it() -> None:
    text = LAW.replace("process Main {", "process Main(k: double = 1) {").replace("tau = 7 ms", "tau = 7 ms, k = k * 2")
    with pytest.raises(cspdiag.ProgramError) as refused:
        cspdiag.parse(text, "law.csp", real="float32").run(until=0.001, set={"Main.k": 3e50})
    assert [(found.code, found.span.line) for found in refused.value.diagnostics] == [("E0908", 21)]
