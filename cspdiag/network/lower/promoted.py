"""Makes parameters of the program of parameters of instances in an environment: values that are read when it starts."""

from __future__ import annotations

from collections.abc import Iterable

from cspdiag.base.record import replaced
from cspdiag.model.types import has_real
from cspdiag.network.elaborate.finite import assured
from cspdiag.network.ir.equations import SubmodelEquation
from cspdiag.network.ir.expression_walk import signals_read
from cspdiag.network.ir.expressions import LiteralValue, TunableValue
from cspdiag.network.ir.network import CoreNetwork, Environment, ProgramParameter, SubmodelClass


def can_be_promoted(environment: Environment | None, path: str) -> bool:
    """Whether a path is that of a parameter in the environment whose value is a number that is read when it starts."""
    return any(item.name == path for item in _literal_constants(environment))


def _literal_constants(environment: Environment | None) -> list[SubmodelEquation]:
    system = None if environment is None else environment.system
    return [] if system is None else [item for item in system.constants if isinstance(item.value, LiteralValue)]


def promoted(network: CoreNetwork, environment: Environment | None, paths: Iterable[str]) -> CoreNetwork:
    """The network of one environment in which these parameters of instances are parameters of the program."""
    if environment is None:
        return network
    made, added = with_parameters(environment, paths)
    return _replaced(network, made, added) if added else network


def with_parameters(environment: Environment, paths: Iterable[str]) -> tuple[Environment, tuple[ProgramParameter, ...]]:
    """The environment in which these parameters of instances are parameters of the program, and those parameters."""
    wanted = set(paths)
    chosen = {item.name: item for item in _literal_constants(environment) if item.name in wanted}
    if environment.system is None or not chosen:
        return environment, ()
    added = []
    for item in chosen.values():
        assert isinstance(item.value, LiteralValue)
        added.append(
            ProgramParameter(
                name=item.name, doc=item.doc, span=item.span, type=item.type, value=item.value.value, fixed=True
            )
        )
    constants = tuple(
        replaced(item, value=TunableValue(type=item.type, name=item.name, of_program=True, span=item.span))
        if item.name in chosen
        else item
        for item in environment.system.constants
    )
    return replaced(environment, system=replaced(environment.system, constants=constants)), tuple(added)


def with_every_parameter(network: CoreNetwork, environment: Environment) -> CoreNetwork:
    """The network of one environment in which all parameters of instances are parameters of the program whose values
    decide nothing but numbers: no size, no step, no coefficient that the compiler computes. One whose name would be
    that of a part of something else stays a constant.

    What follows from them is tested: a value with which it is not finite is a fault when the environment starts.
    """
    if environment.system is None:
        return network
    decisive = environment.system.decisive
    taken = {item.name for item in (*network.parameters, *network.external_ports)}
    paths = (item.name for item in _literal_constants(environment) if "." in item.name)
    free = [path for path in paths if path not in decisive and path.partition(".")[0] not in taken]
    made, added = with_parameters(environment, free)
    if made.system is None or not added:
        return network
    return _replaced(network, replaced(made, system=_tested(made.system)), added)


def _replaced(network: CoreNetwork, made: Environment, added: tuple[ProgramParameter, ...]) -> CoreNetwork:
    return replaced(
        network,
        parameters=(*network.parameters, *added),
        environments=tuple(made if entry.name == made.name else entry for entry in network.environments),
    )


def _tested(system: SubmodelClass) -> SubmodelClass:
    """The system with tests of the constants, and of the coefficients of linear plants, that follow from parameters."""
    following: set[str] = set()
    constants = []
    for item in system.constants:
        if isinstance(item.value, TunableValue) or not following.isdisjoint(item.reads):
            following.add(item.name)
            item = replaced(item, value=assured(item.value) if has_real(item.type) else item.value)
        constants.append(item)
    linear = tuple(
        replaced(
            block,
            matrix=tuple(
                tuple(
                    entry if entry is None or following.isdisjoint(signals_read(entry)) else assured(entry)
                    for entry in row
                )
                for row in block.matrix
            ),
        )
        for block in system.linear
    )
    return replaced(system, constants=tuple(constants), linear=linear)
