"""Bodies in other languages: finds them, and checks their names. Whether the files exist is checked where files are
read.
"""

from __future__ import annotations

import re
from keyword import iskeyword

from cspdiag.base import Report
from cspdiag.base.record import record
from cspdiag.model.names.described import LANGUAGE
from cspdiag.model.program import Program
from cspdiag.network.checks.drivers.devices import check_device
from cspdiag.network.diagnostics.external import DriverWithoutBody, MalformedTarget, MixedBody, UnsupportedLanguage
from cspdiag.network.ir.equations import ExternalBody
from cspdiag.network.ir.external import files_of_body
from cspdiag.network.submodels.inline import external_body
from cspdiag.syntax import ast

_NAME = r"[A-Za-z_][A-Za-z0-9_]*"
_FOLDERS = r"(?:[^:*?\"<>|\x00-\x1f]*/)?"
_TARGETS = {
    # A file, or an installed module, whose name is written into generated code unchanged.
    "python": re.compile(rf"(?P<file>{_FOLDERS}[^:*?\"<>|\x00-\x1f/]+\.py|{_NAME}(?:[./]{_NAME})*):(?P<name>{_NAME})"),
    # A file that is copied under its own name, which appears in makefiles.
    "c": re.compile(rf"(?P<file>{_FOLDERS}[A-Za-z0-9_][A-Za-z0-9_.+-]*\.c)"),
    "fmu": re.compile(rf"(?P<file>{_FOLDERS}[^:*?\"<>|\x00-\x1f/]+\.fmu)(?::(?P<name>CoSimulation|ModelExchange))?"),
}
Owner = ast.ProcessDefinition | ast.SubmodelDefinition | ast.DriverDefinition


@record
class NamedBody:
    """The external body of a definition. ``file`` is the file, or a module if it has no suffix; ``name`` is the class
    in it.
    """

    definition: str
    body: ExternalBody
    file: str
    name: str | None


def external_bodies(program: Program) -> list[NamedBody]:
    """All external bodies with valid names, in the order of the definitions."""
    found: list[NamedBody] = []
    for definition in program.definitions.values():
        if not isinstance(definition, Owner) or definition.external is None:
            continue
        pattern = _TARGETS.get(definition.external.language.text)
        match = _parts(pattern, definition.external.target) if pattern else None
        if match:
            parts = match.groupdict()
            found.append(
                NamedBody(definition.name.text, external_body(definition.external), parts["file"], parts.get("name"))
            )
    return found


def files_of_bodies(tree: ast.SourceTree) -> tuple[str, ...]:
    """The paths of the files that a file of a program names as bodies of its definitions, each once."""
    found = (item.external for item in tree.items if isinstance(item, Owner) and item.external is not None)
    return tuple(dict.fromkeys(path for each in found for path in files_of_body(external_body(each))))


def _parts(pattern: re.Pattern[str], target: str) -> re.Match[str] | None:
    """The parts of the name of a body; None if it is invalid. A keyword of Python names neither a module nor
    a class.
    """
    found = pattern.fullmatch(target)
    if found is None:
        return None
    file, name = found["file"], found.groupdict().get("name") or ""
    module = [] if file.endswith((".py", ".c", ".fmu")) else re.split("[./]", file)
    return None if any(map(iskeyword, (*module, name))) else found


_KINDS: dict[type[Owner], str] = {
    ast.ProcessDefinition: "process",
    ast.SubmodelDefinition: "submodel",
    ast.DriverDefinition: "driver",
}


def check(program: Program, report: Report) -> None:
    """Reports bodies in languages that cannot be called, malformed names, and drivers without a body."""
    for definition in program.definitions.values():
        if not isinstance(definition, Owner) or definition in program.poisoned:
            continue
        external = definition.external
        if external is None:
            if isinstance(definition, ast.DriverDefinition):
                report.add(DriverWithoutBody(definition.name.span, definition.name.text))
            continue
        kind = _KINDS[type(definition)]
        language = external.language.text
        if isinstance(definition, ast.DriverDefinition) and language == "device":
            check_device(program, definition, external, report)
            continue
        pattern = _TARGETS.get(language)
        if pattern is None or (kind != "submodel" and language == LANGUAGE):
            report.add(UnsupportedLanguage(external.language.span, language, kind))
        elif not _parts(pattern, external.target):
            report.add(MalformedTarget(external.target_span, language, external.target))
        elif language == LANGUAGE and isinstance(definition, ast.SubmodelDefinition):
            from cspdiag.network.checks.drivers.fmus import check_fmu

            check_fmu(program, definition, external, report)
        if _has_own_body(definition):
            report.add(MixedBody(external.span, definition.name.text))


def _has_own_body(definition: Owner) -> bool:
    if isinstance(definition, ast.SubmodelDefinition):
        return bool(definition.items)
    return isinstance(definition, ast.ProcessDefinition) and not (
        definition.communication is None and definition.composition is None
    )
