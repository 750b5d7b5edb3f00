"""The files around the code of a package: project file, README, entry points."""

from __future__ import annotations

from cspdiag.base.record import record
from cspdiag.codegen.python.plain.docs import sentence
from cspdiag.codegen.python.plain.external import ExternalModules, devices_of, installed_modules
from cspdiag.codegen.python.text.literals import docstring
from cspdiag.codegen.python.text.names import PackageNames
from cspdiag.codegen.shared.package_text import markdown, markdown_code, toml_string
from cspdiag.codegen.shared.plain_text import one_line
from cspdiag.network.ir.network import ExternalPort, Network


@record
class PortRow:
    """A row of the table of ports."""

    name: str
    direction: str
    type: str
    timing: str
    doc: str


@record
class Project:
    """The values for the templates of these files."""

    package: str
    distribution: str
    top: str
    source: str
    """On one line, for comments."""
    source_code: str
    """The same as a code span of Markdown."""
    doc: str
    """In Markdown."""
    docstring: str
    description: str
    """A string of TOML."""
    ports: list[PortRow]
    environments: list[str]
    copied: bool
    installed: list[str]
    devices: bool
    requirements: list[tuple[str, tuple[str, ...]]]
    """What devices need: the name of an extra, and its requirements."""
    tunable: bool


def project_view(network: Network, names: PackageNames, modules: ExternalModules) -> Project:
    """The values for the package of a network."""
    top = network.class_named(network.top)
    doc = sentence(top.doc or network.doc or f"The process {network.top}, generated from its CSP diagram.")
    summary = doc.split("\n\n")[0]
    source = network.source.rpartition("/")[2]
    devices = devices_of(network)
    return Project(
        package=names.package,
        distribution=names.package.strip("_").replace("_", "-"),
        top=network.top,
        source=one_line(source),
        source_code=markdown_code(source),
        doc=markdown(doc),
        docstring="\n".join(docstring(summary, "")),
        description=toml_string(summary.replace("\n", " ")),
        ports=[port_row(port) for port in network.external_ports],
        environments=[entry.name for entry in network.environments],
        copied=bool(modules.copies(network)),
        installed=installed_modules(network, modules),
        devices=bool(devices),
        requirements=[(device.extra, device.requirements) for device in devices if device.requirements],
        tunable=bool(network.parameters),
    )


def port_row(port: ExternalPort) -> PortRow:
    """An external port for a README."""
    timing = "event" if port.sampling is None else port.sampling.every
    if port.immediate:
        timing += ", immediate"
    return PortRow(port.key, port.direction, str(port.type), timing, markdown(" ".join((port.doc or "").split())))
