"""The Python target: a package that is as readable as one written by hand from the diagram.

The mapping is that of the paper (section 3): a class for each process with its ports as arguments of the constructor
and the composition as ``run``; the 20-process of a submodel; and a module that builds the network, the only one that
knows the drivers.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib.resources import files as package_files
from importlib.resources.abc import Traversable

from cspdiag.base.record import EMPTY
from cspdiag.codegen.python.plain.definitions import (
    constant_lines,
    enum_views,
    exception_views,
    parameters_module,
    struct_views,
)
from cspdiag.codegen.python.plain.external import ExternalModules, device_modules
from cspdiag.codegen.python.plain.laws.environments import EnvironmentModule, environment_module
from cspdiag.codegen.python.plain.laws.submodels import submodel_module
from cspdiag.codegen.python.plain.network import network_view
from cspdiag.codegen.python.plain.processes import process_module
from cspdiag.codegen.python.project import project_view
from cspdiag.codegen.python.text.imports import import_lines
from cspdiag.codegen.python.text.names import PackageNames
from cspdiag.codegen.shared.render import Render, Replacement, renderer
from cspdiag.network.ir.network import CoreNetwork, Environment, Network, ProcessClass

EnvironmentMaker = Callable[[Environment, Network, PackageNames, ExternalModules], EnvironmentModule]
"""Makes the module of an environment."""


def generate(
    network: CoreNetwork,
    modules: Mapping[str, str] | None = None,
    make_environment: EnvironmentMaker = environment_module,
    templates: Mapping[str, Replacement] = EMPTY,
) -> dict[str, str]:
    """The files of a package, by path from its folder.

    ``modules`` are the texts of external bodies, by the paths that ``external_paths`` returns; missing bodies are
    imported as installed modules. ``templates`` replace those of the target, by name.
    """
    render = renderer("python", templates)
    names = PackageNames(network)
    external = ExternalModules(modules or {})
    package = names.package
    files = frame(network, names, external, make_environment, render)
    files[f"{package}/network.py"] = render("network.py.j2", module=network_view(network, names, external))
    for class_ in network.classes:
        if isinstance(class_, ProcessClass):
            if class_.external is not None:
                continue
            module = process_module(class_, network, names, external)
        else:
            module = submodel_module(class_, names, external)
        files[f"{package}/{names.modules[class_.name]}.py"] = render("class.py.j2", module=module)
    return dict(sorted(files.items()))


def frame(
    network: Network,
    names: PackageNames,
    external: ExternalModules,
    make_environment: EnvironmentMaker,
    render: Render,
    *,
    optimized: bool = False,
) -> dict[str, str]:
    """The files except for the classes and the network: entry points, definitions, environments and the runtime.

    In ``optimized`` packages the linter accepts what the optimizer leaves.
    """
    package = names.package
    files: dict[str, str] = {}

    def add(path: str, template: str, **values: object) -> None:
        files[path] = render(template, **values)

    project = project_view(network, names, external)
    add("pyproject.toml", "pyproject.toml.j2", project=project, optimized=optimized)
    add("README.md", "README.md.j2", project=project)
    add(f"{package}/__init__.py", "__init__.py.j2", project=project)
    add(f"{package}/__main__.py", "__main__.py.j2", project=project)
    add(f"{package}/py.typed", "py.typed.j2")
    if network.constants:
        imports, constants = constant_lines(network, names)
        add(f"{package}/constants.py", "constants.py.j2", imports=imports, constants=constants)
    if network.parameters:
        add(f"{package}/parameters.py", "parameters.py.j2", module=parameters_module(network, names), project=project)
    if network.enums or network.structs:
        enums, (imports, structs) = enum_views(network, names), struct_views(network, names)
        add(f"{package}/types.py", "types.py.j2", imports=imports, enums=enums, structs=structs)
    if names.exceptions:
        add(f"{package}/exceptions.py", "exceptions.py.j2", exceptions=exception_views(names))

    environments = {
        names.environment_modules[entry.name]: make_environment(entry, network, names, external)
        for entry in network.environments
    }
    for module_name, view in environments.items():
        add(f"{package}/environments/{module_name}.py", "environment.py.j2", module=view)
    table = [(entry.name, names.environments[entry.name]) for entry in network.environments]
    wanted = {names.environment_modules[entry.name]: {names.environments[entry.name]} for entry in network.environments}
    imports = import_lines(wanted, ".")
    add(f"{package}/environments/__init__.py", "environments.py.j2", project=project, imports=imports, table=table)

    copies = external.copies(network)
    if copies:
        add(f"{package}/external/__init__.py", "external.py.j2")
        files.update({f"{package}/external/{path}": text for path, text in copies.items()})
    files.update({f"{package}/devices/{path}": text for path, text in device_modules(network).items()})
    files.update({f"{package}/runtime/{path}": text for path, text in runtime_files().items()})
    return files


def runtime_files() -> dict[str, str]:
    """The modules of the runtime, by path from its folder."""
    shared = "outside/standard_streams.py"
    own = package_files("cspdiag.base").joinpath("standard_streams.py").read_text(encoding="utf-8")
    return {**dict(_texts(package_files("cspdiag.runtime"), "")), shared: own}


def _texts(folder: Traversable, prefix: str) -> list[tuple[str, str]]:
    found: list[tuple[str, str]] = []
    for entry in folder.iterdir():
        if entry.is_dir() and entry.name != "__pycache__":
            found += _texts(entry, f"{prefix}{entry.name}/")
        elif entry.name.endswith(".py") or entry.name == "py.typed":
            found.append((prefix + entry.name, entry.read_text(encoding="utf-8")))
    return found
