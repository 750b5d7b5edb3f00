"""A plant as a Gymnasium environment."""

import warnings
from pathlib import Path

import numpy
import pytest

import cspdiag

gymnasium = pytest.importorskip("gymnasium", reason="needs gymnasium: pip install 'cspdiag[gym]'")

from gymnasium.utils.env_checker import check_env  # noqa: E402

from cspdiag.gym import PlantEnv, PlantError  # noqa: E402

JIWY = Path(__file__).parent.parent.parent / "models" / "jiwy" / "jiwy.csp"
LIMITS = {"control_horizontal": 12, "control_vertical": (-12, 12)}


def test_gymnasium_accepts_it() -> None:
    with PlantEnv(JIWY, limits=LIMITS, until="50 ms") as env, warnings.catch_warnings():
        warnings.simplefilter("ignore")  # advice on unbounded observations
        check_env(env, skip_render_check=True)


def test_the_actions_of_the_program_give_what_the_program_observed() -> None:
    run = cspdiag.load(JIWY).run("Bench", until="3 s")
    names = ("control_horizontal", "control_vertical")
    written = {name: dict(zip(_nanoseconds(run.time(name)), run[name], strict=True)) for name in names}
    sampled = {name: dict(zip(_nanoseconds(run.time(name)), run[name], strict=True)) for name in run.signals}
    compared = 0
    with PlantEnv(JIWY, "Bench", until="3 s") as env:
        env.reset()
        action = numpy.zeros(2)
        for step in range(2999):
            now = step * 1_000_000
            action = numpy.array([written[name].get(now, held) for name, held in zip(names, action, strict=True)])
            observation, *_ = env.step(action)
            assert env.now == (step + 1) / 1000
            for name, value in zip(env.observation_names, observation, strict=True):
                expected = sampled[name].get(now + 1_000_000)
                if expected is not None:
                    assert value == expected, (name, now)
                    compared += 1
    assert compared > 8000


def _nanoseconds(seconds: numpy.ndarray) -> list[int]:
    return [round(second * 1e9) for second in seconds.tolist()]


PUMP = """
process Pump {
  in  level : double<m> @ 10 ms offset 3 ms
  in  full  : bool
  in  count : int @ 10 ms
  out inflow : double<m/s> @ 20 ms
  out gate : bool @ 10 ms
  out lamps : int

  composition { stop }
}

submodel Tank(start: double<m> = 1<m>) {
  in  inflow : double<m/s>
  in  gate   : bool
  in  lamps  : int
  out level  : double<m>
  out full   : bool
  out count  : int

  state content : double<m> = start
  der content = (if gate then inflow else 0<m/s>) + content * content * 1<1/m/s>
  level = content
  full  = content > 2<m>
  count = lamps
}

environment Bench for Pump step 7 ms {
  tank : Tank

  inflow     -> tank.inflow
  gate       -> tank.gate
  lamps      -> tank.lamps
  tank.level -> level
  tank.full  -> full
  tank.count -> count
}
"""


def _pump(**options: object) -> PlantEnv:
    return PlantEnv(cspdiag.parse(PUMP), **options)  # type: ignore[arg-type]


def test_bool_and_int_ports_are_numbers_within_their_limits() -> None:
    env = _pump()
    assert (env.action_names, env.observation_names) == (("inflow", "gate", "lamps"), ("level", "full", "count"))
    assert env.action_space.low[1:].tolist() == [0.0, -(2.0**63)]
    env.reset()
    observation, *_ = env.step([0.0, 1.0, 2.6])
    assert observation.tolist()[1:] == [0.0, 3.0]


def test_the_plant_is_evaluated_on_its_grid_and_at_each_tick() -> None:
    env = _pump(period="50 ms")
    env.reset()
    plant = env._plant
    assert list(plant.instants(0, 21_000_000)) == [
        3_000_000,
        7_000_000,
        10_000_000,
        13_000_000,
        14_000_000,
        20_000_000,
        21_000_000,
    ]


def test_an_action_holds_for_the_shortest_period_unless_one_is_given() -> None:
    env = _pump()
    env.reset()
    env.step([0, 0, 0])
    assert env.now == 0.01
    env = _pump(period=0.05)
    env.reset()
    env.step([0, 0, 0])
    assert env.now == 0.05


def test_a_fault_in_the_plant_ends_the_episode_with_its_text() -> None:
    env = _pump(reward=lambda observation, action: observation[0], until="100 s", set={"Bench.tank.start": 100.0})
    env.reset()
    for _ in range(10):
        observation, reward, terminated, truncated, info = env.step([0, 0, 0])
        if terminated:
            break
    assert terminated
    assert not truncated
    assert "not finite" in info["fault"] or "infinite" in info["fault"], info
    assert numpy.isfinite(observation).all()
    assert reward == observation[0]
    with pytest.raises(gymnasium.error.ResetNeeded, match="call reset"):
        env.step([0, 0, 0])


def test_an_episode_ends_by_the_condition_or_after_its_time() -> None:
    env = _pump(terminated=lambda observation: observation[0] > 1.015, until="30 ms")
    env.reset()
    ends = [env.step([0, 0, 0])[2:4] for _ in range(2)]
    assert ends == [(False, False), (True, False)]
    env = _pump(until="30 ms")
    env.reset()
    assert [env.step([0, 0, 0])[2:4] for _ in range(3)] == [(False, False), (False, False), (False, True)]


def test_an_episode_may_have_settings_of_its_own() -> None:
    env = _pump()
    observation, _ = env.reset(options={"set": {"tank.start": 3.0}})
    assert observation[0] == 3.0
    observation, _ = env.reset()
    assert observation[0] == 1.0


@pytest.mark.parametrize(
    ("attempt", "message"),
    [
        (lambda env: env.step([0.0]), r"the shape \(3,\) \(inflow, gate, lamps\), not \(1,\)"),
        (lambda env: env.step([float("nan"), 0.0, 0.0]), "an action is finite"),
        (lambda env: env.step("x"), "an action is an array of numbers, not 'x'"),
        (lambda env: env.reset(options={"seed": 1}), "there is no option 'seed'"),
        (lambda env: _pump(limits={"gat": 1}), "there is no port 'gat'; there are: count, full, gate"),
        (lambda env: _pump(limits={"gate": (1, 0)}), "leaves no value"),
        (lambda env: _pump(period=0), "a positive time"),
    ],
)
def test_wrong_arguments_are_refused_with_the_reason(attempt: object, message: str) -> None:
    env = _pump()
    env.reset()
    with pytest.raises(cspdiag.ArgumentError, match=message):
        attempt(env)  # type: ignore[operator]


def test_what_is_not_a_number_is_refused() -> None:
    text = PUMP.replace("out lamps : int", "out lamps : Mode").replace("in  lamps  : int", "in lamps : Mode")
    text = f"enum Mode {{ off, on }}\n{text.replace('count = lamps', 'count = 1')}"
    with pytest.raises(PlantError, match=r"`Pump.lamps` has values of the type Mode"):
        PlantEnv(cspdiag.parse(text))


def test_a_program_without_a_plant_is_refused() -> None:
    with pytest.raises(cspdiag.NoEnvironmentError, match="no environment with a plant"):
        PlantEnv(cspdiag.parse("process P { composition { stop } }"))
