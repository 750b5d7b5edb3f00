"""The whole compiler on one page: parse → imports → resolve → check → network check → lower → generate.

Every step is a pure function of its own layer, reports what it finds and continues. Layers are imported when they are
reached, so that ``cspdiag check`` starts without the generator and what it needs.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

from cspdiag.base.record import EMPTY, node, replaced
from cspdiag.base.report import Report
from cspdiag.base.span import SourceFile
from cspdiag.syntax.parse.nesting import raised_recursion_limit

if TYPE_CHECKING:
    from cspdiag.base.diagnostic import Label
    from cspdiag.codegen.shared.render import Replacement
    from cspdiag.model.program import Program, Value
    from cspdiag.model.remembered import Checks
    from cspdiag.model.types import Real
    from cspdiag.network.analyse import Analysis
    from cspdiag.network.elaborate.fewer.varying import Varying
    from cspdiag.network.infer.contexts import Surroundings
    from cspdiag.network.ir.network import CoreNetwork
    from cspdiag.network.lower.setting_paths import Root
    from cspdiag.settings import Overrides
    from cspdiag.syntax.ast import SourceTree

LEAST_TO_CONTINUE = 1_500
"""The size of arrays from which on code is made from fewer elements: to compile two small networks takes as long as the
rows of some 1,000 cells.
"""

Reader = Callable[[str], SourceFile]
"""Reads an imported file; raises OSError if it cannot."""


@node
class Checked:
    """A program after all checks; ``program`` is None if it could not be understood as a whole.

    ``readable`` has the definitions that could be read, if any: enough for a picture, not always for code.
    """

    program: Program | None
    report: Report
    readable: Program | None = None
    analysis: Analysis | None = None
    """Results of the checks that lowering needs too."""
    network: CoreNetwork | None = None
    """The network of the outermost process with all its environments, if an analysis has needed it."""
    real: Real = "double"
    """What ``double`` means in the program; environments always compute in double precision."""
    fewer: Fewer | None = None
    """The same with fewer elements, if that was enough to know that nothing is wrong; then there is no ``analysis``."""


@node
class Fewer:
    """A program in which nothing is wrong with fewer elements, and so nothing with all of them: what varies between the
    two.
    """

    checked: Checked
    varying: Varying


@node
class Built:
    """A program about to be compiled, with its settings as values; ``network`` is None if errors, in
    ``checked.report``, prevent it.
    """

    checked: Checked
    network: CoreNetwork | None
    overrides: Overrides


@raised_recursion_limit()
def check(
    main: SourceFile,
    read: Reader,
    overrides: Mapping[str, Value] | None = None,
    *,
    parse: Callable[[SourceFile, Report], SourceTree] | None = None,
    checks: Checks | None = None,
    for_findings: bool = False,
    least: int = 0,
    real: Real = "double",
) -> Checked:
    """Find all errors in a program and the files it imports.

    ``overrides`` replaces the values of constants by name; ``parse`` gives the trees of files, and ``checks`` makes the
    checks of definitions, if they are to be remembered. ``for_findings``: only the diagnostics are wanted; a program of
    many elements, of which fewer are enough to know that there are none, then has no ``analysis`` (``least``: the least
    size that is many). ``real`` is what ``double`` means in the program. No program makes it raise an exception.
    """
    from cspdiag.model.checks.rules import check as check_model
    from cspdiag.model.diagnostics.imports import ImportFailure
    from cspdiag.model.names.described import with_described_ports
    from cspdiag.model.names.imports import load
    from cspdiag.model.names.resolve import resolve
    from cspdiag.syntax.on_demand import parsed
    from cspdiag.syntax.parse.soundness import part_without_errors

    report = Report()
    trees = with_described_ports(load(main, read, report, parse or parsed))
    if not trees:
        return Checked(program=None, report=report, real=real)
    broken = [found for found in report.diagnostics if not isinstance(found, ImportFailure)]
    if broken:
        # Definitions are missing, so the network cannot be judged, but those that were read whole can.
        trees = [part_without_errors(tree, broken) for tree in trees]
        readable = resolve(trees, overrides or {}, report)
        check_model(readable, report)
        return Checked(program=None, report=report, readable=readable, real=real)
    return _checked(trees, overrides or {}, report, for_findings=for_findings, least=least, real=real, checks=checks)


@raised_recursion_limit()
def changed(
    checked: Checked,
    constants: Mapping[str, Value],
    suspects: tuple[Label, ...] = (),
    *,
    trees: Sequence[SourceTree] | None = None,
    for_findings: bool = False,
    least: int = 0,
) -> Checked:
    """A program without errors, checked with other values of its constants; its text is not read again.

    Errors show the ``suspects``. ``trees`` take the places of those of its files. The others are as for ``check``.
    """
    assert checked.program is not None
    report = Report()
    report.suspects = suspects
    trees = trees or checked.program.trees
    return _checked(trees, constants, report, for_findings=for_findings, least=least, real=checked.real)


def _checked(
    trees: Sequence[SourceTree],
    overrides: Mapping[str, Value],
    report: Report,
    *,
    for_findings: bool = False,
    least: int = 0,
    real: Real,
    checks: Checks | None = None,
) -> Checked:
    from cspdiag.model.checks.rules import check as check_model
    from cspdiag.model.names.resolve import resolve
    from cspdiag.model.remembered import ALWAYS
    from cspdiag.network.check import check as check_network

    checks = checks or ALWAYS
    program = resolve(trees, overrides, report)
    checks.begin(program, report)
    check_model(program, report, checks)
    if for_findings and real == "double" and not report.diagnostics:
        fewer = _clean_with_fewer(program, least)
        if fewer is not None:
            return Checked(program=program, report=report, readable=program, fewer=fewer)
    analysis = check_network(program, report, checks)
    checks.end()
    network = None
    if not report.has_errors:
        from cspdiag.analyses import analyse

        network = analyse(program, analysis, report)
    checked = Checked(program=program, report=report, readable=program, analysis=analysis, network=network, real=real)
    return checked if real == "double" else _with_rounded_network(checked)


def _with_rounded_network(checked: Checked) -> Checked:
    """The same with the network of the outermost process in the precision of the program, which finds numbers that it
    does not have.
    """
    from cspdiag.network.lower.program import SelectionError

    plain = replaced(checked, network=None)
    if checked.report.has_errors:
        return plain
    try:
        return replaced(checked, network=compile_network(plain))
    except SelectionError:
        return plain


def _clean_with_fewer(program: Program, least: int) -> Fewer | None:
    """A program of many elements with fewer of them, if these show that nothing is wrong with its processes."""
    from cspdiag.network.elaborate.fewer.sizes import fewer_elements

    sizes = fewer_elements(program, least)
    if not sizes:
        return None
    from cspdiag.network.elaborate.fewer.clean import clean_with_fewer

    found = clean_with_fewer(program, sizes)
    if found is None:
        return None
    few = Checked(program=found.program, report=Report(), readable=found.program, analysis=found.analysis)
    return Fewer(checked=few, varying=found.varying)


@raised_recursion_limit()
def compile_network(
    checked: Checked,
    *,
    top: str | None = None,
    environment: str | None = None,
    overrides: Mapping[str, Value] | None = None,
    surroundings: Surroundings = "environment",
    alone: bool = False,
) -> CoreNetwork | None:
    """Lower a program that has no errors to its network; None if that reports an error.

    ``top`` names the outermost process and ``environment`` the environment it is compiled for (defaults: those of the
    text); ``overrides`` replaces parameters of instances by path. ``surroundings`` gives what its ports are connected
    to. ``alone``: without other environments. Raises ``cspdiag.settings.SettingError`` for an override of an element
    that an array does not have.
    """
    from cspdiag.network.lower.program import lower
    from cspdiag.network.lower.setting_paths import NoSuchElementError
    from cspdiag.settings import SettingError

    if checked.program is None or checked.report.has_errors:
        return None
    if (
        checked.network is not None
        and (top, environment, surroundings) == (None, None, "environment")
        and not overrides
    ):
        return checked.network
    try:
        network = lower(
            checked.program,
            top,
            environment,
            overrides or {},
            checked.report,
            surroundings=surroundings,
            checked=checked.analysis,
            alone=alone,
        )
    except NoSuchElementError as problem:
        raise SettingError(str(problem.as_written(overrides or ()))) from None
    if network is not None and checked.real == "float32":
        from cspdiag.network.lower.precision.program import in_single_precision

        network = in_single_precision(network, checked.report)
    return None if checked.report.has_errors else network


def build(
    main: SourceFile,
    read: Reader,
    *,
    top: str | None = None,
    environment: str | None = None,
    settings: Mapping[str, str] | None = None,
    alone: bool = False,
    real: Real = "double",
    for_code: bool = False,
) -> Built:
    """Check a program and lower it, with settings such as ``{"Tsh": "10 ms", "pan.inertia": "2e-3"}``.

    ``alone``: for the chosen environment only, as for a run. ``real`` is what ``double`` means in the program.
    ``for_code``: the network is only for ``generate``; that of a program of many elements may then have fewer. Raises
    ``cspdiag.settings.SettingError`` for a setting that matches nothing in a program without errors, and
    ``cspdiag.network.lower.program.SelectionError`` if there is no such process or environment to compile.
    """
    from cspdiag.network.lower.program import selection

    def roots(program: Program, analysis: Analysis) -> Sequence[Root]:
        process, environments = selection(program, analysis, top, environment, alone=alone)
        return process, *environments

    def lowered(checked: Checked) -> CoreNetwork | None:
        return compile_network(checked, top=top, environment=environment, overrides=overrides.parameters, alone=alone)

    checked, overrides = check_with(main, read, settings, roots, real, for_findings=for_code, least=LEAST_TO_CONTINUE)
    network = None if checked.fewer is None else _of_fewer_elements(checked, checked.fewer, lowered)
    if network is None:
        checked = _of_all_elements(checked)
        network = lowered(checked)
    return Built(checked=checked, network=network, overrides=overrides)


def _of_all_elements(checked: Checked) -> Checked:
    if checked.fewer is None:
        return checked
    assert checked.program is not None
    return changed(checked, checked.program.overrides)


def _of_fewer_elements(
    checked: Checked, fewer: Fewer, lowered: Callable[[Checked], CoreNetwork | None]
) -> CoreNetwork | None:
    """A network with fewer elements from which that of a program follows; None if there is none."""
    from cspdiag.network.elaborate.fewer.extrapolation import Extrapolation
    from cspdiag.network.elaborate.fewer.regular import is_regular
    from cspdiag.network.elaborate.fewer.sizes import three_sizes
    from cspdiag.network.ir.network import FewerElements

    program, few = checked.program, fewer.checked.program
    assert program is not None
    assert few is not None
    sizes = three_sizes(program)
    if sizes is None:
        return None
    name, numbers = sizes
    more = changed(checked, {**program.overrides, name: numbers[1]})
    assert more.program is not None
    follows = Extrapolation(*numbers)
    if more.report.diagnostics or not is_regular(few, more.program, program, fewer.varying, follows):
        return None
    one, other = lowered(fewer.checked), lowered(more)
    if one is None or other is None or one.external_ports != other.external_ports:
        return None

    all_ = FewerElements(network=one, sizes=numbers, whole=lambda: lowered(_of_all_elements(checked)))
    return replaced(other, fewer=all_)


def check_with(
    main: SourceFile,
    read: Reader,
    settings: Mapping[str, str] | None,
    roots: Callable[[Program, Analysis], Sequence[Root]],
    real: Real,
    *,
    for_findings: bool = False,
    least: int = 0,
) -> tuple[Checked, Overrides]:
    """The checked program with constants set, and the settings as values; ``roots`` finds what is to be compiled.
    ``for_findings`` and ``least`` as for ``check``, if no parameter of an instance is set.
    """
    from cspdiag.settings import NO_OVERRIDES, parse_settings

    checked = check(main, read, real=real, for_findings=for_findings, least=least)
    analysis = checked.analysis if checked.fewer is None else checked.fewer.checked.analysis
    if checked.program is None or analysis is None or checked.report.has_errors or not settings:
        return checked, NO_OVERRIDES
    overrides = parse_settings(checked.program, settings, roots(checked.program, analysis))
    if overrides.constants or checked.fewer is not None:
        for_findings = for_findings and not overrides.parameters
        again = changed(checked, overrides.constants, overrides.places, for_findings=for_findings, least=least)
        return again, overrides
    checked.report.suspects = overrides.places
    return checked, overrides


@raised_recursion_limit()
def generate(
    network: CoreNetwork,
    read: Reader,
    target: str = "python",
    level: int = 0,
    *,
    traced: bool = False,
    observed: bool = False,
    probed: bool = False,
    templates: Mapping[str, Replacement] = EMPTY,
    framework: str = "",
    fmi: str = "2.0",
    plant: str = "",
) -> dict[str, str]:
    """The files of a target's package, by path relative to its folder.

    ``level`` is that of optimization, 0 or 1; at level 0 code reports and keeps everything. ``traced`` code reports to
    an observer every communication, other code those of external ports only; ``observed`` code also reports when each
    process starts and ends, and who communicates; ``probed`` code keeps variables that have a unit as objects that can
    be watched. Hand-written modules that the program names are read relative to the file that names them. ``templates``
    replace those of the target, by name; a ``framework`` makes a package in C a library for it. ``fmi`` is the version
    of an FMU, and ``plant`` the environment that it is made of, instead of the program. Raises KeyError for an unknown
    target, OSError for a module that cannot be read, TargetError for a program that the target cannot express
    and for a mistake in one of the templates.
    """
    from cspdiag.codegen import TARGETS, external_modules
    from cspdiag.codegen.options import Options

    modules = external_modules(network, read, target)
    options = Options(
        level=level,
        traced=traced,
        observed=observed,
        probed=probed,
        templates=templates,
        framework=framework,
        fmi=fmi,
        plant=plant,
    )
    return TARGETS[target](network, modules, options)
