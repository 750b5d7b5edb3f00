"""Checks of what compositions read, write and reset."""

from __future__ import annotations

from cspdiag.base import Label, Report, Span
from cspdiag.model.checks.ports import check_duration
from cspdiag.model.diagnostics.names import WrongKind
from cspdiag.model.diagnostics.ports import DifferentEnds, MisusedName, NotReadable, NotVariable, NotWritable
from cspdiag.model.expressions.coercion import same
from cspdiag.model.program import EndLabelSymbol, PortSymbol, Program, Symbol
from cspdiag.model.symbols import declared_at, described
from cspdiag.model.types import UNKNOWN
from cspdiag.model.wording import waited_for
from cspdiag.syntax import ast
from cspdiag.syntax.walk import nodes


def check_compositions(program: Program, report: Report) -> None:
    """Check the composition of every process."""
    for definition in program.definitions.values():
        if isinstance(definition, ast.ProcessDefinition) and definition.composition is not None:
            for part in nodes(definition.composition):
                _check(program, part, report)


def _check(program: Program, part: ast.Node, report: Report) -> None:
    match part:
        case ast.Read() | ast.InputGuard():
            _check_readable(program, part.channel, report)
            _check_variable(program, part.target, report, f"{part.channel.span.text} ? value")
            _check_same(program, part.channel, part.target, report)
        case ast.ReadyGuard():
            _check_readable(program, part.channel, report)
        case ast.Write() | ast.OutputGuard():
            _check_writable(program, part.channel, report)
        case ast.Assign():
            _check_variable(program, part.target, report, None)
        case ast.Wait() | ast.TimeGuard():
            check_duration(program, part.time, f"the {waited_for(part)}", report)
        case ast.Reset():
            _check_reset(program, part.instance, report)
        case _:  # Any other node of the composition.
            pass


def _named(program: Program, reference: ast.Reference) -> Symbol | None:
    if reference in program.poisoned:
        return None
    member = program.members.get(reference)
    return member if isinstance(member, PortSymbol) else program.bindings.get(reference)


def _refuse(
    misuse: type[MisusedName], program: Program, reference: ast.Reference, symbol: Symbol, advice: str, report: Report
) -> None:
    kind = f"{described(symbol)} of an instance" if reference.member is not None else described(symbol)
    declared = declared_at(symbol)
    report.add(misuse(reference.span, name=reference.span.text, kind=kind, advice=advice, declared=declared))
    program.poisoned.add(reference)


def _check_readable(program: Program, reference: ast.Reference, report: Report) -> None:
    symbol = _named(program, reference)
    match symbol:
        case None | ast.Channel():
            return
        case PortSymbol() if reference.member is None and symbol.declaration.direction == "in":
            return
        case PortSymbol() if reference.member is not None:
            advice = f"connect it to a channel and read that: `{reference.span.text} -> name`, `name ? x`"
        case PortSymbol():
            advice = f"write it by `{reference.span.text} ! value`, or declare it as an in port"
        case _:  # Other names of values, which are neither ports nor channels.
            advice = "use its name alone in conditions and expressions"
    _refuse(NotReadable, program, reference, symbol, advice, report)


def _check_writable(program: Program, reference: ast.Reference, report: Report) -> None:
    symbol = _named(program, reference)
    match symbol:
        case None | ast.Channel():
            return
        case PortSymbol() if reference.member is None and symbol.declaration.direction == "out":
            return
        case PortSymbol() if reference.member is not None:
            advice = f"connect a channel to it and write that: `name -> {reference.span.text}`, `name ! value`"
        case PortSymbol():
            advice = f"read it by `{reference.span.text} ? x`, or declare it as an out port"
        case _:  # Other names of values, which are neither ports nor channels.
            advice = f"set it by `{reference.span.text} := value`"
    _refuse(NotWritable, program, reference, symbol, advice, report)


def _check_variable(program: Program, reference: ast.Reference, report: Report, read: str | None) -> None:
    symbol = _named(program, reference)
    if symbol is None or isinstance(symbol, ast.Variable) or (isinstance(symbol, EndLabelSymbol) and symbol.ends_arrow):
        return
    found = program.types.get(reference, UNKNOWN)
    if read is not None:
        advice = f"declare `var value : {found}` and write `{read}`"
    elif isinstance(symbol, PortSymbol) and symbol.declaration.direction == "in":
        advice = f"read it into a variable by `{reference.span.text} ? value`"
    elif isinstance(symbol, PortSymbol | ast.Channel):
        advice = f"write it by `{reference.span.text} ! value`"
    else:
        advice = "only variables are set by `:=`"
    _refuse(NotVariable, program, reference, symbol, advice, report)


def _check_same(program: Program, channel: ast.Reference, target: ast.Reference, report: Report) -> None:
    """Check that the variable into which a value is read has its type and unit."""
    if channel in program.poisoned or target in program.poisoned:
        return
    carried, kept = program.types.get(channel, UNKNOWN), program.types.get(target, UNKNOWN)
    if not same(carried, kept):
        notes = tuple(
            Label(place, f"`{end.span.text}` is declared as {found}")
            for end, found in ((channel, carried), (target, kept))
            if (place := _declaration(program, end)) is not None
        )
        advice = f"declare `{target.name.text}` with the type of what is read, {carried}"
        name = channel.span.text
        report.add(DifferentEnds(target.span, name, carried, target.span.text, kept, notes, advice))


def _declaration(program: Program, reference: ast.Reference) -> Span | None:
    symbol = _named(program, reference)
    return declared_at(symbol) if symbol is not None else None


def _advice_on_reset(program: Program, process: ast.ProcessDefinition) -> str:
    """How to reset variables and laws of a process, which keep their values from run to run unless the process itself
    resets them.
    """
    declared = process.communication.declarations if process.communication is not None else ()
    instances = [item for item in declared if isinstance(item, ast.Instance)]
    laws = [item for item in instances if isinstance(program.bindings.get(item.definition), ast.SubmodelDefinition)]
    ways = [f"`reset {item.name.text}`" for item in laws[:1]]
    ways += [f"`{item.name.text} := ...`" for item in declared if isinstance(item, ast.Variable)][:1]
    where = f": reset them in the composition of `{process.name.text}` ({', '.join(ways)})" if ways else ""
    return f"only submodels are reset; a process keeps its variables and the states of its laws from run to run{where}"


def _check_reset(program: Program, reference: ast.Reference, report: Report) -> None:
    symbol = _named(program, reference)
    if not isinstance(symbol, ast.Instance):
        return
    definition = program.bindings.get(symbol.definition)
    if isinstance(definition, ast.ProcessDefinition):
        refused = WrongKind(
            reference.span,
            name=reference.span.text,
            kind=f"an instance of the process `{definition.name.text}`",
            expected="an instance of a submodel",
            advice=_advice_on_reset(program, definition),
            declared=symbol.name.span,
        )
        report.add(refused)
