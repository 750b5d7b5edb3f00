"""Makes parameters of the program of what a sweep varies, so one compiled program serves all its values."""

from __future__ import annotations

from collections.abc import Iterable

from cspdiag.base.record import replaced
from cspdiag.model.program import Value
from cspdiag.network.ir.equations import SubmodelEquation
from cspdiag.network.ir.expressions import LiteralValue, TunableValue
from cspdiag.network.ir.network import CoreNetwork, Environment, ProgramParameter


def can_be_promoted(environment: Environment | None, path: str) -> bool:
    """Whether a path is that of a parameter in the environment whose value is a number that is read when it starts."""
    return any(item.name == path for item in _literal_constants(environment))


def _literal_constants(environment: Environment | None) -> list[SubmodelEquation]:
    system = None if environment is None else environment.system
    return [] if system is None else [item for item in system.constants if isinstance(item.value, LiteralValue)]


def promoted(network: CoreNetwork, environment: Environment | None, paths: Iterable[str]) -> CoreNetwork:
    """The network of one environment in which these parameters of instances are parameters of the program."""
    chosen = {item.name: item for item in _literal_constants(environment) if item.name in set(paths)}
    if environment is None or environment.system is None or not chosen:
        return network
    added = []
    for item in chosen.values():
        assert isinstance(item.value, LiteralValue)
        added.append(
            ProgramParameter(name=item.name, doc=item.doc, span=item.span, type=item.type, value=item.value.value)
        )
    constants = tuple(
        replaced(item, value=TunableValue(type=item.type, name=item.name, of_program=True, span=item.span))
        if item.name in chosen
        else item
        for item in environment.system.constants
    )
    system = replaced(environment.system, constants=constants)
    return replaced(
        network,
        parameters=(*network.parameters, *added),
        environments=tuple(
            replaced(entry, system=system) if entry.name == environment.name else entry
            for entry in network.environments
        ),
    )


def is_same_but_for(one: CoreNetwork, other: CoreNetwork, paths: Iterable[str]) -> bool:
    """Whether two promoted networks differ in nothing but the first values of these parameters."""
    names = set(paths)
    return _without_values(one, names) == _without_values(other, names)


def _without_values(network: CoreNetwork, names: set[str]) -> CoreNetwork:
    nothing: Value = 0
    return replaced(
        network,
        parameters=tuple(replaced(item, value=nothing) if item.name in names else item for item in network.parameters),
    )
