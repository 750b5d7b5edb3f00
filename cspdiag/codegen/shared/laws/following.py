"""What an inlined law computes from parameters of the program alone: once, and again after a change of one of them."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from cspdiag.base.record import record, replaced
from cspdiag.network.ir.actions import RunLaw
from cspdiag.network.ir.equations import ExternalCall, SubmodelEquation
from cspdiag.network.ir.everywhere import rewritten
from cspdiag.network.ir.expression_walk import operands, walk
from cspdiag.network.ir.expressions import (
    Expression,
    FieldValue,
    ParameterValue,
    PresentTime,
    SignalValue,
    TunableValue,
    Typed,
    VariableValue,
)
from cspdiag.network.ir.faults import may_fault
from cspdiag.network.ir.walk import inner_parts, parts

_MOST_NAMES = 3


@record
class Following:
    """``equations`` and then ``terms`` follow the ``parameters`` of the program, and constants of the class, alone;
    ``law`` is what is left of the law, which reads them.

    Computed in that order, they raise the faults that the law raised, each before the same others.
    """

    parameters: tuple[TunableValue, ...]
    equations: tuple[SubmodelEquation, ...]
    terms: tuple[SubmodelEquation, ...]
    """The largest parts of other expressions that follow. Their names, which end in a space and a number, are no names
    of the program.
    """
    law: RunLaw


def is_looked_up(value: Expression) -> bool:
    """Whether a value is a parameter, or a field of one: there is nothing to compute."""
    return all(isinstance(part, TunableValue | FieldValue | ParameterValue) for part in walk(value))


def following_apart(
    law: RunLaw, constants: frozenset[str], is_term: Callable[[Expression], bool] = lambda _: True
) -> Following:
    """What of a law follows parameters of the program, apart from the rest. ``constants`` are those of the class, and
    ``is_term`` says which parts of expressions that follow are worth a name.
    """
    parameters = tuple(dict.fromkeys(part for part in parts(law) if isinstance(part, TunableValue)))
    if not parameters:
        return Following((), (), (), law)
    known = set(constants)
    equations: list[SubmodelEquation] = []
    others: list[SubmodelEquation | ExternalCall] = []
    may_have_failed = False
    for item in law.equations:
        fails = isinstance(item, ExternalCall) or may_fault(item.value)
        if isinstance(item, ExternalCall) or not _follows(item.value, known) or (fails and may_have_failed):
            others.append(item)
            may_have_failed = may_have_failed or fails
        else:
            equations.append(item)
            known.add(item.name)
    rest = replaced(law, equations=tuple(others))
    computed = frozenset(item.name for item in equations)
    terms: list[SubmodelEquation] = []
    parts_that_follow = filter(is_term, _largest(rest, known, computed))
    for number, part in enumerate(sorted(parts_that_follow, key=_size, reverse=True)):
        name = f"{law.law} {_described(part)} {number}"
        term = SubmodelEquation(name=name, span=law.span, type=part.type, value=part)
        changed = _with_signal(rest, term)
        if changed is not rest:
            terms.append(term)
            rest = changed
    return Following(parameters, tuple(equations), tuple(terms), rest)


def _follows(value: Expression, known: set[str]) -> bool:
    """Whether a value depends on nothing but parameters and ``known`` signals."""
    for part in walk(value):
        if isinstance(part, VariableValue | PresentTime) or (isinstance(part, SignalValue) and part.name not in known):
            return False
    return True


def _largest(item: object, known: set[str], computed: frozenset[str]) -> Iterator[Expression]:
    """The largest expressions that follow parameters, or signals ``computed`` from them, and cannot fail."""
    if isinstance(item, Typed):
        value: Expression = item  # type: ignore[assignment]
        if isinstance(value, SignalValue):
            return
        moved = any(
            isinstance(part, TunableValue) or (isinstance(part, SignalValue) and part.name in computed)
            for part in walk(value)
        )
        if not moved:
            return
        if _follows(value, known) and not may_fault(value):
            yield value
            return
    for part in inner_parts(item):
        yield from _largest(part, known, computed)


def _size(value: Expression) -> int:
    return sum(1 for _ in walk(value))


def _described(value: Expression) -> str:
    """The names in an expression, such as ``gains_friction`` or ``tauD_kp``."""
    names = list(dict.fromkeys(_names(value)))
    return "_".join(names) if len(names) <= _MOST_NAMES else "term"


def _names(value: Expression) -> Iterator[str]:
    for operand in operands(value):
        yield from _names(operand)
    match value:
        case TunableValue(name=name) | ParameterValue(name=name) | FieldValue(field=name):
            yield name
        case SignalValue(name=name):
            yield name.rpartition(".")[2]
        case _:  # Nothing else has a name that describes it.
            pass


def _with_signal(law: RunLaw, term: SubmodelEquation) -> RunLaw:
    """The law with a signal for each expression that is a term, to the sign of a zero."""
    old, shown = term.value, repr(term.value)
    signal = SignalValue(type=term.type, name=term.name)
    return rewritten(law, lambda part: signal if part == old and repr(part) == shown else part)
