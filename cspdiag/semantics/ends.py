"""The reading ends and alternatives of a process: the order in which they are created, and the processes they belong
to.
"""

from __future__ import annotations

from collections.abc import Iterator

from cspdiag.network.ir import actions as act
from cspdiag.network.ir.walk import actions_inside, all_actions


def ends_read(action: act.Action) -> Iterator[act.End]:
    """The ends that readers and guards of an action read, in text order.

    «Parties, channels and guards», *program order*
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
        case _:  # Any other action reads what its parts read.
            for inner in actions_inside(action):
                yield from ends_read(inner)


def _ends_of_branch(branch: act.Branch) -> Iterator[act.End]:
    if isinstance(branch.event, act.InputEvent | act.ReadyEvent):
        yield branch.event.source
    yield from ends_read(branch.body)


def choices(action: act.Action) -> Iterator[act.Choice]:
    """The alternatives in an action, in text order.

    «Parties, channels and guards», *program order*
    """
    return (part for part in all_actions(action) if isinstance(part, act.Choice))


def flattened_ends(action: act.Action) -> Iterator[tuple[act.End, str]]:
    """The ends of processes that were flattened into this one, with the path of each process, whose sessions they have.
    «Time»

    Ends of outer processes come first.
    """
    scopes = (part for part in all_actions(action) if isinstance(part, act.ProcessScope))
    return ((end, scope.instance) for scope in scopes for end in scope.ends)
