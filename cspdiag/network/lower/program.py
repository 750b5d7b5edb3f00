"""From the typed model to the network."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Mapping
from keyword import iskeyword

from cspdiag.base import Report
from cspdiag.base.errors import CspdiagError
from cspdiag.base.render.snippet import on_one_line
from cspdiag.base.spelling import Speller
from cspdiag.model.program import Program, Value
from cspdiag.network.analyse import Analysis
from cspdiag.network.check import arguments_of_outermost, environments_of, process_of
from cspdiag.network.elaborate.definitions import arguments_of
from cspdiag.network.elaborate.expression import LoweringContext, lower_expression
from cspdiag.network.elaborate.vocabulary import Vocabulary
from cspdiag.network.infer.contexts import Surroundings
from cspdiag.network.infer.parameter_ranges import with_ranges
from cspdiag.network.ir.expressions import Expression
from cspdiag.network.ir.network import CoreNetwork, Network
from cspdiag.network.lower.classes import Classes
from cspdiag.network.lower.environments import lower_environment
from cspdiag.network.lower.external_ports import external_ports
from cspdiag.network.lower.instances import walk_instances
from cspdiag.network.lower.setting_paths import of_root, refuse_missing
from cspdiag.network.lower.tunable import bound, program_parameters
from cspdiag.network.occurrences import Occurrences, instance_names, tunable_parameters, values_by_name
from cspdiag.network.submodels.initial_values import check_initial_values, with_tested_initial_values
from cspdiag.syntax import ast
from cspdiag.syntax.parse.ascii_names import ascii_letters


class SelectionError(CspdiagError, ValueError):
    """There is no process or environment as selected, or it lacks a value; the message is one line."""


class MissingValueError(SelectionError):
    """Parameters of the process have no value."""

    def __init__(self, message: str, parameters: tuple[ast.Parameter, ...] = ()) -> None:
        super().__init__(message)
        self.parameters = parameters


class NoProgramError(MissingValueError):
    """Nothing was selected, and the text has no process that is a program by itself: it is a library."""


def lower(
    program: Program,
    top: str | None,
    environment: str | None,
    overrides: Mapping[str, Value],
    report: Report,
    *,
    surroundings: Surroundings = "environment",
    checked: Analysis | None = None,
    alone: bool = False,
) -> CoreNetwork | None:
    """The network of an outermost process; None if an error was reported.

    ``top`` is its name, by default that of the process of the environment, which by default is the first one in the
    text; without any environment it is the last process that is not instantiated and is not a specification of another
    one. ``overrides`` are values of parameters by the path of the instance, as for ``of_root``. ``surroundings`` says
    what its ports are connected to. With ``alone`` only the chosen environment is included. ``checked`` is the result
    of ``check`` for the same program, with the same report. Raises SelectionError if there is no such process, or a
    parameter of it has no value, and NoSuchElementError for an override of an element that an array does not have.
    """
    analysis = Analysis(program, report) if checked is None or overrides else checked
    process, wanted = selection(program, analysis, top, environment, alone=alone)
    arguments = wanted[0].arguments if wanted else ()
    own = of_root(overrides, process)
    values = arguments_of_outermost(analysis, process, arguments, own)
    tunable = tunable_parameters(program, process.parameters, arguments, own)
    lacking = tuple(item for item in process.parameters if item not in values and item.name.text not in tunable)
    if lacking:
        kind = NoProgramError if top is None and environment is None else MissingValueError
        raise kind(
            f"the outermost process `{process.name.text}` has no value for its parameter `{lacking[0].name.text}`: "
            f"give it a default, set it, or write an environment for `{process.name.text}(...)`",
            lacking,
        )
    is_known = analysis is checked and surroundings == "environment"
    root = analysis.known_root(process, values_by_name(values)) if is_known else None
    if root is None:
        analysis = Analysis(program, report)
        shape = analysis.add_root(process, arguments, values_by_name(values), own, surroundings)
        (placed,) = analysis.run()
        if report.has_errors:
            return None
    else:
        shape, placed = root
    occurrences = Occurrences(program, analysis.elaboration, report)
    outermost = occurrences.outermost(placed, values, tunable)
    if not occurrences.flatten():
        return None
    classes = Classes(program, analysis.definitions, analysis.relations, report)
    classes.make(occurrences.found)
    ports = external_ports(program, shape, analysis.requested[shape], report)
    instances, nets = walk_instances(outermost, classes, ports)
    if own:
        refuse_missing(program, process, own, instance_names(outermost))
    below = ((item, overrides_of_environment(overrides, process, item)) for item in wanted)
    lowered = tuple(
        found
        for item, values in below
        if (found := lower_environment(program, item, ports, values, report)) is not None
    )
    if report.has_errors:
        return None
    computed = _arguments_of_program(program, process, arguments, tunable)
    parameters = program_parameters(program, (*classes.made.values(), *lowered, *computed.values()))
    tuned = bound(classes.made, classes.class_of[outermost], computed, instances, parameters)
    check_initial_values(tuned.classes, tuned.instances, lowered, parameters, report)
    if report.has_errors:
        return None
    made = tuple(map(with_tested_initial_values, tuned.classes.values()))
    vocabulary = Vocabulary(program, (*made, *ports, *lowered, *parameters))
    return Network(
        name=_package_name(program, process),
        source=program.main.source.name,
        top=classes.class_of[outermost],
        doc=process.doc,
        arguments=tuple(values_by_name(values).items()),
        constants=vocabulary.constants(),
        parameters=parameters,
        tunable=tuned.outermost,
        enums=vocabulary.enums(),
        structs=vocabulary.structs(),
        exceptions=vocabulary.exceptions(),
        classes=with_ranges(made, tuned.instances),
        external_ports=ports,
        environments=lowered,
        instances=tuned.instances,
        nets=nets,
    )


def overrides_of_environment(
    overrides: Mapping[str, Value], process: ast.ProcessDefinition, environment: ast.EnvironmentDefinition
) -> dict[str, Value]:
    """The values for an environment, by path. It also uses the parameters of its process, which have bare names."""
    bare = {path: value for path, value in of_root(overrides, process).items() if "." not in path}
    return {**of_root(overrides, environment), **bare}


def _arguments_of_program(
    program: Program,
    process: ast.ProcessDefinition,
    arguments: tuple[ast.Argument, ...],
    tunable: frozenset[str],
) -> dict[str, Expression]:
    """The arguments of those parameters of an outermost process that follow parameters of the program; a default may
    use parameters before it.
    """
    given = dict(arguments_of(process.parameters, arguments))
    known: dict[str, Expression] = {}

    def own(name: ast.Name | ast.Member | ast.Reference) -> Expression | None:
        symbol = program.bindings.get(name)
        return known.get(symbol.name.text) if isinstance(symbol, ast.Parameter) else None

    for parameter in process.parameters:
        expression = given.get(parameter, parameter.default)
        if parameter.name.text in tunable and expression is not None:
            known[parameter.name.text] = lower_expression(
                program, expression, LoweringContext(values={}, lower_name=own)
            )
    return known


def selection(
    program: Program, analysis: Analysis, top: str | None, environment: str | None, *, alone: bool = False
) -> tuple[ast.ProcessDefinition, tuple[ast.EnvironmentDefinition, ...]]:
    """The outermost process and its environments, the chosen one first; see ``lower``.

    If no environment was requested by name, the others are those with the same arguments of the process. Raises
    SelectionError.
    """
    chosen = _chosen_environment(program, top, environment)
    process = _top(program, analysis, top, chosen)
    if environment is not None and chosen is None:
        raise SelectionError(_no_environment(program, top, environment))
    if chosen is None or alone or environment is not None:
        return process, (chosen,) if chosen is not None else ()
    others = (e for e in environments_of(program) if e is not chosen and _alike(program, process, e, chosen))
    return process, (chosen, *others)


def _chosen_environment(program: Program, top: str | None, environment: str | None) -> ast.EnvironmentDefinition | None:
    for candidate in environments_of(program):
        fits_top = top is None or candidate.process.text == top
        if fits_top and environment in (None, candidate.name.text):
            return candidate
    return None


def _no_environment(program: Program, top: str | None, environment: str) -> str:
    """Why there is no environment of this name, or none of it for the process ``top``."""
    closed = {item.name.text: item.process.text for item in environments_of(program)}
    fitting = [name for name, process in closed.items() if top in (None, process)]
    if environment in closed:
        known = suggestion(environment, fitting) if fitting else ", which has none"
        return f"`{environment}` is an environment for `{closed[environment]}`, not for `{top}`{known}"
    return f"there is no environment `{environment}`{f' for `{top}`' if top else ''}{suggestion(environment, fitting)}"


def _top(
    program: Program,
    analysis: Analysis,
    top: str | None,
    environment: ast.EnvironmentDefinition | None,
) -> ast.ProcessDefinition:
    if top is not None:
        found = program.definitions.get(top)
    elif environment is not None:
        found = process_of(program, environment)
    else:
        found = analysis.definitions.outermost()
    if isinstance(found, ast.ProcessDefinition) and found not in analysis.definitions.recursive:
        return found
    if top is not None:
        processes = [name for name, item in program.definitions.items() if isinstance(item, ast.ProcessDefinition)]
        raise SelectionError(f"there is no process `{top}`{suggestion(top, processes)}")
    raise NoProgramError(f"{on_one_line(program.main.source.name)} has no process")


def suggestion(name: str, known: Iterable[str]) -> str:
    """A suggestion of a known name that is spelled similarly, or else a list of the known names."""
    names = sorted(known)
    near = Speller().nearest(name, names)
    if near:
        return f" (did you mean `{near}`?)"
    listed = ", ".join(f"`{each}`" for each in names[:_MOST_NAMES])
    return f" (there is {listed}{', ...' if len(names) > _MOST_NAMES else ''})" if names else ""


_MOST_NAMES = 8


def _alike(
    program: Program,
    process: ast.ProcessDefinition,
    one: ast.EnvironmentDefinition,
    other: ast.EnvironmentDefinition,
) -> bool:
    same = len(one.arguments) == len(other.arguments) and all(
        ast.same_tree(a, b) for a, b in zip(one.arguments, other.arguments, strict=True)
    )
    return same and process_of(program, one) is process


def _package_name(program: Program, process: ast.ProcessDefinition) -> str:
    """The name of the package: that of the file without folder and suffix as an identifier of ASCII letters, or else
    that of the process.
    """
    from unicodedata import normalize

    stem = normalize("NFC", program.main.source.name.replace("\\", "/").rsplit("/", 1)[-1].removesuffix(".csp"))
    spelled = "".join((c if c.isascii() else ascii_letters(c)) or "_" for c in stem)
    name = "".join(c if c.isalnum() else "_" for c in spelled).strip("_")
    if not name or name[0].isdigit():
        name = process.name.text
    name = name.lower()
    return f"{name}_" if is_taken_by_python(name) else name


def is_taken_by_python(name: str) -> bool:
    """Whether a package cannot have this name: a keyword of Python, or a module of its library, which would hide the
    package or be hidden by it.
    """
    return iskeyword(name) or name in sys.stdlib_module_names
