"""The instants of several periods, whether or not their phases are remembered."""

from __future__ import annotations

import pytest

from cspdiag.runtime import SampledInput, SampledOutput
from cspdiag.runtime.outside import instants
from cspdiag.runtime.outside.instants import Instants


class _Sensor:
    def __init__(self, name: str, log: list[str]) -> None:
        self.name = name
        self.log = log

    def read(self) -> float:
        self.log.append(self.name)
        return 0.0


class _Plant:
    step = 4

    def __init__(self, log: list[str]) -> None:
        self.log = log
        self.drivers: dict[str, object] = {}

    def start(self) -> None:
        self.log.append("start")

    def advance(self, now: int) -> None:
        self.log.append(f"plant {now}")


@pytest.mark.parametrize("remembered", [0, 3, 1000])
def test_every_tick_and_every_grid_instant_is_met_in_order(remembered: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(instants, "_REMEMBERED", remembered)
    log: list[str] = []
    ports = (
        SampledInput[float]("slow", period=10, driver=_Sensor("slow", log)),
        SampledInput[float]("fast", period=6, driver=_Sensor("fast", log)),
        SampledInput[float]("shifted", period=10, offset=3, driver=_Sensor("shifted", log)),
        SampledOutput[float]("out", period=15, offset=11),
    )
    times = Instants(ports, _Plant(log))
    expected: list[str] = []
    met = []
    now: int | None = 0
    while now is not None and now < 200:
        now = times.after(now)
        assert now is not None
        met.append(now)
        times.meet(now)
        expected.append(f"plant {now}")
        expected += ["slow"] * (now % 10 == 0) + ["fast"] * (now % 6 == 0) + ["shifted"] * (now % 10 == 3)
    assert met == [t for t in range(1, met[-1] + 1) if 0 in (t % 4, t % 6, t % 10, (t - 3) % 10, (t - 11) % 15)]
    assert log == expected


def test_nothing_happens_between_instants() -> None:
    log: list[str] = []
    times = Instants((SampledInput[float]("fast", period=6, driver=_Sensor("fast", log)),), _Plant(log))
    times.meet(5)
    times.meet(7)
    assert not log
    assert times.after(5) == 6


def test_without_periods_there_are_no_instants() -> None:
    assert Instants((), None).after(5) is None
