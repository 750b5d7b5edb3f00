"""What is in an FMU before it is compiled: its description, and the sources."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from uuid import NAMESPACE_URL, uuid5

from cspdiag.base.files.resources import template_folder
from cspdiag.base.record import record, replaced
from cspdiag.codegen.c.network.environments import EnvironmentFiles
from cspdiag.codegen.c.package.includes import with_headers
from cspdiag.codegen.c.package.layouts import CONTRACTION_OFF, OWNERS, SUPPORT
from cspdiag.codegen.c.package.package import Package, described
from cspdiag.codegen.c.text.names import snake_case
from cspdiag.codegen.fmi.description import Model, build_description, model_description
from cspdiag.codegen.fmi.variables import Clock, Variable, c_type, scalars
from cspdiag.codegen.options import Options
from cspdiag.codegen.shared.laws.equations import constants_needed
from cspdiag.codegen.shared.render import renderer
from cspdiag.codegen.shared.target_error import TargetError
from cspdiag.model.sampling import Sampling
from cspdiag.model.types import ArrayType, EnumType, IntType, StructType
from cspdiag.network.ir.expressions import TunableValue
from cspdiag.network.ir.external import fmu_calls
from cspdiag.network.ir.network import CoreNetwork, Environment, ExternalPort, ProgramParameter
from cspdiag.network.ir.walk import parts
from cspdiag.network.ir.zero import zero

SOURCES = "sources/"
"""The folder of the sources in an FMU."""
_OWN = ("fmu.c", "fmu.h", "fmu_values.c", "fmi_common.h")
"""What all FMUs have in common."""


@record
class _EventPort:
    member: str
    type: str
    literal: str
    differs: str


@record(kw_only=True)
class ProgramModel:
    """What the template of a program is given; ``rows`` are those of the table of variables, ``starts`` statements."""

    name: str
    top: str
    token: str
    inputs: bool
    outputs: bool
    events: list[_EventPort]
    written: list[_EventPort]
    rows: list[str]
    starts: list[str]
    grid: int
    parameters: bool


@record(kw_only=True)
class PlantModel:
    """What the template of an environment is given; ``name`` is that of its struct."""

    name: str
    environment: str
    top: str
    token: str
    rows: list[str]
    ticks: list[Sampling]
    parameters: str
    """The struct of the parameters of the program that the environment uses; empty if it uses none."""


def identifier(network: CoreNetwork, plant: str = "") -> str:
    """The name of the FMU's file, and of its binary."""
    from cspdiag.codegen.c.text.names import PackageNames
    from cspdiag.optimize import lower_for_targets

    prefix = PackageNames(lower_for_targets(network)).prefix
    return f"{prefix}_{snake_case(plant)}" if plant else prefix


def generate(network: CoreNetwork, modules: Mapping[str, str], options: Options) -> dict[str, str]:
    """The files of an FMU without its binary, by path: ``modelDescription.xml`` and the folder ``sources``.

    Raises TargetError for what C cannot express: bodies or devices in other languages.
    """
    package = described(network, modules, Options(level=options.level))
    return _plant(package, options) if options.plant else _program(package, options)


def _program(package: Package, options: Options) -> dict[str, str]:
    interface = package.interface
    writer = _Program(package, options.fmi)
    compiled = sorted(path for path in package.compiled if not path.endswith(OWNERS))
    sources = _sources(package, compiled)
    token = _token([*sources.values(), options.fmi])
    grid = next((entry.step for entry in package.network.environments), 0)
    model = ProgramModel(
        name=interface.prefix,
        top=package.project.top,
        token=token,
        inputs=bool(interface.inputs),
        outputs=bool(interface.outputs),
        events=[writer.event(port) for port in interface.events],
        written=[writer.written(port) for port in writer.event_outputs],
        rows=_table(writer.variables),
        starts=writer.starts,
        grid=grid,
        parameters=bool(package.network.parameters),
    )
    periods = [port.sampling.period for port in interface.inputs if port.sampling is not None]
    step = min([*periods, *([grid] if grid else [])], default=1_000_000)
    generated = {"fmu_model.c": renderer("fmu", options.templates)("fmu_program.c.j2", model=model)}
    about = Model(
        name=package.project.top,
        identifier=interface.prefix,
        token=token,
        description=package.library.description,
        variables=writer.variables,
        sources=(),
        step=step,
        stops=True,
    )
    return _files(sources | generated, about, options.fmi)


