"""A program that runs again and again in one process, with other parameters each time; see ``csp_sweep.h``."""

from __future__ import annotations

from collections.abc import Mapping

from cspdiag.base.files.resources import template_folder
from cspdiag.base.record import record
from cspdiag.codegen.c.network.environments import EnvironmentFiles
from cspdiag.codegen.c.package.linkage import NAMES, NO_NAMES
from cspdiag.codegen.c.package.package import described
from cspdiag.codegen.options import Options
from cspdiag.codegen.shared.render import renderer
from cspdiag.network.ir.network import CoreNetwork, Environment, SubmodelState

MAIN = "main_sweep.c"
_MAIN_OF_SIMULATION = "main_simulation.c"
_KERNEL = ("csp_sweep.c", "csp_sweep.h", "csp_sweep_measures.c", "csp_sweep_measures.h")


@record
class _Main:
    """What the template of the ``main`` is given; ``environment`` is the name of its files, empty if there is none."""

    top: str
    environment: str
    parameters: bool
    counts_misses: bool
    states: list[str]


def generate(network: CoreNetwork, modules: Mapping[str, str], environment: Environment | None) -> dict[str, str]:
    """The files, by path, to be compiled with ``CSP_TRACE``; states are numbered as in ``states_of``.

    Raises TargetError for what C cannot express.
    """
    package = described(network, modules, Options(level=1))
    name, members = "", list[str]()
    if environment is not None:
        lowered = next(entry for entry in package.network.environments if entry.name == environment.name)
        writer = EnvironmentFiles(lowered, package.network, package.names, package.types)
        name = writer.name
        own = {state.name: member for state, member in writer.state_members}
        members = [own[state.name] for state in states_of(environment)]
    main = _Main(
        top=package.project.top,
        environment=name,
        parameters=any(item.follows is None for item in network.parameters),
        counts_misses=environment is not None and environment.on_miss == "count",
        states=members,
    )
    folder = template_folder("sweep")
    files = {path: text for path, text in package.files.items() if path != _MAIN_OF_SIMULATION}
    files.update({path: (folder / path).read_text(encoding="utf-8") for path in _KERNEL})
    files[MAIN] = renderer("sweep")(f"{MAIN}.j2", main=main)
    return {**files, NAMES: NO_NAMES}


def states_of(environment: Environment | None) -> tuple[SubmodelState, ...]:
    """The states of an environment, in the order in which they are numbered."""
    return () if environment is None or environment.system is None else environment.system.states
