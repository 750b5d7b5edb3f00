"""Names that nobody uses, and channels that are looked at as if they kept a value."""

from __future__ import annotations

from collections.abc import Iterator, Set
from typing import assert_never

from cspdiag.base import Report
from cspdiag.network.checks.agreement import Agreement
from cspdiag.network.diagnostics.channels import ChannelReadAsVariable
from cspdiag.network.diagnostics.usage import PortUnused, VariableUnused
from cspdiag.network.infer.ends import all_actions
from cspdiag.network.ir.actions import (
    AfterEvent,
    AssignValue,
    Branch,
    CatchException,
    Choice,
    CoreAction,
    CountedLoop,
    Group,
    IfElse,
    InputEvent,
    InterruptOn,
    OutputEvent,
    ParallelSteps,
    RaiseException,
    ReadValue,
    ReadyEvent,
    Repeat,
    ResetInstance,
    RunInstance,
    SequentialSteps,
    SkipEvent,
    SkipStep,
    StopStep,
    WaitStep,
    WhileLoop,
    WriteValue,
)
from cspdiag.network.ir.expressions import Expression
from cspdiag.network.relations import UsesByKey, variables_read
from cspdiag.network.shapes import Shape, attached_key
from cspdiag.syntax import ast


def check_usage(
    shape: Shape,
    uses: UsesByKey,
    report: Report,
    agreement: Agreement,
    *,
    named: Set[ast.Node],
    is_specification: bool,
) -> None:
    """Find ports and variables of a process that nobody uses; refuse conditions on channels that keep no value.

    A port that a specification does not use is one at which it allows nothing. ``named`` are the declarations that are
    named anywhere, be it in a part that is repeated no times in this shape.
    """
    if shape.body is None or shape.incomplete:
        return
    _check_values(shape, shape.body, report)
    if shape.has_refused_relationship:
        return
    for port, _, key in shape.port_elements():
        if is_specification:
            continue
        if key in uses or key in shape.port_spans:
            agreement.refuted(PortUnused, port.span, key)
        else:
            unused = PortUnused(span=port.span, port=key, process=shape.name, direction=port.direction)
            agreement.found(unused, key)
    connected = {attached_key(a) for instance in shape.instances.values() for a in instance.attachments.values()}
    for channel in shape.channels.values():
        use = uses.get(channel.name)
        if isinstance(channel.declaration, ast.Connection):
            continue
        is_one_of_several = bool(channel.replicators)
        if use is None and channel.name not in connected and (is_one_of_several or channel.declaration not in named):
            agreement.found(VariableUnused(span=channel.span, name=channel.name), channel.name)
        else:
            agreement.refuted(VariableUnused, channel.span, channel.name)


def _check_values(shape: Shape, body: CoreAction, report: Report) -> None:
    for expression in expressions_in(body):
        for value in variables_read(expression):
            channel = shape.channels.get(value.channel)
            if channel is not None and channel.kind != "var" and not channel.excused and value.span is not None:
                refused = ChannelReadAsVariable(
                    span=value.span, channel=channel.name, kind=channel.kind, declared=channel.span
                )
                report.add(refused)


def expressions_in(body: CoreAction) -> Iterator[Expression]:
    """The expressions of a composition: values written, conditions, durations and indexes."""
    for action in all_actions(body):
        match action:
            case ReadValue():
                yield from action.target.indexes
            case WriteValue():
                yield action.value
            case AssignValue():
                yield action.value
                yield from action.target.indexes
            case WaitStep():
                yield action.duration
            case WhileLoop() | IfElse():
                yield action.condition
            case Repeat():
                if action.until is not None:
                    yield action.until
            case Choice():
                for branch in action.branches:
                    yield from _expressions_of_guard(branch)
            case InterruptOn():
                yield from _expressions_of_guard(action.branch)
            case (
                RunInstance() | SkipStep() | StopStep() | ResetInstance() | RaiseException() | SequentialSteps()
                | ParallelSteps() | CountedLoop() | CatchException() | Group()
            ):  # fmt: skip
                pass
            case _:
                assert_never(action)


def _expressions_of_guard(branch: Branch[CoreAction]) -> Iterator[Expression]:
    if branch.condition is not None:
        yield branch.condition
    match branch.event:
        case InputEvent():
            yield from branch.event.target.indexes
        case OutputEvent():
            yield branch.event.value
        case AfterEvent():
            yield branch.event.duration
        case ReadyEvent() | SkipEvent():
            pass
        case _:
            assert_never(branch.event)
