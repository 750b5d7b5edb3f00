"""A package in C: a header and a source for each class, the network, the environments, the kernel, and build files."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from weakref import ref

from cspdiag.base.files.resources import template_folder
from cspdiag.base.record import record
from cspdiag.codegen.c.interface.api import Interface, interface_files
from cspdiag.codegen.c.interface.layout import Layout
from cspdiag.codegen.c.laws.by_hand import FILE as TYPES_BY_HAND
from cspdiag.codegen.c.laws.by_hand import checks_file, refuse_missing_members
from cspdiag.codegen.c.laws.external import device_files, external_files
from cspdiag.codegen.c.laws.files_by_hand import definitions_in_c, headers_of_definitions, refuse_taken_names
from cspdiag.codegen.c.laws.fmus import fmu_files
from cspdiag.codegen.c.laws.laws import law_files
from cspdiag.codegen.c.laws.macros_by_hand import refuse_colliding_macros
from cspdiag.codegen.c.network.environments import environment_files
from cspdiag.codegen.c.network.network import network_files
from cspdiag.codegen.c.package.definitions import constants_header, plain_types_header, types_header
from cspdiag.codegen.c.package.folding import folded, folded_script
from cspdiag.codegen.c.package.includes import Includes, defined_in
from cspdiag.codegen.c.package.layouts import SUPPORT, Library, arranged
from cspdiag.codegen.c.package.linkage import NAMES, first_included, names_header
from cspdiag.codegen.c.package.parts import PARTS, parts_header
from cspdiag.codegen.c.package.refusals import foreign_devices, refuse
from cspdiag.codegen.c.process.leaves import require_first_member
from cspdiag.codegen.c.process.levels import separate_depths
from cspdiag.codegen.c.text.literals import in_comment
from cspdiag.codegen.c.text.names import PackageNames
from cspdiag.codegen.c.text.types import CTypes
from cspdiag.codegen.options import Options
from cspdiag.codegen.python.plain.docs import sentence
from cspdiag.codegen.python.project import PortRow, port_row
from cspdiag.codegen.shared.package_text import markdown, markdown_code
from cspdiag.codegen.shared.plain_text import one_line
from cspdiag.codegen.shared.render import renderer
from cspdiag.codegen.shared.target_error import TargetError
from cspdiag.network.ir.network import CoreNetwork, Environment, Network, ProcessClass
from cspdiag.optimize import PASSES_FOR_LOOPS, lower_for_targets, optimize

_SIMULATION = (
    "csp_linear.c",
    "csp_port_$(PORT).c",
    "csp_signals.c",
    "csp_simulation.c",
    "csp_simulation_posix.c",
    "csp_steering_posix.c",
    "csp_stream.c",
    "csp_stream_posix.c",
    "csp_tuning_posix.c",
    "csp_watch.c",
)
_CONFIGURATION = "csp_config.h"
_OF_BOARD = "csp_port_board.h"
"""Its names stay as they are: a board has one start, part of which is in assembly."""
_FILE_TEMPLATES = {".c": "source.c.j2", ".h": "header.h.j2"}


@record
class CProject:
    """What the templates for build files and README are given."""

    package: str
    top: str
    source: str
    source_code: str
    framework: str
    """For which the package is, such as `zephyr`; empty for the usual package."""
    doc: str
    ports: list[PortRow]
    environments: list[str]
    parameters: bool
    """Whether the program has parameters that may change while it runs."""
    files: list[str]
    program: list[str]
    kernel: list[str]
    simulation: list[str]
    simulated: bool


@record
class Simulation:
    """What the template for the `main` of the simulation is given."""

    top: str
    environments: list[Scenario]
    parameters: bool


@record
class CFile:
    """A generated source or header, for the template that wraps each of them; ``text`` does not end in a line break."""

    name: str
    text: str
    top: str
    source: str
    """The path of the program, escaped for use in a comment."""


@record
class Scenario:
    """An environment, for the template of the simulation's `main`."""

    name: str
    text: str
    counts: str


def lowered_for_c(network: CoreNetwork, level: int, *, observed: bool = False) -> Network:
    """The network from which C is generated at an optimization level; with ``observed``, processes that could be fused
    stay separate, so each can be reported.

    The last result is cached as long as its network lives, because the package and its memory report both need it.
    """
    for known, same, lowered in _last_lowered:
        if known() is network and same == (level, observed):
            return lowered
    lowered = _lowered(network, level, observed)
    _last_lowered[:] = [(ref(network, lambda _: _last_lowered.clear()), (level, observed), lowered)]
    return lowered