def _plant(package: Package, options: Options) -> dict[str, str]:
    environment = next(entry for entry in package.network.environments if entry.name == options.plant)
    for driver in environment.drivers:
        raise TargetError(
            f"{driver.span}: the environment has the device `{driver.definition}`, which an FMU cannot open\n"
            "  help: choose an environment of submodels"
        )
    for item in fmu_calls(environment):
        raise TargetError(
            f"{item.external.span}: the environment has an FMU, which cannot be in another FMU\n"
            "  help: use both in your simulator"
        )
    writer = EnvironmentFiles(environment, package.network, package.names, package.types)
    # Parameters are parts of the program; without them a plant needs nothing but the kernel.
    inside = sorted(package.compiled) if writer.uses_parameters else package.project.kernel
    kernel = [path for path in inside if not path.endswith(OWNERS)]
    own = [f"{writer.name}.c", f"{SUPPORT}/csp_linear.c", *kernel]
    sources = _sources(package, [*own, *(path for path in package.by_hand if path.endswith(".c"))])
    token = _token([*sources.values(), options.fmi])
    variables = list(_plant_variables(package, environment, writer))
    if writer.uses_parameters:
        used = _used_parameters(package, options.plant)
        variables += parameter_variables(package, used, "parameters")
    samplings = [port.sampling for port in package.network.external_ports if port.sampling is not None]
    ticks = list(dict.fromkeys([Sampling(environment.step), *samplings]))
    model = PlantModel(
        name=writer.name,
        environment=environment.name,
        top=package.project.top,
        token=token,
        rows=_table(variables),
        ticks=ticks,
        parameters=f"{package.names.prefix}_parameters" if writer.uses_parameters else "",
    )
    generated = {"fmu_model.c": renderer("fmu", options.templates)("fmu_plant.c.j2", model=model)}
    about = Model(
        name=f"{package.project.top}.{environment.name}",
        identifier=f"{package.names.prefix}_{snake_case(environment.name)}",
        token=token,
        description=environment.doc or f"The environment {environment.name} of {package.project.top}.",
        variables=variables,
        sources=(),
        step=environment.step,
        stops=False,
    )
    return _files(sources | generated, about, options.fmi)


def _sources(package: Package, compiled: Sequence[str]) -> dict[str, str]:
    """These sources with their headers, in one folder."""
    kept = with_headers(compiled, package.files, ("", SUPPORT))
    return {
        path.removeprefix(f"{SUPPORT}/"): (CONTRACTION_OFF if path.endswith(".c") else "") + package.files[path]
        for path in kept
    }


def _files(sources: Mapping[str, str], model: Model, fmi: str) -> dict[str, str]:
    folder = template_folder("fmu")
    interface = "fmi2.c" if fmi == "2.0" else "fmi3.c"
    own = {name: (folder / name).read_text(encoding="utf-8") for name in (*_OWN, interface)}
    files = {f"{SOURCES}{path}": text for path, text in sorted({**sources, **own}.items())}
    names = tuple(path.removeprefix(SOURCES) for path in files if path.endswith(".c"))
    whole = replaced(model, sources=names)
    files["modelDescription.xml"] = model_description(whole, fmi)
    if fmi == "3.0":
        files[f"{SOURCES}buildDescription.xml"] = build_description(whole)
    return files


def _token(texts: Sequence[str]) -> str:
    return f"{{{uuid5(NAMESPACE_URL, chr(0).join(texts))}}}"


def _table(variables: Sequence[Variable]) -> list[str]:
    rows = []
    for variable in variables:
        literals = len(variable.type.literals) if isinstance(variable.type, EnumType) else 0
        place = f"offsetof(struct fmu_model, {variable.place})"
        use = "FMU_FIXED" if variable.is_fixed else f"FMU_{variable.causality.upper()}"
        rows.append(f'{{"{variable.name}", {use}, {c_type(variable.type)}, {place}, {literals}}}')
    return rows


