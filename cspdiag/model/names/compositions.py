"""Names and types in compositions."""

from __future__ import annotations

from typing import Literal, assert_never

from cspdiag.model.diagnostics.names import UnknownName, WrongKind
from cspdiag.model.expressions.coercion import Purpose
from cspdiag.model.expressions.declared_types import size_of
from cspdiag.model.expressions.numbers import Typer
from cspdiag.model.names.references import check_instance_index, end_of_channel, find, ports_of, refuse_kind
from cspdiag.model.names.scopes import check_replicator
from cspdiag.model.program import BuiltinSymbol, PortSymbol
from cspdiag.model.symbols import BUILTIN_EXCEPTIONS, declared_at, described
from cspdiag.model.types import INT, TIME
from cspdiag.model.wording import waited_for, with_article
from cspdiag.syntax import ast


def resolve_composition(typer: Typer, composition: ast.Composition) -> None:
    """Bind every name of a composition and type its expressions; the parser limits the depth of nesting."""
    match composition:
        case ast.Run():
            _instance(typer, composition.instance, "run")
        case ast.Reset():
            _instance(typer, composition.instance, "reset")
        case ast.Read():
            end_of_channel(typer, composition.channel, "port")
            end_of_channel(typer, composition.target, "variable")
        case ast.Write():
            _written(typer, composition.channel, composition.value)
        case ast.Assign():
            expected = end_of_channel(typer, composition.target, "variable")
            typer.require(composition.value, expected, _purpose(typer, composition.target, "variable"))
        case ast.Skip() | ast.Stop():
            pass
        case ast.Wait():
            typer.require(composition.time, TIME, Purpose(what=with_article(waited_for(composition))))
        case ast.Raise():
            bind_exception(typer, composition.exception)
        case ast.Sequence() | ast.Parallel():
            for process in composition.processes:
                resolve_composition(typer, process)
        case ast.Alternative():
            for branch in composition.branches:
                resolve_composition(typer, branch)
        case ast.Guarded():
            _guard(typer, composition.guard)
            resolve_composition(typer, composition.process)
        case ast.Mu():
            resolve_composition(typer, composition.process)
            if composition.until is not None:
                typer.condition(composition.until)
        case ast.While():
            typer.condition(composition.condition)
            resolve_composition(typer, composition.process)
        case ast.If():
            typer.condition(composition.condition)
            resolve_composition(typer, composition.then)
            if composition.otherwise is not None:
                resolve_composition(typer, composition.otherwise)
        case ast.Catch():
            resolve_composition(typer, composition.process)
            bind_exception(typer, composition.exception)
            resolve_composition(typer, composition.handler)
        case ast.Interrupt():
            resolve_composition(typer, composition.process)
            _guard(typer, composition.guard)
            resolve_composition(typer, composition.handler)
        case ast.Replicated():
            check_replicator(typer, composition.replicator)
            size_of(typer, composition.replicator.count, "the count of a replicator")
            resolve_composition(typer.within(composition.replicator), composition.process)
        case ast.Labelled():
            resolve_composition(typer, composition.process)
        case _:
            assert_never(composition)


def _guard(typer: Typer, guard: ast.Guard) -> None:
    if guard.condition is not None:
        typer.condition(guard.condition)
    match guard.event:
        case ast.ReadyGuard():
            end_of_channel(typer, guard.event.channel, "port")
        case ast.InputGuard():
            end_of_channel(typer, guard.event.channel, "port")
            end_of_channel(typer, guard.event.target, "variable")
        case ast.OutputGuard():
            _written(typer, guard.event.channel, guard.event.value)
        case ast.TimeGuard():
            typer.require(guard.event.time, TIME, Purpose(what=with_article(waited_for(guard.event))))
        case ast.SkipGuard():
            pass
        case _:
            assert_never(guard.event)


def _written(typer: Typer, channel: ast.Reference, value: ast.Expression) -> None:
    expected = end_of_channel(typer, channel, "port")
    typer.require(value, expected, _purpose(typer, channel, "port"))


def _purpose(typer: Typer, reference: ast.Reference, expected: str) -> Purpose:
    symbol = typer.context.program.bindings.get(reference)
    if symbol is None:
        return Purpose(what=f"the {expected} `{reference.span.text}`")
    kind = described(symbol).split(" ", 1)[1]
    return Purpose(
        what=f"the {kind} `{reference.span.text}`",
        declared=declared_at(symbol),
        declared_text=f"`{reference.name.text}` is declared here",
    )


def _instance(typer: Typer, reference: ast.Reference, verb: Literal["run", "reset"]) -> None:
    """Resolve what is run or reset: an instance, without a port."""
    symbol = find(typer, reference, "instance", (ast.Instance,))
    for index in (*reference.indexes, *reference.member_indexes):
        typer.constant(index, INT, Purpose(what="an index"))
    if symbol is None:
        return
    if not isinstance(symbol, ast.Instance):
        advice = "a port is read by `? x` and written by `! value`" if "port" in described(symbol) else None
        refuse_kind(typer, reference, symbol, "instance", advice)
    elif reference.member is not None:
        _refuse_member(typer, reference, symbol, verb)
    else:
        check_instance_index(typer, reference, symbol)


def _refuse_member(typer: Typer, reference: ast.Reference, instance: ast.Instance, verb: str) -> None:
    """Report that a part of an instance is run or reset: a port, or something inside it, which only its own composition
    may use.
    """
    assert reference.member is not None
    definition = typer.context.program.bindings.get(instance.definition)
    scope = ports_of(typer, instance)
    member = None if scope is None else scope.ports.get(reference.member.text) or scope.names.get(reference.member.text)
    kind = f"a name that `{instance.definition.text}` does not have"
    advice = f"{verb} the instance: `{reference.name.text}`"
    if verb == "reset" and isinstance(definition, ast.ProcessDefinition):
        advice = "`reset name` puts back the states of a submodel of this process"
    if isinstance(member, PortSymbol):
        kind = "a port of an instance"
    elif isinstance(member, ast.Instance):
        kind = f"inside `{reference.name.text}`"
        if verb == "reset" and isinstance(definition, ast.ProcessDefinition):
            advice = f"only the composition of `{definition.name.text}` resets it: `reset {reference.member.text}`"
    refused = WrongKind(
        reference.span,
        name=reference.span.text,
        kind=kind,
        expected="an instance of this process" if isinstance(member, ast.Instance) else "an instance",
        advice=advice,
        declared=member.name.span if isinstance(member, ast.Instance) else None,
    )
    typer.context.refuse(refused, reference)


def bind_exception(typer: Typer, name: ast.Identifier) -> None:
    """Bind the name of an exception: ``Timeout``, ``Fault`` or a declared one."""
    context = typer.context
    definition = context.program.definitions.get(name.text)
    if isinstance(definition, ast.ExceptionDefinition):
        context.program.bindings[name] = definition
    elif definition is None and name.text in BUILTIN_EXCEPTIONS:
        context.program.bindings[name] = BuiltinSymbol(name=name.text)
    elif definition is not None:
        context.refuse_kind(name.span, name.text, definition, "an exception", None, name)
    elif context.excuses_unknown_names:
        context.program.poisoned.add(name)
    else:
        declared = [
            other for other, found in context.program.definitions.items() if isinstance(found, ast.ExceptionDefinition)
        ]
        missing = UnknownName(
            name.span,
            name=name.text,
            expected="exception",
            suggestion=context.speller.nearest(name.text, (*BUILTIN_EXCEPTIONS, *declared)),
            declared=None,
            advice=f"declare it outside the process: `exception {name.text}`",
        )
        context.refuse(missing, name)
