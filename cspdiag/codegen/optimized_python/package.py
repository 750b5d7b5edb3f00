"""The package of ``-O1``: outside as that of ``-O0``."""

from __future__ import annotations

from collections.abc import Mapping

from cspdiag.codegen import python
from cspdiag.codegen.optimized_python.environments import environment_module
from cspdiag.network.ir import Network


def generate(network: Network, modules: Mapping[str, str], *, traced: bool, probed: bool) -> dict[str, str]:
    """The files of a package, by path from its folder; see ``python.generate``.

    ``traced`` code tells an observer of every communication, other code of those of external ports only.
    """
    return python.generate(network, modules, environment_module)
