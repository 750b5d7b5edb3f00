"""``cspdiag margins``: stability and margins of the loops through the plant, under the program's own timing."""

from __future__ import annotations

from argparse import ArgumentParser, ArgumentTypeError, Namespace
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from cspdiag.base.render.snippet import on_one_line, printable
from cspdiag.base.sources import read_source
from cspdiag.cli.support.failure import FINE, UNSUCCESSFUL, NoResultError, UsageError, require_package
from cspdiag.cli.support.files.written import file_path, require_file
from cspdiag.cli.support.numbers import add_real, add_settings, number
from cspdiag.cli.support.terminal import say, show_diagnostics, write_out

if TYPE_CHECKING:
    from cspdiag.analyses.margins.loops import AnalysedLoop, LoopReport
    from cspdiag.analyses.margins.open_loop import OpenLoop
    from cspdiag.analyses.margins.period import RequiredMargin, Variant
    from cspdiag.network.ir.network import CoreNetwork, Environment
    from cspdiag.pipeline import Built

EXAMPLE = (
    "cspdiag margins models/jiwy/jiwy.csp --loop servo\n"
    "cspdiag margins models/jiwy/jiwy.csp --set Tsh=10ms --set Tsv=10ms --plot bode.svg\n"
    "cspdiag margins models/jiwy/jiwy.csp --loop motionControl --largest-period 30deg"
)

_KINDS = (".svg", ".png", ".pdf")


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("file", metavar="FILE", help="a program; - reads standard input")
    parser.add_argument(
        "--environment", metavar="NAME", help="the environment whose plant closes the loops (default: the first)"
    )
    parser.add_argument("--loop", metavar="PART", help="only loops with this in their path")
    add_settings(parser)
    add_real(parser)
    parser.add_argument(
        "--at", action="append", default=[], metavar="NAME=VALUE", dest="point",
        help="a state of the plant at the operating point (pan.speed=0.5); may be repeated",
    )  # fmt: skip
    parser.add_argument(
        "--largest-period", metavar="MARGIN",
        help="the largest sample period that leaves 30deg, 6dB, a factor of gain, a delay of 5ms, or stable",
    )  # fmt: skip
    parser.add_argument("--plot", type=file_path, metavar="FILE", help="a Bode picture, as .svg, .png or .pdf")
    parser.add_argument("--format", choices=("text", "json"), default="text", help="output format (default: text)")


def run(arguments: Namespace) -> int:
    """Linearize, measure, report; exit code 0 if there are loops and all of them are known to be stable."""
    from cspdiag.analyses.margins.linear import NotLinearError
    from cspdiag.analyses.margins.period import parse_margin

    _check_plot(arguments.plot)
    try:
        margin = None if arguments.largest_period is None else parse_margin(arguments.largest_period)
    except ValueError as problem:
        raise UsageError(f"--largest-period: {problem}") from None
    built = _built(arguments)
    network = built.network
    if network is None:
        return UNSUCCESSFUL
    environment = _environment(network, arguments.environment)
    try:
        report = _analysed(arguments, network, environment)
    except NotLinearError as problem:
        place = (
            ""
            if problem.span is None
            else f"{on_one_line(problem.span.source.name)}:{problem.span.line}:{problem.span.column}: "
        )
        raise NoResultError(f"{place}{problem.reason}, so no loop through `{environment.name}` has margins") from None
    periods = {} if margin is None else _periods(arguments, built, network, report, margin)
    _write_plot(arguments.plot, report)
    _print_report(arguments, report, periods)
    is_known = bool(report.loops) and not report.refusals
    return FINE if is_known and all(loop.margins.is_stable for loop in report.loops) else UNSUCCESSFUL


def _check_plot(path: Path | None) -> None:
    """Refuse a picture that could not be made, before the work instead of after it."""
    if path is None:
        return
    require_file("--plot", path, _KINDS)
    require_package("--plot", "matplotlib", "plot")


def _built(arguments: Namespace) -> Built:
    from cspdiag import pipeline
    from cspdiag.network.lower.program import SelectionError
    from cspdiag.settings import SettingError

    try:
        built = pipeline.build(
            read_source(arguments.file),
            read_source,
            environment=arguments.environment,
            settings=_settings(arguments),
            alone=True,
            real=arguments.real,
        )
    except (SettingError, SelectionError) as problem:
        raise UsageError(str(problem)) from None
    show_diagnostics(built.checked.report.diagnostics, arguments.color)
    return built


def _settings(arguments: Namespace) -> dict[str, str]:
    from cspdiag.settings import split_settings

    return split_settings(arguments.settings)


def _environment(network: CoreNetwork, name: str | None) -> Environment:
    for environment in network.environments:
        if name is None or environment.name == name:
            return environment
    raise UsageError(f"`{network.top}` has no environment, and so no plant that would close its loops")


