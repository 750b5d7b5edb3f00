"""``cspdiag compile``: generate a controller package."""

from __future__ import annotations

import os
from argparse import SUPPRESS, ArgumentParser, Namespace
from typing import TYPE_CHECKING

from cspdiag.base.render.snippet import on_one_line, printable
from cspdiag.base.report import Report
from cspdiag.base.sources import STANDARD_INPUT, read_source
from cspdiag.cli.support.failure import FINE, UNSUCCESSFUL, NoResultError, UsageError
from cspdiag.cli.support.files.written import given_name, require_folder
from cspdiag.cli.support.numbers import add_real, add_settings
from cspdiag.cli.support.terminal import say, show_diagnostics, write_out
from cspdiag.codegen import TARGETS, target_errors
from cspdiag.codegen.options import FMI_VERSIONS, FRAMEWORKS
from cspdiag.pipeline import build, check, generate
from cspdiag.settings import SettingError, split_settings

if TYPE_CHECKING:
    from collections.abc import Mapping

    from cspdiag.codegen.shared.render import Replacement
    from cspdiag.network.ir.network import CoreNetwork
    from cspdiag.pipeline import Built

_MOST_NAMES = 8

EXAMPLE = """\
cspdiag compile models/jiwy/jiwy.csp -o build
cspdiag compile models/jiwy/jiwy.csp --target fmu -o build
cspdiag compile models/jiwy/jiwy.csp -O1 --emit network"""


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("file", metavar="FILE", help="a program; - reads standard input")
    parser.add_argument(
        "-o",
        "--output",
        type=given_name,
        metavar="DIR",
        default="build",
        help="where the package goes (default: build)",
    )
    parser.add_argument(
        "--target",
        metavar="TARGET",
        default="python",
        help=f"language of the package: {', '.join(TARGETS)} (default: python)",
    )
    parser.add_argument(
        "--framework",
        choices=FRAMEWORKS,
        default="",
        help="with --target c: make the package a library for it, with its manifest, instead of a folder with a "
        f"Makefile and a CMakeLists.txt: {', '.join(FRAMEWORKS)}",
        metavar="NAME",
    )
    parser.add_argument(
        "--fmi",
        choices=FMI_VERSIONS,
        default="",
        help=f"with --target fmu: the version of FMI, {' or '.join(FMI_VERSIONS)} (default: {FMI_VERSIONS[0]})",
        metavar="VERSION",
    )
    parser.add_argument("--top", metavar="PROCESS", help="the outermost process (default: that of the environment)")
    parser.add_argument(
        "--environment",
        metavar="NAME",
        help="the environment to compile for (default: the first); with --target fmu: the FMU is this environment, "
        "without the program",
    )
    add_settings(parser)
    add_real(parser)
    parser.add_argument("--force", action="store_true", help="overwrite files that were changed by hand")
    parser.add_argument(
        "--templates",
        type=given_name,
        metavar="DIR",
        help="use the templates in DIR (docs/targets.md), each instead of the bundled one of that name",
    )
    parser.add_argument("--emit", choices=("ast", "model", "network", "lts"), help="print a representation instead")
    parser.add_argument("--debug-passes", action="store_true", help=SUPPRESS)
    level = parser.add_mutually_exclusive_group()
    level.add_argument("-O0", dest="level", action="store_const", const=0, default=0, help="readable code (default)")
    level.add_argument("-O1", dest="level", action="store_const", const=1, help="fast code")


def run(arguments: Namespace) -> int:
    """Generate the package, or print the requested representation."""
    match arguments.emit:
        case "ast":
            return _emit_tree(arguments)
        case "model":
            return _emit_model(arguments)
        case "network":
            return _emit_network(arguments)
        case "lts":
            return _emit_transitions(arguments)
        case None:
            return _generate(arguments)
        case representation:
            raise AssertionError(f"nothing prints {representation!r}")