_last_lowered: list[tuple[ref[CoreNetwork], tuple[int, bool], Network]] = []


def _lowered(network: CoreNetwork, level: int, observed: bool) -> Network:
    if level == 0:
        return lower_for_targets(network)
    return optimize(network, [entry for entry in PASSES_FOR_LOOPS if not (observed and entry.name == "fuse")])


@record
class Package:
    """The files of a usual package, by path from its folder; ``by_hand`` are those of processes and laws in C."""

    files: dict[str, str]
    by_hand: Collection[str]
    project: CProject
    library: Library
    interface: Interface

    @property
    def network(self) -> Network:
        """The network, as it was lowered for the target."""
        return self.interface.network

    @property
    def names(self) -> PackageNames:
        """The names that all files share."""
        return self.interface.names

    @property
    def types(self) -> CTypes:
        """The types of C."""
        return self.interface.types

    @property
    def compiled(self) -> set[str]:
        """The sources of the program and the kernel, and what is written by hand."""
        return {*self.by_hand, *self.project.program, *self.project.kernel}


def generate(network: CoreNetwork, modules: Mapping[str, str], options: Options) -> dict[str, str]:
    """The files of a package, by path from its folder.

    ``modules`` are the texts of bodies in C, by the paths that ``external_modules`` returns. Raises TargetError for a
    program with parts in another language, TemplateError for a mistake in a template that the user has replaced.
    """
    package = described(network, modules, options)
    if options.framework:
        render = renderer("c", options.templates)
        return arranged(options.framework, package.files, package.library, package.compiled, render)
    return dict(sorted(package.files.items()))


