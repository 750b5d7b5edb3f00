"""Programs and environments whose constants can be set after they are compiled: as fixed parameters of their FMUs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from cspdiag import pipeline
from cspdiag.base.record import EMPTY, record, replaced
from cspdiag.network.lower.program import selection
from cspdiag.network.lower.promoted import with_every_parameter
from cspdiag.network.lower.settable import choice_of, values_in, with_parameters
from cspdiag.network.lower.setting_paths import of_root
from cspdiag.syntax import ast

if TYPE_CHECKING:
    from cspdiag.network.ir.network import CoreNetwork
    from cspdiag.network.lower.settable import Settable
    from cspdiag.pipeline import Built


@record
class SettableNetwork:
    """A network with ``fixed`` parameters, and what else has names for settings, with the reason why each is a part of
    what is compiled.
    """

    network: CoreNetwork
    constants: Mapping[str, str] = EMPTY

    @property
    def names(self) -> list[str]:
        """What can be set before a run, and not during it."""
        return [item.name for item in self.network.parameters if item.fixed]


def settable(built: Built, top: str | None, environment: str | None) -> SettableNetwork:
    """The network of a program in which constants, and arguments of instances, are fixed parameters, as far as nothing
    that is compiled depends on their values. The program has no errors; ``top`` and ``environment`` are those with
    which it was built.

    With ``double`` in single precision there are none: constants are computed in double precision, parameters are not.
    """
    checked, overrides = built.checked, built.overrides.parameters
    program, analysis = checked.program, checked.analysis
    assert built.network is not None
    assert program is not None
    if analysis is None or checked.real != "double":
        return SettableNetwork(built.network)
    process, environments = selection(program, analysis, top, environment)
    choice = choice_of(program, process, next(iter(environments), None))
    given = of_root(overrides, process)

    def attempt(chosen: Sequence[Settable]) -> CoreNetwork | None:
        """The network in which these are parameters; None if something that they are used for does not allow it."""
        # What was set for an argument is the value of its parameter.
        moved = {item.path: item.setting for item in chosen if item.owner is not None and item.path in given}
        values = {**program.overrides, **{setting: given[path] for path, setting in moved.items()}}
        left = {key: value for key, value in overrides.items() if key.rpartition(":")[2] not in moved}
        made = pipeline.changed(checked, values, trees=with_parameters(program.trees, chosen))
        return pipeline.compile_network(made, top=top, environment=environment, overrides=left)

    chosen, constants = choice.settable, dict(choice.constants)
    network = attempt(chosen)
    if network is None:
        chosen = tuple(item for item in choice.settable if attempt((item,)) is not None)
        network = attempt(chosen)
    if network is None:
        return SettableNetwork(built.network, constants)
    names = {item.setting for item in chosen}
    others = (item.setting for item in choice.settable if item.setting not in names)
    constants |= dict.fromkeys(others, "a value that has to be known when the program is compiled")
    parameters = tuple(replaced(item, fixed=item.name in names) for item in network.parameters)
    return SettableNetwork(replaced(network, parameters=parameters), constants)


def settable_environment(built: Built, top: str | None, environment: str) -> SettableNetwork:
    """As ``settable``, for an environment by itself: the parameters of its instances."""
    program, given = built.checked.program, built.overrides.parameters
    assert built.network is not None
    assert program is not None
    definition = program.definitions[environment]
    assert isinstance(definition, ast.EnvironmentDefinition)
    own = {
        path: value for path, value in values_in(program, definition).items() if f"{environment}:{path}" not in given
    }
    network = pipeline.compile_network(built.checked, top=top, environment=environment, overrides={**own, **given})
    if network is None:
        return SettableNetwork(built.network)
    chosen = next(item for item in network.environments if item.name == environment)
    return SettableNetwork(with_every_parameter(network, chosen))