def _analysed(arguments: Namespace, network: CoreNetwork, environment: Environment) -> LoopReport:
    from cspdiag.analyses.margins.loops import analyse_loops

    point = _point(arguments, environment)
    report = analyse_loops(network, environment, point=point, only=arguments.loop)
    if arguments.loop is not None and not report.loops and not report.refusals:
        _refuse_loop(arguments.loop, analyse_loops(network, environment, point=point))
    return report


def _refuse_loop(part: str, report: LoopReport) -> None:
    """Raise UsageError for a part of a path that none of the loops has; ``report`` covers all of them."""
    from cspdiag.network.lower.program import suggestion

    laws = (refusal.law.partition(".")[2] for refusal in report.refusals)
    known = {*(loop.opened.cut.name for loop in report.loops), *laws}
    if known:
        raise UsageError(f"--loop {part}: no loop has this in its path{suggestion(part, known)}")


def _point(arguments: Namespace, environment: Environment) -> dict[str, float]:
    from cspdiag.settings import SettingError, split_setting

    states = () if environment.system is None else tuple(state.name for state in environment.system.states)
    point: dict[str, float] = {}
    for entry in arguments.point:
        try:
            name, text = split_setting(entry)
            value = number(text)
        except (SettingError, ArgumentTypeError):
            raise UsageError(
                f"--at {entry}: expected NAME=VALUE, the value a finite number in the unit of the state"
            ) from None
        if name not in states:
            raise UsageError(
                f"--at {entry}: `{environment.name}` has no state {name} (it has: {', '.join(states) or 'none'})"
            )
        if name in point:
            raise UsageError(f"--at: {name} is set twice: to {point[name]} and to {value}")
        point[name] = value
    return point


def _periods(
    arguments: Namespace, built: Built, network: CoreNetwork, report: LoopReport, margin: RequiredMargin
) -> dict[str, tuple[int | None, str]]:
    """For each loop whose period is a constant of the text, the largest one, with the name of the constant."""
    from cspdiag.analyses.margins.period import largest_period, period_constants

    search = _Search(arguments, built)
    found: dict[str, tuple[int | None, str]] = {}
    known: dict[tuple[object, ...], int | None] = {}
    for loop in report.loops:
        constants = period_constants(network, loop.opened)
        if not constants:
            raise UsageError(
                f"--largest-period: the period of `{loop.opened.cut.name}` is a literal number; make it a "
                "`const`, which can be changed"
            )
        # Loops that are equal now are equal at every period.
        key = (tuple(constants.items()), loop.margins)
        if key not in known:
            known[key] = largest_period(search.variants(loop), constants, margin)
        found[loop.opened.cut.name] = known[key], ", ".join(constants)
    return found


class _Search:
    """Builds the network for each period that is tried, once. The text is read only once."""

    def __init__(self, arguments: Namespace, built: Built) -> None:
        self.environment = arguments.environment
        self.checked = built.checked
        self.overrides = built.overrides
        self.networks: dict[tuple[tuple[str, int], ...], CoreNetwork | None] = {}

    def variants(self, loop: AnalysedLoop) -> Variant:
        """One loop with constants set."""
        from cspdiag.analyses.margins.linear import NotLinearError
        from cspdiag.analyses.margins.loops import reopen

        def variant(constants: Mapping[str, int]) -> OpenLoop | None:
            network = self._network(constants)
            if network is None:
                return None
            try:
                return reopen(network, _environment(network, self.environment), loop)
            except NotLinearError:
                return None

        return variant

    def _network(self, constants: Mapping[str, int]) -> CoreNetwork | None:
        from cspdiag import pipeline

        key = tuple(constants.items())
        if key not in self.networks:
            changed = pipeline.changed(self.checked, {**self.overrides.constants, **constants})
            self.networks[key] = pipeline.compile_network(
                changed, environment=self.environment, overrides=self.overrides.parameters, alone=True
            )
        return self.networks[key]


def _write_plot(path: Path | None, report: LoopReport) -> None:
    if path is None or not report.loops:
        return
    from cspdiag.analyses.margins.report.bode import bode
    from cspdiag.base.files.whole import write_whole

    write_whole(path, bode(report.loops, path.suffix.removeprefix(".")))


def _print_report(arguments: Namespace, report: LoopReport, periods: Mapping[str, tuple[int | None, str]]) -> None:
    if arguments.format == "json":
        from cspdiag.analyses.margins.report.render_json import render

        write_out(render(report, periods))
        return
    from cspdiag.analyses.margins.report.render_text import table

    write_out(printable(table(report, periods)))
    if arguments.plot is not None and report.loops:
        say(f"wrote {on_one_line(arguments.plot)}")