def _emit_tree(arguments: Namespace) -> int:
    from cspdiag.cli.support.representation import show_tree
    from cspdiag.syntax.parser import parse

    report = Report()
    tree = parse(read_source(arguments.file), report)
    show_diagnostics(report.diagnostics, arguments.color)
    if tree is None or report.has_errors:
        return UNSUCCESSFUL
    write_out(printable(show_tree(tree)))
    return FINE


def _emit_model(arguments: Namespace) -> int:
    from cspdiag.cli.support.representation import show_model

    checked = check(read_source(arguments.file), read_source)
    show_diagnostics(checked.report.diagnostics, arguments.color)
    if checked.program is None or checked.report.has_errors:
        return UNSUCCESSFUL
    write_out(printable(show_model(checked.program)))
    return FINE


def _emit_network(arguments: Namespace) -> int:
    network = _network(arguments)
    if network is None:
        return UNSUCCESSFUL
    from cspdiag.network.dump.network import dump

    if arguments.level == 1:
        from cspdiag.optimize import PASSES, explain_fusion, optimize

        *before, last = PASSES
        unfused = optimize(network, before)
        explained = [f"// {line}\n" for line in explain_fusion(unfused)]
        write_out(printable("".join([dump(optimize(unfused, (last,))), "\n", *explained])))
    else:
        write_out(printable(dump(network)))
    return FINE


def _emit_transitions(arguments: Namespace) -> int:
    network = _network(arguments)
    if network is None:
        return UNSUCCESSFUL
    from cspdiag.proofs.transitions import transition_system
    from cspdiag.proofs.transitions.systems.dump import dump
    from cspdiag.proofs.transitions.threads.explore import TransitionError

    try:
        write_out(printable(dump(transition_system(network))))
    except TransitionError as problem:
        raise NoResultError(str(problem)) from None
    return FINE


def _generate(arguments: Namespace) -> int:
    from cspdiag.cli.support.files.manifest import read_manifest
    from cspdiag.cli.support.files.output import write_package
    from cspdiag.cli.support.templates import read_templates
    from cspdiag.codegen.python.valid import require_valid

    if arguments.target not in TARGETS:
        raise UsageError(f"unknown target {arguments.target!r} (there are: {', '.join(TARGETS)})")
    if arguments.framework and arguments.target != "c":
        raise UsageError(f"--framework {arguments.framework} needs --target c")
    if arguments.fmi and arguments.target != "fmu":
        raise UsageError(f"--fmi {arguments.fmi} needs --target fmu")
    require_folder("-o", arguments.output)
    templates = {} if arguments.templates is None else read_templates(arguments.templates, arguments.target)
    built = _built(arguments, for_code=arguments.target in ("python", "c"))
    network = built.network
    if network is None:
        return UNSUCCESSFUL
    if arguments.target == "fmu":
        return _write_fmu(arguments, built, templates)
    folder = os.path.join(arguments.output, network.name)
    if os.path.lexists(folder) and not os.path.isdir(folder):
        raise UsageError(f"{folder} is in the way: it is not a folder")
    try:
        files = generate(
            network, read_source, arguments.target, arguments.level, templates=templates, framework=arguments.framework
        )
        if arguments.target == "python":
            require_valid(files, templates)
    except target_errors() as problem:
        raise NoResultError(str(problem)) from None
    program = "" if arguments.file == "-" else os.path.relpath(arguments.file, folder)
    earlier = read_manifest(folder, arguments.target, force=True).program
    write_package(folder, files, arguments.target, program=program, force=arguments.force)
    if program and _is_another(os.path.join(folder, earlier), arguments.file):
        before = on_one_line(os.path.normpath(os.path.join(folder, earlier)))
        say(f"{on_one_line(folder)} had the package of {before}, which this one replaces")
    _say_renamed(arguments.file, network.name)
    say(f"wrote {on_one_line(folder)}")
    if arguments.target == "c":
        from cspdiag.simulate.native.memory import report_or_reason

        say(f"{report_or_reason(network, files, arguments.level)}")
    return FINE


