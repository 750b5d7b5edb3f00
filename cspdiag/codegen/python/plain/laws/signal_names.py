"""The names of the signals of an environment in its module, and of the attributes with its states."""

from __future__ import annotations

from collections.abc import Iterable

from cspdiag.codegen.python.plain.laws.submodels import INTEGRATION
from cspdiag.codegen.python.text.names import Names, PackageNames
from cspdiag.codegen.shared.laws.equations import signal_types
from cspdiag.codegen.shared.names import words
from cspdiag.network.ir.network import CoreNetwork, Environment
from cspdiag.optimize import lower_for_targets

MEMBERS = INTEGRATION | {"self", "now", "steps", "start", "advance", "drivers", "on_miss", "_evaluate"}
"""Names that the class of an environment and its methods use themselves."""


def signal_names(types: Iterable[str], members: Iterable[str], names: PackageNames) -> Names:
    """The names of the signals of an environment in its module."""
    found = Names({*members, *names.constants.values()})
    for name in types:
        found[name]
    return found


def state_attributes(environment: Environment, network: CoreNetwork) -> list[str]:
    """The attributes with the states of an environment, in their order, in the code of ``-O0``."""
    lowered = lower_for_targets(network)
    system = next(entry.system for entry in lowered.environments if entry.name == environment.name)
    if system is None:
        return []
    tunable = words("parameters" if lowered.parameters else "")
    names = signal_names(signal_types(system), {*MEMBERS, *tunable}, PackageNames(lowered))
    return [names[state.name] for state in system.states]
