"""Arguments of instances, environments and structs: positional first, then by name."""

from __future__ import annotations

from collections.abc import Sequence

from cspdiag.base import Span
from cspdiag.base.record import node
from cspdiag.model.context import Context
from cspdiag.model.diagnostics.arguments import (
    MissingArgument,
    PositionalAfterNamed,
    RepeatedArgument,
    TooManyArguments,
    UnknownArgument,
)
from cspdiag.syntax import ast


@node
class Matches:
    """The argument for each name. ``complete`` is false if an argument matched no name: then the missing ones are not
    known for certain.
    """

    values: dict[str, ast.Argument]
    complete: bool


def matched(
    context: Context,
    owner: str,
    receivers: Sequence[ast.Parameter] | Sequence[ast.Field],
    arguments: tuple[ast.Argument, ...],
    declared: Span | None,
) -> Matches:
    """Match arguments with parameters or fields, and report arguments that match none."""
    by_name: dict[str, ast.Parameter | ast.Field] = {receiver.name.text: receiver for receiver in receivers}
    names = tuple(by_name)
    values: dict[str, ast.Argument] = {}
    complete = True
    named = False
    for position, argument in enumerate(arguments):
        name = argument.name
        if name is None and named:
            free = tuple(other for other in names if other not in values)
            context.refuse(PositionalAfterNamed(argument.span, names=free), argument)
            complete = False
        elif name is None and position >= len(names):
            context.refuse(
                TooManyArguments(
                    argument.span, owner=owner, given=len(arguments), allowed=len(names), declared=declared
                ),
                *arguments[position:],
            )
            complete = False
            break
        elif name is None:
            values[names[position]] = argument
        else:
            named = True
            complete &= _by_name(context, owner, argument, name, by_name, values, declared)
    return Matches(values=values, complete=complete)


def _by_name(
    context: Context,
    owner: str,
    argument: ast.Argument,
    name: ast.Identifier,
    receivers: dict[str, ast.Parameter | ast.Field],
    values: dict[str, ast.Argument],
    declared: Span | None,
) -> bool:
    receiver = receivers.get(name.text)
    if receiver is None:
        suggestion = context.speller.nearest(name.text, (other for other in receivers if other not in values))
        refused = UnknownArgument(
            name.span, owner=owner, name=name.text, options=tuple(receivers), suggestion=suggestion, declared=declared
        )
        context.refuse(refused, argument)
        return False
    if isinstance(receiver, ast.Parameter):
        context.program.bindings[name] = receiver
    if name.text in values:
        context.refuse(RepeatedArgument(argument.span, name=name.text, first=values[name.text].span), argument)
        return False
    values[name.text] = argument
    return True


def report_missing(
    context: Context,
    owner: str,
    matches: Matches,
    needed: Sequence[str],
    place: ast.Node,
    example: str | None,
    declared: Span | None,
) -> None:
    """Report the names without an argument, in one diagnostic."""
    missing = tuple(name for name in needed if name not in matches.values)
    if missing and matches.complete:
        context.refuse(
            MissingArgument(place.span, owner=owner, names=missing, example=example, declared=declared), place
        )