def _say_renamed(file: str, package: str) -> None:
    """Say that a package could not have the name of its file, in capitals or not."""
    from cspdiag.network.lower.program import is_taken_by_python

    renamed = package.removesuffix("_")
    stem = os.path.basename(file).removesuffix(".csp")
    if renamed != package and is_taken_by_python(renamed):
        taken = f"`{renamed}` is already used by Python, so the package is called `{package}`"
        say(f"{taken}; it takes its name from the file")
    elif file != STANDARD_INPUT and stem.lower() != package:
        say(f"`{on_one_line(stem)}`, the name of the file, is no identifier, so the package is called `{package}`")


def _is_another(earlier: str, file: str) -> bool:
    """Whether the program of an earlier package still exists and is not this one: then it was not moved."""
    return os.path.isfile(earlier) and not os.path.samefile(earlier, file)


def _write_fmu(arguments: Namespace, built: Built, templates: Mapping[str, Replacement]) -> int:
    """Write an FMU, with the diagrams as its documentation if they can be drawn here."""
    from cspdiag.base.errors import CspdiagError
    from cspdiag.base.files.whole import write_whole
    from cspdiag.codegen.fmi.package import identifier
    from cspdiag.simulate.fmu.export import archive
    from cspdiag.simulate.fmu.settable import settable, settable_environment

    plant, fmi = arguments.environment or "", arguments.fmi or FMI_VERSIONS[0]
    made = settable_environment(built, arguments.top, plant) if plant else settable(built, arguments.top, None)
    network = made.network
    name = identifier(network, plant)
    place = os.path.join(arguments.output, f"{name}.fmu")
    try:
        files = generate(network, read_source, "fmu", arguments.level, templates=templates, fmi=fmi, plant=plant)
    except target_errors() as problem:
        raise NoResultError(str(problem)) from None
    page, missing = _documentation(built)
    try:
        data = archive(files, name, fmi, page)
    except CspdiagError as problem:
        raise NoResultError(str(problem)) from None
    os.makedirs(arguments.output, exist_ok=True)
    write_whole(place, data)
    say(f"wrote {on_one_line(place)}: FMI {fmi}, co-simulation, {len(data) // 1000} kB")
    for reason in dict.fromkeys(made.constants.values()):
        names = [name for name, why in made.constants.items() if why == reason]
        listed = f"{', '.join(names[:_MOST_NAMES])}{', ...' if len(names) > _MOST_NAMES else ''}"
        say(f"  no parameters of the FMU: {listed} ({reason})")
    if missing:
        say(f"  without the diagrams: {missing}")
    return FINE


def _documentation(built: Built) -> tuple[str, str]:
    """The page with the diagrams, or why there is none."""
    from cspdiag.draw.book.page import book
    from cspdiag.draw.layout import engine
    from cspdiag.draw.layout.graph import LayoutError
    from cspdiag.draw.missing import MissingToolError
    from cspdiag.draw.pictures import Pictures

    checked = built.checked
    assert checked.readable is not None
    try:
        engine.start()
        return book(Pictures(checked.readable, (), checked.analysis)), ""
    except (MissingToolError, LayoutError) as problem:
        return "", str(problem)


def _network(arguments: Namespace) -> CoreNetwork | None:
    return _built(arguments).network


def _built(arguments: Namespace, *, for_code: bool = False) -> Built:
    from cspdiag.network.lower.program import SelectionError

    try:
        built = build(
            read_source(arguments.file),
            read_source,
            top=arguments.top,
            environment=arguments.environment,
            settings=split_settings(arguments.settings),
            real=arguments.real,
            for_code=for_code and not arguments.debug_passes,
        )
    except (SettingError, SelectionError) as problem:
        raise UsageError(str(problem)) from None
    show_diagnostics(built.checked.report.diagnostics, arguments.color)
    if arguments.debug_passes and built.network is not None:
        from cspdiag.optimize import PASSES, optimize

        optimize(built.network, PASSES, debug=True)
    return built
