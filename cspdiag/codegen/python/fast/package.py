"""The package of ``-O1``: from outside the same as that of ``-O0``."""

from __future__ import annotations

from collections.abc import Mapping

from cspdiag.codegen.options import Options
from cspdiag.codegen.python import package as plain
from cspdiag.codegen.python.fast.laws.environments import environment_module
from cspdiag.codegen.python.fast.processes import process_module
from cspdiag.codegen.python.plain.external import ExternalModules
from cspdiag.codegen.python.plain.laws.submodels import submodel_module
from cspdiag.codegen.python.plain.network import network_view
from cspdiag.codegen.python.text.names import PackageNames
from cspdiag.codegen.shared.render import renderer
from cspdiag.network.ir.network import CoreNetwork, ProcessClass
from cspdiag.optimize import PASSES, optimize

_PASSES_HIDING_PROCESSES = ("fuse",)
"""Passes after which the start and the end of each process are no longer known."""

_PASSES_HIDING_VARIABLES = ("constants", "dead", "fuse")
"""Passes that may remove variables which are to be recorded."""


def generate(network: CoreNetwork, modules: Mapping[str, str], options: Options) -> dict[str, str]:
    """The files of a package, by path from its folder; see ``python.generate``."""
    left_out = _PASSES_HIDING_PROCESSES * options.observed + _PASSES_HIDING_VARIABLES * options.probed
    optimized = optimize(network, [entry for entry in PASSES if entry.name not in left_out])
    render = renderer("python", options.templates)
    names = PackageNames(optimized)
    external = ExternalModules(modules)
    package = names.package
    files = plain.frame(optimized, names, external, environment_module, render, optimized=True)
    files[f"{package}/network.py"] = render("network.py.j2", module=network_view(optimized, names, external))
    for class_ in optimized.classes:
        if isinstance(class_, ProcessClass):
            if class_.external is not None:
                continue
            module = process_module(class_, optimized, names, external, options)
        else:
            module = submodel_module(class_, names, external)
        files[f"{package}/{names.modules[class_.name]}.py"] = render("class.py.j2", module=module)
    return dict(sorted(files.items()))