class _Program:
    """The variables of a program, whose values are the members of the struct in the template."""

    def __init__(self, package: Package, fmi: str) -> None:
        self._package = package
        self._interface = interface = package.interface
        self._has_clocks = fmi != "2.0"
        self.event_outputs = [port for port in interface.outputs if port.medium == "direct" and port.sampling is None]
        self.variables = [variable for port in package.network.external_ports for variable in self._of(port)]
        self.variables += parameter_variables(package, self._parameters(), "values.parameters")

    def _parameters(self) -> list[ProgramParameter]:
        """The parameters of the text, and those fixed ones that processes use."""
        network = self._package.network
        used = _with_origins(network.parameters, {parameter for _, parameter in network.tunable})
        return [item for item in network.parameters if item.name in used or not item.fixed]

    def _of(self, port: ExternalPort) -> Iterator[Variable]:
        member = self._interface.members[port.key]
        is_event = port.medium == "event"
        place = f"values.{port.direction}puts.{self._interface.places[port.key]}"
        if is_event:
            place = f"values.{member}_event.value"
        causality = "input" if port.direction == "in" else "output"
        start = zero(port.type) if port.direction == "out" or port.default is None else port.default
        about = port.doc or ""
        for name, at, kind, value in scalars(port.key, place, port.type, start, self._package.types):
            yield Variable(
                name=name,
                causality="input" if causality == "input" else "output",
                type=kind,
                place=at,
                start=value,
                description=about,
                is_delayed=port.medium == "latched",
            )
        if is_event or port in self.event_outputs:
            word = "clock" if self._has_clocks else "count"
            yield Variable(
                name=f"{port.key}.{word}",
                causality="input" if causality == "input" else "output",
                type=Clock() if self._has_clocks else IntType(32),
                place=f"values.{member}_event.{word}",
                start=0,
                description=f"{'Active' if self._has_clocks else 'Changes'} with each event of {port.key}",
            )

    def event(self, port: ExternalPort) -> _EventPort:
        """An event input, for the template."""
        member = f"{self._interface.members[port.key]}_event"
        value, last = f"self->values.{member}.value", f"self->values.{member}.last"
        differs = f"({value} != {last})"
        if isinstance(port.type, StructType | ArrayType):
            differs = f"(memcmp(&{value}, &{last}, sizeof {last}) != 0)"
        return _EventPort(member, self._package.types.type_name(port.type), self._interface.literals[port.key], differs)

    def written(self, port: ExternalPort) -> _EventPort:
        """An event output, for the template."""
        return _EventPort(f"{self._interface.members[port.key]}_event", "", self._interface.literals[port.key], "")

    @property
    def starts(self) -> list[str]:
        """The statements that give inputs their values at the start, where those are not zero."""
        types = self._package.types
        rows = []
        for variable in self.variables:
            if variable.causality == "input" and not isinstance(variable.type, Clock) and variable.start:
                rows.append(f"self->{variable.place} = {types.literal(variable.start, variable.type)};")
        return rows


def _used_parameters(package: Package, plant: str) -> list[ProgramParameter]:
    """The parameters of the program that an environment uses, or of which it uses what follows from them."""
    environment = next(entry for entry in package.network.environments if entry.name == plant)
    assert environment.system is not None
    needed = replaced(environment.system, constants=tuple(constants_needed(environment.system)))
    used = {part.name for part in parts(needed) if isinstance(part, TunableValue)}
    every = package.network.parameters
    return [item for item in every if item.name in _with_origins(every, used)]


def _with_origins(parameters: Sequence[ProgramParameter], used: Collection[str]) -> set[str]:
    """The names of parameters that are used, and of those that they follow from."""
    found = set(used)
    for item in reversed(parameters):
        if item.name in found and item.follows is not None:
            found.update(part.name for part in parts(item.follows) if isinstance(part, TunableValue))
    return found


def parameter_variables(package: Package, parameters: Iterable[ProgramParameter], place: str) -> Iterator[Variable]:
    """These parameters of the program; ``place`` is the struct with them in the model."""
    for item in parameters:
        if item.follows is not None:
            continue
        at = f"{place}.{package.types.field(item.name)}"
        for name, member, kind, value in scalars(item.name, at, item.type, item.value, package.types):
            yield Variable(
                name=name,
                causality="parameter",
                type=kind,
                place=member,
                start=value,
                description=item.doc or "",
                is_fixed=item.fixed,
            )


def _plant_variables(package: Package, environment: Environment, writer: EnvironmentFiles) -> Iterator[Variable]:
    """The outputs of the program are the inputs of the plant, and the other way round."""
    for port in package.network.external_ports:
        place = f"plant.{writer.member(port)}"
        for name, at, kind, value in scalars(port.key, place, port.type, zero(port.type), package.types):
            yield Variable(
                name=name,
                causality="input" if port.direction == "out" else "output",
                type=kind,
                place=at,
                start=value,
                description=port.doc or "",
            )