def described(network: CoreNetwork, modules: Mapping[str, str], options: Options) -> Package:
    """The usual package, with what others make of it; see ``generate``."""
    render = renderer("c", options.templates)
    refuse(network, modules)
    simulated = tuple(entry for entry in network.environments if not foreign_devices(entry))
    lowered = separate_depths(lowered_for_c(network, options.level, observed=options.observed))
    names = PackageNames(lowered)
    files: dict[str, str] = {}
    types = CTypes(names)
    rows: list[str] = []
    for class_ in lowered.classes:
        law = {} if isinstance(class_, ProcessClass) else law_files(class_, names, types)
        if law or (isinstance(class_, ProcessClass) and class_.external is None):
            kind = "process" if isinstance(class_, ProcessClass) else "control law"
            rows.append(f"`{names.classes[class_.name]}.c` | the {kind} `{class_.definition}`")
        files.update(law)
    support = support_files()
    definitions = tuple(definitions_in_c(lowered, simulated)) if modules else ()
    refuse_taken_names(definitions, lowered, names, modules, support)
    devices = device_files(simulated, modules)
    by_hand = {**external_files(network, modules), **devices}
    by_hand_layout = Layout({path: text for path, text in by_hand.items() if path.endswith(".h")}, {})
    for class_ in lowered.classes:
        if isinstance(class_, ProcessClass) and class_.external is not None:
            require_first_member(class_, by_hand_layout, names)
    refuse_missing_members(lowered, simulated, by_hand_layout, names, types)
    files.update(headers_of_definitions(definitions, by_hand))
    files.update(by_hand)
    files.update(checks_file(lowered, names, types))
    files.update(network_files(lowered, names, types))
    program = [path for path in files if path.endswith(".c") and path not in devices]
    environments = [entry for entry in lowered.environments if entry.name in {item.name for item in simulated}]
    can_simulate = not options.framework and (bool(environments) or not network.external_ports)
    if can_simulate:
        for environment in environments:
            files.update(environment_files(environment, lowered, names, types))
            files.update(fmu_files(environment, types))
            rows.append(f"`{names.environments[environment.name]}.c` | the environment `{environment.name}`")
        main = Simulation(
            network.top, [_scenario(entry, names) for entry in environments], parameters=bool(network.parameters)
        )
        files["main_simulation.c"] = render("main_simulation.c.j2", main=main)
    files["constants.h"] = constants_header(lowered, names, types)
    files[f"{names.prefix}_types.h"] = plain_types_header(lowered, names.prefix, types)
    program_text = "\n".join(text for path, text in files.items() if path.endswith((".c", ".h")))
    files["types.h"] = types_header(lowered, names, types, f"{names.prefix}_types.h", program_text)
    fixed = (*by_hand, f"{names.prefix}_types.h")
    files = Includes(files, support, _headers(files, support, names), fixed).reduced()
    texts = {**support, **files}
    headers = {path: text for path, text in texts.items() if path.endswith(".h")}
    identifying = {path: text for path, text in texts.items() if path != "main_simulation.c"}
    interface = Interface(lowered, names, types, inlined=options.level > 0)
    owners = frozenset(item.struct for item in definitions)
    refuse_colliding_macros(texts, by_hand, owners)
    step_files = interface_files(interface, identifying, headers, render)
    refuse_colliding_macros({**texts, **step_files}, by_hand, owners)
    files.update(step_files)
    program += [path for path in step_files if path.endswith(".c")]
    program.sort(key=lambda path: (path != TYPES_BY_HAND, path))  # Its reasons come before those of a compiler.
    kernel = sorted(
        path for path in support if path.endswith(".c") and path not in _SIMULATION and not path.startswith("csp_port_")
    )
    source = network.source.rpartition("/")[2]
    description = sentence(
        network.class_named(network.top).doc
        or network.doc
        or f"The process {network.top}, generated from its CSP diagram."
    )
    project = CProject(
        package=names.prefix,
        top=network.top,
        source=one_line(source),
        source_code=markdown_code(source),
        framework=options.framework,
        doc=markdown(description),
        ports=[port_row(port) for port in network.external_ports],
        environments=[entry.name for entry in environments],
        parameters=bool(network.parameters),
        files=rows,
        program=program,
        kernel=[f"{SUPPORT}/{path}" for path in kernel],
        simulation=_simulation(files, program),
        simulated=can_simulate,
    )
    for path in ("Makefile", "CMakeLists.txt"):
        files[path] = folded_script(render(f"{path}.j2", project=project))
    files["README.md"] = render("README.md.j2", project=project)
    for path, text in by_hand.items():
        if files[path] is not text:
            raise TargetError(f"{path}, written by hand, has the name of a generated file\n  help: rename it")
    sources = [text for path, text in files.items() if path.endswith(".c")]
    program = [text for path, text in files.items() if path.endswith((".c", ".h"))]
    for path in files.keys() - by_hand.keys():
        template = _FILE_TEMPLATES.get(path[-2:])
        if template is not None:
            file = CFile(path, files[path].removesuffix("\n"), network.top, in_comment(source))
            files[path] = folded(render(template, file=file))
    kernel_headers = [text for path, text in support.items() if path.endswith(".h") and path != _OF_BOARD]
    files[NAMES] = names_header(project.package, sources, kernel_headers)
    files.update({f"{SUPPORT}/{path}": text for path, text in support.items() if path != _CONFIGURATION})
    files[PARTS] = parts_header(files[PARTS], program)
    files.update({path: first_included(path, text) for path, text in by_hand.items() if path.endswith(".c")})
    own = by_hand.keys() - devices.keys()
    library = Library(project.package, project.top, project.source, one_line(description), by_hand=tuple(sorted(own)))
    return Package(files, own, project, library, interface)


def _simulation(files: Mapping[str, str], program: list[str]) -> list[str]:
    own = [path for path in sorted(files) if path.endswith(".c") and path not in program]
    return [*own, *(f"{SUPPORT}/{path}" for path in _SIMULATION)]


def _scenario(environment: Environment, names: PackageNames) -> Scenario:
    counts = "true" if environment.on_miss == "count" else "false"
    return Scenario(names.environments[environment.name], environment.name, counts)


def _headers(files: Mapping[str, str], support: Mapping[str, str], names: PackageNames) -> Mapping[str, frozenset[str]]:
    """What the headers define of which not every file of a program needs each."""
    of_types = defined_in(files["types.h"]) | defined_in(files[f"{names.prefix}_types.h"])
    return {
        "csp_core.h": defined_in(support["csp_core.h"]),
        "csp_arithmetic.h": defined_in(support["csp_arithmetic.h"]) | defined_in(support["csp_single.h"]),
        "types.h": of_types.union(names.exceptions.values(), *names.literals.values()),
        "constants.h": frozenset(names.constants.values()),
    }


def support_files() -> dict[str, str]:
    """The files of the kernel, by path from its folder."""
    folder = template_folder("c") / SUPPORT
    return {
        path.name: path.read_text(encoding="utf-8")
        for path in sorted(folder.iterdir())
        if path.suffix in (".awk", ".c", ".h", ".ld")
    }
