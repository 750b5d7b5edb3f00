"""Process classes as pairs of C files: a struct with everything that the process owns, and its step functions."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from cspdiag.base.record import record
from cspdiag.codegen.c.process.divided import divide
from cspdiag.codegen.c.process.initialization import initialization
from cspdiag.codegen.c.process.leaves import leaf_header
from cspdiag.codegen.c.process.levels import Levels
from cspdiag.codegen.c.process.schedules import roll_repeated
from cspdiag.codegen.c.process.steps.composition import CompositionWriter
from cspdiag.codegen.c.process.struct.declarations import declared, port_members
from cspdiag.codegen.c.process.struct.members import Members, StructMember
from cspdiag.codegen.c.process.struct.unwritten import Unwritten
from cspdiag.codegen.c.text.code import call, code, ignored
from cspdiag.codegen.c.text.documents import comment, wrapped
from cspdiag.codegen.c.text.names import PackageNames
from cspdiag.codegen.c.text.statements import (
    Block,
    For,
    Function,
    Plain,
    Remark,
    Statement,
    lines,
    run,
    signature,
)
from cspdiag.codegen.c.text.types import CTypes
from cspdiag.model.types import Type
from cspdiag.network.ir.network import Network, ProcessClass, SubmodelClass

_LONGEST_INITIALIZATION = 100
"""The largest number of statements in a function that initializes a process; more are several functions."""


@record
class NetworkFacts:
    """Properties of the whole network."""

    levels: Levels
    unwritten: Unwritten


@record
class ProcessFiles:
    """The header and the source of one process class, by file name, and what the class has numbers for.

    ``observed`` are its groups, with an empty definition, and flattened processes, with the names of their definitions,
    in the order of their numbers, which follow that of the process. ``reports`` are the channels that were optimized
    away, with their types. All have paths relative to the process.
    """

    files: dict[str, str]
    observed: Sequence[tuple[str, str]]
    reports: Sequence[tuple[str, Type]]
    variables: Sequence[str]
    """Variables that may be read before they are written."""


def process_files(
    process: ProcessClass, network: Network, names: PackageNames, types: CTypes, facts: NetworkFacts
) -> ProcessFiles:
    """The files of a generated, not hand-written, process class."""
    writer = _Writer(process, network, names, types, facts)
    files = {f"{writer.struct}.h": writer.header(), f"{writer.struct}.c": writer.source()}
    reports = [(path, type_) for path, (_, type_) in writer.members.reports.items()]
    variables = [c.name for c in process.channels if c.name in facts.unwritten.variables[process.name]]
    return ProcessFiles(files, writer.composition.observed, reports, variables)


class _Writer:
    def __init__(
        self, process: ProcessClass, network: Network, names: PackageNames, types: CTypes, facts: NetworkFacts
    ) -> None:
        self.process = process
        self.names = names
        self.struct = names.classes[process.name]
        self.members = Members(process, network, types, facts.unwritten)
        self.types = types
        self.composition = CompositionWriter(
            self.members, self.members.running_printer, names, facts.levels, self.struct
        )
        self.initial = initialization(self.composition)
        self.place = names.place(process.span.file, process.span.line)

    # The header

    def header(self) -> str:
        guard, struct = f"{self.struct.upper()}_H", self.struct
        about = [*wrapped(self.process.doc or f"The process {self.process.definition}."), "", f"Source: {self.place}"]
        rows = [*comment(about), f"#ifndef {guard}", f"#define {guard}", ""]
        rows += [f'#include "{name}"' for name in ("csp.h", "types.h", *self._included())]
        ports = port_members(self.members)
        if ports:
            rows += ["", "/* What the ports are connected to. */"]
            rows += lines([Block(tuple(_fields(ports)), f"struct {struct}_ports", "};")])
        rows += ["", *lines([Block(tuple(self._struct()), f"struct {struct}", "};")])]
        rows += ["", "/* Before the program starts. */", *signature(*head(self.members, struct), ";")]
        return "\n".join([*rows, "", "#endif", ""])

    def _included(self) -> Iterable[str]:
        classes = dict.fromkeys(item.class_name for item in self.process.instances)
        return dict.fromkeys(self._header_of(self.members.classes[name]) for name in classes)

    def _header_of(self, class_: ProcessClass | SubmodelClass) -> str:
        if isinstance(class_, ProcessClass) and class_.external is not None:
            return leaf_header(class_)
        return f"{self.names.classes[class_.name]}.h"

    def _struct(self) -> list[Statement]:
        members = self.members
        statements = _fields(declared(members))
        for name, fields in members.structs.items():
            statements.append(Block(tuple(_fields(fields)), "struct", f"}} {name};"))
        for name, kept in self.composition.unions():
            statements.append(Block(tuple(_fields(kept)), "union", f"}} {name};"))
        statements += _fields(members.work)
        offers = self.composition.offer_arrays()
        statements += [run(f"csp_offer {name}_made[{count}]") for name, count in offers.items()]
        if members.reports:
            statements += [Remark("number of the first channel that was optimized away"), run("uint32_t first_report")]
        return statements

    # The source

    def source(self) -> str:
        composition = self.composition
        for routine in composition.routines:
            roll_repeated(routine, composition.tables)
            divide(routine)
        rows = [f'#include "{self.struct}.h"', "", '#include "csp_arithmetic.h"', '#include "constants.h"', ""]
        states = [place.state for routine in composition.routines for place in routine.places]
        if states:
            entries = [f"{states[0]} = 1", *states[1:]]
            listed = tuple(Plain(code(entry), "," if entry != entries[-1] else "") for entry in entries)
            rows += ["/* Where the process waits, and where it continues after a failure. */"]
            rows += [*lines([Block(listed, "enum", "};")]), ""]
        rows += lines(composition.tables)
        for function in composition.functions:
            rows += [*lines(function), ""]
        for routine in reversed(composition.routines):
            rows += [*routine.text(), "", *routine.table(), ""]
        functions = [line for function in self._initialization() for line in ["", *lines([function])]]
        return "\n".join([*rows, *functions[1:], ""])

    def _initialization(self) -> list[Function]:
        """The function that initializes the process, last, and the parts that it calls if it would be long: compilers
        take more time for one long function than for many short ones, and its lists of ports are all on the stack.
        """
        begin, parameters = head(self.members, self.struct)
        statements = tuple(self.initial)
        if len(statements) <= _LONGEST_INITIALIZATION or not all(map(_stands_alone, statements)):
            return [Function(begin, parameters, statements)]
        given = arguments(self.members)
        unused = tuple(run(ignored(code(each))) for each in given[1:])
        parts: list[Function] = []
        calls: list[Statement] = []
        for start in range(0, len(statements), _LONGEST_INITIALIZATION):
            part = statements[start : start + _LONGEST_INITIALIZATION]
            named = f"{self.struct}_initialize_{len(calls) + 1}"
            parts.append(Function(f"static void {named}", parameters, (*unused, *part)))
            calls.append(run(call(named, *given)))
        return [*parts, Function(begin, parameters, tuple(calls))]


def _stands_alone(statement: Statement) -> bool:
    """Whether a statement of an initialization function uses no name that another one declares."""
    return isinstance(statement, Block | For | Remark) or (isinstance(statement, Plain) and not statement.declares)


def _fields(members: Sequence[StructMember]) -> list[Statement]:
    """Members, each below its comment."""
    statements: list[Statement] = []
    for member in members:
        statements += [Remark(member.comment)] if member.comment is not None else []
        statements.append(run(member.declaration))
    return statements


def arguments(members: Members) -> list[str]:
    """The names of the parameters of the initialization function of a process."""
    ports = ["ports"] if port_members(members) else []
    return ["self", "numbers", *ports, *(members.parameters[item.name] for item in members.process.parameters)]


def head(members: Members, struct: str) -> tuple[str, tuple[str, ...]]:
    """The head of the initialization function of a process, and its parameters."""
    given = [f"struct {struct} *self", "csp_numbers *numbers"]
    if port_members(members):
        given.append(f"const struct {struct}_ports *ports")
    for item in members.process.parameters:
        given.append(members.types.parameter(item, members.parameters[item.name]))
    return f"void {struct}_initialize", tuple(given)
