"""Which exceptions reach the handlers of a composition, and which leave it."""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeAlias

from cspdiag.base.record import node
from cspdiag.network.flow.code import Abandon, Call, Code, Instruction, Raise
from cspdiag.network.ir.actions import CatchException

Exceptions: TypeAlias = frozenset[str] | None
"""Names of exceptions; None: any."""

NO_EXCEPTIONS: Exceptions = frozenset()


@node
class Watched:
    """The exceptions of the part that a ``catch`` watches: those that it raises, and those that are caught
    inside it.
    """

    catch: CatchException
    raised: Exceptions
    caught_inside: frozenset[str]


def exceptions_of(
    code: Code,
    of_instance: Callable[[str], Exceptions],
    of_step: Callable[[Instruction], Exceptions] = lambda _: NO_EXCEPTIONS,
) -> tuple[Exceptions, list[Watched]]:
    """The exceptions that may leave a composition, and those that reach its handlers.

    ``of_instance`` returns those that leave the instance with a name, ``of_step`` those of an instruction other than
    ``raise``.
    """
    arriving: dict[int | None, Exceptions] = {None: NO_EXCEPTIONS}
    caught: dict[int | None, frozenset[str]] = {}
    found = []
    # The end of a watched part comes after everything in it, and before the end of the part around it.
    for index, instruction in enumerate(code.instructions):
        around = code.abandoned[index]
        match instruction:
            case Raise():
                leaving: Exceptions = frozenset({instruction.step.exception})
            case Call():
                leaving = of_instance(instruction.step.instance)
            case _:  # ``of_step`` decides about every other instruction.
                leaving = of_step(instruction)
        if isinstance(instruction, Abandon):
            leaving, inside = arriving.pop(index, NO_EXCEPTIONS), caught.pop(index, frozenset())
            if isinstance(instruction.step, CatchException):
                found.append(Watched(catch=instruction.step, raised=leaving, caught_inside=inside))
                exception = instruction.step.exception
                leaving, inside = None if leaving is None else leaving - {exception}, inside | {exception}
            caught[around] = caught.get(around, frozenset()) | inside
        known = arriving.get(around, NO_EXCEPTIONS)
        arriving[around] = None if known is None or leaving is None else known | leaving
    return arriving[None], found
