"""What devices make of messages."""

from __future__ import annotations

import time
from math import inf, isnan
from typing import Any

import pytest

from cspdiag.devices.failure import DeviceError
from cspdiag.devices.messages import MILLISECOND, MessageDevice, decoded, parsed


def test_a_message_that_is_no_json_is_a_text_which_its_port_refuses() -> None:
    assert decoded(b"high") == "high"
    assert decoded(3000 * b"[") == 3000 * "["


@pytest.mark.parametrize("text", ["nan", "-nan", "NaN", "-NaN", "NAN"])
def test_a_nan_is_read_as_printf_and_json_libraries_write_it(text: str) -> None:
    assert isnan(decoded(text.encode()))


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("inf", inf),
        ("-inf", -inf),
        ("INF", inf),
        ("Infinity", inf),
        ("-infinity", -inf),
        ("[1, -inf]", [1, -inf]),
        ("info", "info"),
        ("+inf", "+inf"),
    ],
)
def test_an_infinity_is_read_as_printf_and_json_libraries_write_it(text: str, value: Any) -> None:
    assert decoded(text) == value


def test_numbers_in_objects_may_be_infinite_and_names_stay() -> None:
    assert parsed(b'{"level": inf, "inf": 1, "nan": -inf}') == {"level": inf, "inf": 1, "nan": -inf}


def test_what_is_nested_too_deeply_is_refused_after_a_nan_as_well() -> None:
    with pytest.raises(ValueError, match="nested too deeply"):
        parsed(b"[nan, " + 100_000 * b"[")


class _Device(MessageDevice):
    def connect(self) -> None:
        self.receive("level", 1)

    def disconnect(self) -> None:
        pass

    def send(self, port: str, value: Any) -> None:
        pass


def test_names_without_a_port_are_in_the_message_of_a_silent_one() -> None:
    device = _Device("one", {"level": "sampled"}, timeout=10 * MILLISECOND)
    device.open()
    for number in range(100):
        device.receive(f"levle{number}", 1)
    time.sleep(0.02)
    with pytest.raises(DeviceError, match=r"s; without a port there were levle0, .*levle7: is the sender still there"):
        device.read("level")
