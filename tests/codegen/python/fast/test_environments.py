"""Environments at ``-O1`` behave as at ``-O0``, to the last bit, whatever their inputs and instants."""

from __future__ import annotations

import random

import pytest

from cspdiag import pipeline
from cspdiag.model.types import RealType
from cspdiag.runtime import Environment, ms
from cspdiag.simulate.run.package import LoadedPackage
from tests.codegen.packages import NAMES, network, read

WITH_ENVIRONMENT = [
    (name, environment.name) for name in NAMES for environment in network(name).environments if environment.system
]


def values(environment: Environment) -> dict[str, str]:
    """The present values of all signals."""
    return {name: repr(signal.read()) for name, signal in environment.drivers.items() if hasattr(signal, "value")}


@pytest.mark.parametrize(("name", "environment"), WITH_ENVIRONMENT)
def test_signals_are_equal_at_every_instant(name: str, environment: str) -> None:
    source = random.Random(1)
    program = network(name)
    packages = [LoadedPackage(program.name, pipeline.generate(program, read, level=level)) for level in (0, 1)]
    plain, fast = (package.module("environments").ENVIRONMENTS[environment]() for package in packages)
    sampled = [port for port in program.external_ports if port.direction == "out" and port.sampling is not None]
    outputs = [port.name for port in sampled if isinstance(port.type, RealType)]
    try:
        plain.start()
        fast.start()
        assert values(fast) == values(plain)
        now = 0
        for _ in range(400):
            for output in outputs:
                if hasattr(plain.drivers[output], "value") and source.random() < 0.2:
                    given = source.choice((0.0, -0.0, source.uniform(-12, 12)))
                    plain.drivers[output].value = fast.drivers[output].value = given
            now += source.choice((1 * ms, 1 * ms, ms // 2, 3 * ms, 10 * ms))
            plain.advance(now)
            fast.advance(now)
            assert values(fast) == values(plain)
    finally:
        for package in packages:
            package.close()
