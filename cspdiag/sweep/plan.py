"""A sweep before it runs: which programs have to be built, and which runs each of them makes."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from hashlib import sha256
from typing import TYPE_CHECKING

from cspdiag import pipeline
from cspdiag.base import Report
from cspdiag.base.errors import CspdiagError
from cspdiag.base.record import record
from cspdiag.base.span import SourceFile
from cspdiag.network.checks.endless import never_ends
from cspdiag.network.lower.promoted import can_be_promoted, promoted
from cspdiag.pipeline import Checked, Reader
from cspdiag.settings import Overrides, SettingError, parse_settings
from cspdiag.simulate.run.execute import chosen_environment
from cspdiag.sweep.axes import Axis, AxisValue, Grid, grid_of
from cspdiag.sweep.measures import Measures, parse_measures
from cspdiag.sweep.programs import Identity, Programs, identity_of, programs_of
from cspdiag.syntax import ast

if TYPE_CHECKING:
    from cspdiag.base.diagnostic import Diagnostic
    from cspdiag.model.program import Program
    from cspdiag.model.types import Real
    from cspdiag.network.ir.network import CoreNetwork, Environment
    from cspdiag.network.lower.setting_paths import Root


class InvalidProgramError(CspdiagError):
    """The program has errors, which are its ``diagnostics``."""

    def __init__(self, diagnostics: Sequence[Diagnostic]) -> None:
        super().__init__("the program has errors")
        self.diagnostics = diagnostics


@record(kw_only=True)
class Request:
    """What is wanted: the program, the values by name, the measures, and for how long each run lasts at most."""

    source: SourceFile
    given: Mapping[str, str | Sequence[str]]
    measures: Sequence[str]
    environment: str | None
    until: int | None
    """Nanoseconds."""
    real: Real = "double"


@record
class NetworkMaker:
    """Makes networks of a program without errors, with different settings; its text is read once."""

    checked: Checked
    roots: Sequence[Root]
    environment: str | None

    def network(self, settings: Mapping[str, str]) -> tuple[CoreNetwork | None, Sequence[Diagnostic]]:
        """The network, None if the settings give it errors, and the diagnostics. Raises SettingError."""
        checked, network = self._made(self._overrides(settings))
        return network, checked.report.diagnostics

    def environments(
        self, compiled: Mapping[str, str], varied: Iterable[Mapping[str, str]]
    ) -> Iterator[Environment | None]:
        """The environment for each of the ``varied`` settings, which are parameters of it, together with the
        ``compiled`` ones; None if they give it errors. The program around it is made once. Raises SettingError.
        """
        whole: tuple[Program, CoreNetwork] | None = None
        for own in varied:
            overrides = self._overrides({**compiled, **own})
            if whole is not None:
                yield self._environment(*whole, overrides)
                continue
            checked, network = self._made(overrides)
            if network is None or checked.program is None:
                yield None
                continue
            whole = checked.program, network
            yield next(iter(network.environments), None)

    def _overrides(self, settings: Mapping[str, str]) -> Overrides:
        assert self.checked.program is not None
        return parse_settings(self.checked.program, settings, self.roots)

    def _made(self, overrides: Overrides) -> tuple[Checked, CoreNetwork | None]:
        checked = pipeline.changed(self.checked, overrides.constants, overrides.places)
        network = pipeline.compile_network(
            checked, environment=self.environment, overrides=overrides.parameters, alone=True
        )
        return checked, network

    def _environment(self, program: Program, network: CoreNetwork, overrides: Overrides) -> Environment | None:
        from cspdiag.network.lower.environments import lower_environment
        from cspdiag.network.lower.program import overrides_of_environment

        process, definition = self.roots[0], program.definitions[network.environments[0].name]
        assert isinstance(process, ast.ProcessDefinition)
        assert isinstance(definition, ast.EnvironmentDefinition)
        report = Report()
        values = overrides_of_environment(overrides.parameters, process, definition)
        made = lower_environment(program, definition, network.external_ports, values, report)
        return None if report.has_errors else made


@record
class Variant:
    """A program that is built once: the settings that it is compiled with. ``network`` is None if they give it errors,
    of which ``error`` is the first.
    """

    settings: Mapping[str, str]
    network: CoreNetwork | None
    error: str = ""

    @property
    def environment(self) -> Environment | None:
        """The environment of its runs."""
        return None if self.network is None else next(iter(self.network.environments), None)


@record
class Plan:
    """A sweep whose program, names and values are right.

    ``compiled`` are the positions of axes whose values are compiled into programs; the others are parameters of a
    program, for each by the name of the parameter and the positions of the part of it. ``programs`` says which program
    a run needs.
    """

    request: Request
    texts: Mapping[str, str]
    """The files of the program."""
    identity: Identity
    maker: NetworkMaker
    warnings: Sequence[Diagnostic]
    grid: Grid
    measures: Measures
    compiled: tuple[int, ...]
    tunable: Mapping[int, tuple[str, tuple[int, ...]]]
    programs: Programs
    first: CoreNetwork
    """The network of the first run."""

    @property
    def variants(self) -> int:
        """The number of programs to be built."""
        return len(self.programs.settings)

    def variant_of(self, run: int) -> int:
        """The number of the program that makes a run."""
        return self.programs.number(self.grid.positions(run))

    def variant(self, number: int) -> Variant:
        """A program, by its number."""
        settings = self.programs.settings[number]
        try:
            network, found = self.maker.network(settings)
        except SettingError as problem:
            return Variant(settings, None, str(problem))
        if network is None:
            return Variant(settings, None, first_error(found))
        return Variant(settings, promoted(network, _environment(network), self._promoted))

    @property
    def _promoted(self) -> list[str]:
        return [name for at, (name, _) in self.tunable.items() if self.grid.axes[at].target.roots]

    def refusal(self, run: int) -> str:
        """The first error that the values of a run give the program; empty if it is found only while it runs."""
        try:
            return first_error(self.maker.network(self.settings(run))[1])
        except SettingError as problem:
            return str(problem)

    def settings(self, run: int) -> dict[str, str]:
        """What a run sets, as for ``cspdiag run``."""
        return {axis.name: value.text for axis, value in self.grid.values(run)}

    @property
    def never_ends(self) -> bool:
        """Whether runs certainly continue forever, because no time limit is given."""
        return self.request.until is None and bool(self.first.environments) and never_ends(self.first)

    @property
    def compiled_names(self) -> list[str]:
        """The names whose values need a program each."""
        return [axis.name for at in self.compiled if len((axis := self.grid.axes[at]).values) > 1]

    @property
    def structural_names(self) -> list[str]:
        """The names of parameters of the environment with values that need a program of their own."""
        return [self.grid.axes[at].name for at in self.programs.structural]

    def parameter_values(self, run: int) -> Iterator[tuple[str, tuple[int, ...], AxisValue]]:
        """The parameters of its program that a run sets."""
        positions = self.grid.positions(run)
        for at, (name, part) in self.tunable.items():
            yield name, part, self.grid.axes[at].values[positions[at]]

    def token(self, version: str) -> str:
        """A text that another sweep does not have: it is made of what the program says, the values, the measures, and
        the version of cspdiag.
        """
        request = self.request
        axes = [(axis.name, *(value.text for value in axis.values)) for axis in self.grid.axes]
        whole = (
            *(version, self.identity, axes, self.measures.names),
            *(request.environment, request.until, request.real),
        )
        return sha256(repr(whole).encode()).hexdigest()[:32]


def maker_of(source: SourceFile, reader: Reader, environment: str | None, real: Real) -> tuple[NetworkMaker, Program]:
    """What makes networks of a program, and the program. Raises InvalidProgramError and ``SelectionError``."""
    from cspdiag.network.lower.program import selection

    checked = pipeline.check(source, reader, real=real)
    if checked.program is None or checked.analysis is None or checked.report.has_errors:
        raise InvalidProgramError(checked.report.diagnostics)
    process, environments = selection(checked.program, checked.analysis, None, environment, alone=True)
    return NetworkMaker(checked, [process, *environments], environment), checked.program


def first_error(diagnostics: Sequence[Diagnostic]) -> str:
    """The message of the first error."""
    return next((item.message for item in diagnostics if item.severity == "error"), "")


def plan_sweep(request: Request, reader: Reader, on_planned: Callable[[int, int], object] | None = None) -> Plan:
    """The plan of a sweep. ``on_planned`` is called while it is made, see ``programs_of``.

    Raises InvalidProgramError, SettingError, ``MeasureError``, NoEnvironmentError and ``SelectionError``.
    """
    texts: dict[str, str] = {}

    def remembering(path: str) -> SourceFile:
        source = reader(path)
        texts[path] = source.text
        return source

    maker, program = maker_of(request.source, remembering, request.environment, request.real)
    grid = grid_of(program, request.given, maker.roots)
    network, found = _first_network(maker, grid)
    environment = chosen_environment(network, request.environment)
    measures = parse_measures(request.measures, network, environment)
    tunable = _tunable(grid, network)
    compiled = tuple(at for at in range(len(grid.axes)) if at not in tunable)
    varied = tuple(at for at in tunable if not _is_tunable(grid.axes[at]))
    programs = programs_of(maker, grid, compiled, varied, on_planned)
    texts[request.source.name] = request.source.text
    identity = identity_of(program.trees)
    return Plan(request, texts, identity, maker, found, grid, measures, compiled, tunable, programs, network)


def _environment(network: CoreNetwork) -> Environment | None:
    return next(iter(network.environments), None)


def _first_network(maker: NetworkMaker, grid: Grid) -> tuple[CoreNetwork, Sequence[Diagnostic]]:
    """The network with the first values; with those of the text, if the first ones give it errors."""
    reported: Sequence[Diagnostic] = ()
    for settings in (_first_values(grid), {}):
        network, found = maker.network(settings)
        if network is not None:
            return network, found
        reported = reported or found
    raise InvalidProgramError(reported)


def _first_values(grid: Grid) -> dict[str, str]:
    """The first values of what is not a parameter of the program."""
    return {axis.name: axis.values[0].text for axis in grid.axes if not _is_tunable(axis)}


def _is_tunable(axis: Axis) -> bool:
    return isinstance(axis.target.item, ast.Constant) and axis.target.item.tunable


def _tunable(grid: Grid, network: CoreNetwork) -> dict[int, tuple[str, tuple[int, ...]]]:
    """By the position of the axis: the parameter of the program that takes its values, and the part of it."""
    environment = _environment(network)
    found: dict[int, tuple[str, tuple[int, ...]]] = {}
    for at, axis in enumerate(grid.axes):
        target = axis.target
        if _is_tunable(axis):
            found[at] = target.item.name.text, target.positions
        elif isinstance(target.item, ast.Parameter) and can_be_promoted(environment, target.path):
            found[at] = target.path, ()
    return found
