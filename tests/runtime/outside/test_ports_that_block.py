"""Devices of which only some ports block, and devices for real time."""

from __future__ import annotations

from cspdiag.runtime import DevicePort, Network, Process, SampledInput, ms


class _Device:
    blocking = frozenset({"button"})


class _Clocked(_Device):
    needs_real_time = True

    def __init__(self) -> None:
        self.opened = False

    def open(self) -> None:
        self.opened = True

    def read(self, port: str) -> float:
        return 0.0


def test_a_device_may_name_the_ports_that_block() -> None:
    assert DevicePort(_Device(), "button").blocking
    assert not DevicePort(_Device(), "level").blocking


class _Waiting(Process):
    async def run(self) -> None:
        return


def test_a_device_for_real_time_is_not_opened_in_virtual_time() -> None:
    device = _Clocked()
    port: SampledInput[float] = SampledInput("Main.level", period=10 * ms, driver=DevicePort(device, "level"))
    outcome = Network(_Waiting("Main"), (port,)).run()
    assert str(outcome.error) == (
        "driver _Clocked failed to open at port Main.level: ValueError: it needs real time; "
        "on the command line: --real-time"
    )
    assert not device.opened
    assert outcome.time == 0
