"""What a driver returns becomes a value of its port's type, or is refused."""

from __future__ import annotations

from enum import IntEnum
from fractions import Fraction
from typing import Any, NamedTuple

import numpy
import pytest

from cspdiag.runtime import (
    EventInput,
    Fault,
    Network,
    SampledInput,
    array,
    boolean,
    double,
    enumeration,
    int8,
    integer,
    ms,
    record,
    single,
    text,
)
from tests.runtime.support import Body


class Gear(IntEnum):
    park = 0
    drive = 1


class Pose(NamedTuple):
    x: float
    gear: int


gear = enumeration(Gear)
pose = record(Pose, double, gear)


@pytest.mark.parametrize(
    ("accepts", "given", "value"),
    [
        (double, 3, 3.0),
        (double, numpy.float32(0.5), 0.5),
        (single, 0.1, 0.10000000149011612),
        (boolean, 1, True),
        (boolean, False, False),
        (boolean, numpy.True_, True),
        (integer(int8), numpy.int64(-128), -128),
        (gear, 1, Gear.drive),
        (gear, Gear.park, Gear.park),
        (gear, numpy.uint8(1), Gear.drive),
        (double, numpy.array(0.5), 0.5),
        (double, Fraction(1, 4), 0.25),
        (integer(int8), numpy.array(3), 3),
        (boolean, numpy.array(True), True),
        (boolean, numpy.int8(0), False),
        (text, "x", "x"),
        (array(double, 2), [1, 2.5], (1.0, 2.5)),
        (array(double, 2), numpy.array([1.0, 2.5]), (1.0, 2.5)),
        (pose, (1, 1), Pose(1.0, Gear.drive)),
    ],
)
def test_a_value_is_made_one_of_the_type(accepts: Any, given: Any, value: Any) -> None:
    found = accepts(given)
    assert found == value
    assert type(found) is type(value)


@pytest.mark.parametrize(
    ("accepts", "given", "error"),
    [
        (double, "1.5", TypeError),
        (double, None, TypeError),
        (double, True, TypeError),
        (double, numpy.True_, TypeError),
        (single, False, TypeError),
        (single, 1e39, Fault),
        (single, -1e39, Fault),
        (double, [1.0], TypeError),
        (double, 10**400, Fault),
        (boolean, 2, TypeError),
        (boolean, 1.0, TypeError),
        (boolean, None, TypeError),
        (integer(int8), True, TypeError),
        (integer(int8), numpy.False_, TypeError),
        (integer(int8), 1.0, TypeError),
        (integer(int8), 128, Fault),
        (integer(int8), 10**400, Fault),
        (integer(int8), float("nan"), TypeError),
        (gear, 7, ValueError),
        (gear, None, TypeError),
        (gear, True, TypeError),
        (gear, numpy.False_, TypeError),
        (gear, 1.0, TypeError),
        (gear, numpy.float64(1.0), TypeError),
        (gear, "drive", TypeError),
        (pose, (1.0, True), TypeError),
        (double, numpy.array(True), TypeError),
        (double, numpy.array("1.5"), TypeError),
        (double, numpy.array([1.0]), TypeError),
        (double, numpy.complex128(1 + 2j), TypeError),
        (double, numpy.timedelta64(5, "s"), TypeError),
        (integer(int8), numpy.array(True), TypeError),
        (integer(int8), numpy.array([1]), TypeError),
        (boolean, numpy.array([True]), TypeError),
        (boolean, numpy.float64(1.0), TypeError),
        (array(double, 2), {1.0, 2.0}, TypeError),
        (array(double, 2), {0: 1.0, 1: 2.0}, TypeError),
        (text, 1, TypeError),
        (array(double, 2), [1.0], TypeError),
        (array(double, 2), "12", TypeError),
        (array(double, 2), 1.0, TypeError),
        (pose, (1.0,), TypeError),
        (pose, (1.0, 9), ValueError),
    ],
)
def test_another_value_is_refused(accepts: Any, given: Any, error: type[Exception]) -> None:
    with pytest.raises(error):
        accepts(given)


def test_a_refusal_says_what_is_expected() -> None:
    with pytest.raises(TypeError, match=r"^True is no Gear$"):
        gear(True)


@pytest.mark.parametrize("real_time", [False, True])
@pytest.mark.parametrize("blocking", [False, True])
@pytest.mark.parametrize("sampled", [False, True])
def test_a_driver_that_returns_another_value_is_named(sampled: bool, blocking: bool, real_time: bool) -> None:
    class Card:
        def __init__(self) -> None:
            self.blocking = blocking

        def read(self) -> str:
            return "high"

    port: SampledInput[float] | EventInput[float]
    if sampled:
        port = SampledInput("Top.level", period=ms, driver=Card(), accepts=double)
    else:
        port = EventInput("Top.level", driver=Card(), accepts=double)
    end = port.reader()

    async def top() -> None:
        await end.read()

    outcome = Network(Body(top), [port]).run(real_time=real_time)
    assert str(outcome.error) == "driver Card failed to read at port Top.level: TypeError: 'high' is not a number"
