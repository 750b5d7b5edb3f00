"""What each of the small models demonstrates.

The last value of every output of the outermost process is the safe value that it is set to at the end.
"""

from __future__ import annotations

import numpy as np

from tests.models.programs import run


def test_commstime_counts_and_is_ended_by_its_consumer() -> None:
    result = run("commstime/commstime.csp")
    assert result.outcome.ended == "terminated"
    assert result.outcome.time == 0
    assert list(result["Commstime.b"]) == list(range(1000))
    assert list(result["Commstime.d"][:3]) == [1, 2, 3]


def test_symmetric_philosophers_deadlock_holding_one_fork_each() -> None:
    result = run("dining/deadlock.csp")
    assert result.outcome.ended == "deadlock"
    assert result.outcome.time == 10_000_000
    report = str(result.outcome.deadlock)
    assert all(f"philosopher[{i}]" in report and f"fork[{i}]" in report for i in range(5))
    assert "deadlock.csp" in report or "table.csp" in report
    assert len(result.communications) == 5


def test_one_left_handed_philosopher_prevents_the_deadlock() -> None:
    result = run("dining/dining.csp")
    assert result.outcome.ended == "terminated"
    assert len(result.communications) == 5 * 3 * 4


def test_bounded_buffer_keeps_the_order_and_its_bound() -> None:
    result = run("buffer/buffer.csp")
    assert result.outcome.ended == "terminated"
    *done, safe = result["done"]
    assert safe == 0
    assert sorted(done) == [100 * producer + item for producer in range(3) for item in range(20)]
    for producer in range(3):
        items = [value for value in done if value // 100 == producer]
        assert items == sorted(items)
    level = highest = 0
    for _, channel, _, _, _ in result.communications:
        level += {"Line.arrivals": 1, "Line.departures": -1}.get(channel, 0)
        assert 0 <= level <= 4
        highest = max(highest, level)
    assert highest == 4


def test_a_ring_increments_the_token_in_each_cell() -> None:
    result = run("ring/ring.csp")
    assert result.outcome.ended == "terminated"
    assert list(result["Ring.back"]) == [10, 20, 30, 40, 50]


def test_ring_grows_by_a_constant() -> None:
    assert list(run("ring/ring.csp", set={"cells": "100", "laps": "2"})["Ring.back"]) == [100, 200]


def test_cascade_follows_the_speed_and_holds_it_under_load() -> None:
    result = run("cascade/cascade.csp", until="500 ms")
    assert result.outcome.ended == "time limit"
    time, speed = result.time("speed"), result["speed"]
    before, after = (time > 0.15) & (time < 0.3), time > 0.4
    assert np.all(np.abs(speed[before] - 100) < 2)
    assert np.all(np.abs(speed[after] - 100) < 2)
    assert np.max(speed) < 110
    current = result["current"]
    assert np.max(current) < 4.4
    assert abs(np.mean(current[result.time("current") > 0.45]) - 1.02) < 0.02
    assert 9 <= len(current) / len(speed) <= 11
    assert not any(result.outcome.missed.values())


def test_emergency_button_takes_the_voltage_and_drops_the_brake_at_the_next_tick() -> None:
    result = run("emergency/emergency.csp")
    assert result.outcome.ended == "terminated"
    pressed, tick = 0.9, 0.002
    time, voltage, brake = result.time("control"), result["control"], result["brake"]
    assert np.all(voltage[(time > 0.2) & (time <= pressed)] > 5)
    assert np.all(voltage[time > pressed + tick / 2] == 0)
    assert np.isclose(result.time("brake")[np.flatnonzero(brake)[0]], pressed + tick)
    speed = result["feedback"]
    assert np.max(speed) > 190
    assert speed[-1] < 1
    assert list(result["halted"]) == [True, False]


def test_watchdog_loses_the_sensor_three_times_and_gives_up() -> None:
    result = run("watchdog/watchdog.csp")
    assert result.outcome.ended == "terminated"
    assert list(result["losses"]) == [1, 2, 3, 0]
    assert np.allclose(result.time("losses")[:3], [30, 40, 50], atol=0.5)
    heater, time = result["heater"], result.time("heater")
    assert all(heater[np.flatnonzero(time == lost)[-1]] == 0 for lost in result.time("losses")[:3])
    assert heater[-1] == 0
