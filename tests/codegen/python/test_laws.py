"""Generated submodels and environments compute what the reference interpreter computes, sample by sample."""

from __future__ import annotations

import math
import random
from collections.abc import Iterator
from typing import Any

import pytest

from cspdiag.codegen.python.plain.laws.submodels import signal_names
from cspdiag.codegen.python.text.names import PackageNames
from cspdiag.model.types import BoolType, EnumType, IntType, RealType, StructType, Type
from cspdiag.network.ir.equations import ExternalCall
from cspdiag.network.ir.network import Instantiation, SubmodelClass
from cspdiag.runtime import Constant, Discard
from cspdiag.semantics.equations.laws import Law
from cspdiag.semantics.values import Cell
from cspdiag.simulate.run.package import LoadedPackage
from tests.codegen.packages import MODELS, OWN, network, package

SAMPLES = 200


def _by_hand(class_: SubmodelClass) -> bool:
    return class_.external is not None or any(isinstance(part, ExternalCall) for part in class_.equations)


def laws() -> Iterator[tuple[str, str]]:
    for name in (*MODELS, *OWN):
        entry = network(name)
        submodels = {c.name for c in entry.classes if isinstance(c, SubmodelClass) and not _by_hand(c)}
        for instance in entry.instances:
            if instance.class_name in submodels:
                yield name, instance.path


def plants() -> Iterator[tuple[str, str]]:
    for name in (*MODELS, *OWN):
        for environment in network(name).environments:
            if environment.system is not None and not _by_hand(environment.system):
                yield name, environment.name


@pytest.fixture
def loaded(request: pytest.FixtureRequest) -> Iterator[LoadedPackage]:
    name = request.node.callspec.params["name"]
    made = LoadedPackage(network(name).name, package(name))
    yield made
    made.close()


def some_value(kind: Type, source: random.Random) -> Any:
    match kind:
        case RealType():
            return source.choice((source.uniform(-2, 2), source.uniform(-0.1, 0.1), 0.0))
        case IntType():
            return source.randint(0, 3)
        case BoolType():
            return source.random() < 0.5
        case EnumType(literals=literals):
            return source.randrange(len(literals))
    pytest.skip(f"no values of {kind} are made here")


def same(one: Any, other: Any) -> bool:
    if isinstance(one, tuple):
        return len(one) == len(other) and all(map(same, one, other))
    if isinstance(one, float):
        return math.isclose(one, other, rel_tol=1e-12, abs_tol=1e-12)
    return bool(one == other)


def in_python(value: Any, kind: Type, loaded: LoadedPackage) -> Any:
    """A value of the network in the form that it has in generated code."""
    if isinstance(kind, StructType):
        parts = (in_python(part, field, loaded) for part, (_, field) in zip(value, kind.fields, strict=True))
        return getattr(loaded.module("types"), kind.name)(*parts)
    return value


def instance_of(name: str, loaded: LoadedPackage, class_: SubmodelClass, instance: Instantiation) -> Any:
    names, package_names = signal_names(class_), PackageNames(network(name))
    made = getattr(loaded.module(package_names.modules[class_.name]), package_names.classes[class_.name])
    types = {parameter.name: parameter.type for parameter in class_.parameters}
    tunable = {parameter.name for parameter in class_.parameters if parameter.tunable}
    arguments = {
        names[key]: Cell(made_value) if key in tunable else made_value
        for key, value in instance.arguments
        for made_value in (in_python(value, types[key], loaded),)
    }
    ports = {names[p.name]: Constant(None) if p.direction == "in" else Discard() for p in class_.ports}
    return made(instance.path, **arguments, **ports)


@pytest.mark.parametrize(("name", "path"), list(laws()))
def test_submodels_calculate_like_the_interpreter(name: str, path: str, loaded: LoadedPackage) -> None:
    instance = next(entry for entry in network(name).instances if entry.path == path)
    class_ = network(name).class_named(instance.class_name)
    assert isinstance(class_, SubmodelClass)
    generated = instance_of(name, loaded, class_, instance)
    tunable = {parameter.name for parameter in class_.parameters if parameter.tunable}
    reference = Law(class_, {key: Cell(value) if key in tunable else value for key, value in instance.arguments})
    outputs = [port.name for port in class_.ports if port.direction == "out"]
    source = random.Random(path)
    for _ in range(SAMPLES):
        given = {port.name: some_value(port.type, source) for port in class_.ports if port.direction == "in"}
        expected = reference.sample(**given)
        calculated = generated.calculate(*given.values())
        outcome = expected[outputs[0]] if len(outputs) == 1 else tuple(expected[output] for output in outputs)
        assert same(outcome, calculated)


@pytest.mark.parametrize(("name", "environment"), list(plants()))
def test_environments_advance_like_the_interpreter(name: str, environment: str, loaded: LoadedPackage) -> None:
    entry = next(entry for entry in network(name).environments if entry.name == environment)
    system = entry.system
    assert system is not None
    generated = loaded.module("environments").ENVIRONMENTS[environment]()
    reference = Law(system, {})
    given = {port.name: port.type for port in system.ports if port.direction == "in"}
    outputs = [port.name for port in system.ports if port.direction == "out"]
    source = random.Random(environment)
    generated.start()
    inputs = {port: generated.drivers[port].read() for port in given}
    now = 0
    for instant in sorted({entry.step * k for k in range(SAMPLES)} | {700_000 * k for k in range(100)}):
        if instant > now:
            signals = reference.evaluate(**inputs)
            began = reference.time
            reference.advance(signals, (instant - now) / 1e9, discrete=instant % entry.step == 0)
            reference.time = instant / 1e9
            assert began == now / 1e9
            generated.advance(instant)
            now = instant
        expected = reference.evaluate(**inputs)
        for output in outputs:
            assert same(expected[output], generated.drivers[output].read()), (output, instant)
        inputs = {port: some_value(kind, source) for port, kind in given.items()}
        for port, value in inputs.items():
            generated.drivers[port].write(value)
