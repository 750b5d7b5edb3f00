"""The reading ends and alternatives of a process: in which order they come to be, and whose they are."""

from __future__ import annotations

from collections.abc import Iterator

from cspdiag.network.ir import actions as act


def ends_read(action: act.Action) -> Iterator[act.End]:
    """The ends that readers and guards of an action read, in text order.

    «Parties, channels and guards», *the order in which they stand in the program*
    """
    match action:
        case act.ReadValue(source=source):
            yield source
        case act.ReadInputs(reads=reads):
            yield from (read.source for read in reads)
        case act.Choice(branches=branches):
            for branch in branches:
                yield from _ends_of_branch(branch)
        case act.InterruptOn():
            yield from ends_read(action.body)
            yield from _ends_of_branch(action.branch)
        case _:
            for inner in _inside(action):
                yield from ends_read(inner)


def _ends_of_branch(branch: act.Branch) -> Iterator[act.End]:
    if isinstance(branch.event, act.InputEvent | act.ReadyEvent):
        yield branch.event.source
    yield from ends_read(branch.body)


def choices(action: act.Action) -> Iterator[act.Choice]:
    """The alternatives in an action, in text order.

    «Parties, channels and guards», *the order in which they stand in the program*
    """
    match action:
        case act.Choice(branches=branches):
            yield action
            for branch in branches:
                yield from choices(branch.body)
        case act.InterruptOn():
            yield from choices(action.body)
            yield from choices(action.branch.body)
        case _:
            for inner in _inside(action):
                yield from choices(inner)


def flattened_ends(action: act.Action) -> Iterator[tuple[act.End, str]]:
    """The ends of processes that were flattened into this one, with the path of each process.

    Those of outer ones first. «Time»: whose books they are
    """
    if isinstance(action, act.ProcessScope):
        yield from ((end, action.instance) for end in action.ends)
    match action:
        case act.Choice(branches=branches):
            for branch in branches:
                yield from flattened_ends(branch.body)
        case act.InterruptOn():
            yield from flattened_ends(action.body)
            yield from flattened_ends(action.branch.body)
        case _:
            for inner in _inside(action):
                yield from flattened_ends(inner)


def _inside(action: act.Action) -> tuple[act.Action, ...]:
    match action:
        case act.SequentialSteps(steps=steps) | act.ParallelSteps(steps=steps):
            return steps
        case act.IfElse():
            return (action.then, action.otherwise)
        case act.CatchException():
            return (action.body, action.handler)
        case act.Repeat(body=body) | act.WhileLoop(body=body) | act.CountedLoop(body=body):
            return (body,)
        case act.Group(body=body) | act.ProcessScope(body=body):
            return (body,)
        case _:
            return ()
