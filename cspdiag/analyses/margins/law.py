"""A flattened submodel as a linear system about an operating point."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, assert_never

from cspdiag.analyses.margins.linear import Linearization, NotLinearError, Number, Simplification
from cspdiag.base.record import record
from cspdiag.model.types import (
    ArrayType,
    BoolType,
    EnumType,
    IntType,
    RealType,
    StructType,
    TextType,
    TimeType,
    Type,
    UnknownType,
)
from cspdiag.network.ir.equations import ExternalCall
from cspdiag.network.ir.network import SubmodelClass
from cspdiag.network.ir.zero import zero

if TYPE_CHECKING:
    import numpy

    Matrix = numpy.ndarray[tuple[int, ...], numpy.dtype[numpy.float64]]

Leaf = tuple[str, tuple[int, ...]]
"""A number within a state or a port: the name, and the indexes of it in arrays and structs."""

SETTLING_SAMPLES = 2
"""Samples after which whole numbers and truth values are assumed to be constant."""


@record
class LinearLaw:
    """A linear law, over the numbers within its states and inputs, in that order.

    ``next`` has a row for each discrete state, ``rates`` one for each continuous state (its derivative, per second),
    and ``outputs`` one for each number within an output. Discrete states come first. Constant terms at the operating
    point are omitted.
    """

    discrete: tuple[Leaf, ...]
    continuous: tuple[Leaf, ...]
    inputs: tuple[Leaf, ...]
    output_names: tuple[Leaf, ...]
    next: Matrix
    rates: Matrix
    outputs: Matrix
    simplifications: tuple[Simplification, ...]


def linearize(
    law: SubmodelClass, parameters: Mapping[str, Any], *, point: Mapping[str, Any] | None = None, time: float = 0.0
) -> LinearLaw:
    """The law, linearized at its initial states and zero inputs, except for the states and inputs in ``point``.

    Raises NotLinearError if it is computed in another language or has no slope there.
    """
    import numpy

    if law.external is not None:
        raise NotLinearError(
            f"`{law.definition}` is written in {law.external.language}, which cannot be linearized", law.external.span
        )
    settled: dict[str, Any] = {}
    for _ in range(SETTLING_SAMPLES):
        layout = _Layout(law, parameters, {**settled, **(point or {})}, time)
        evaluation = layout.evaluation
        following = _following(law, evaluation, layout)
        settled = {
            state.name: following[state.name]
            for state in law.states
            if state.name in following and not _has_numbers(state.type)
        }
    layout = _Layout(law, parameters, {**settled, **(point or {})}, time)
    evaluation = layout.evaluation
    _equations(law, evaluation)
    outputs = [port for port in law.ports if port.direction == "out"]
    output_leaves: list[Leaf] = []
    rows: list[Any] = []
    for port in outputs:
        names = [port.name] if port.size is None else [f"{port.name}[{k}]" for k in range(port.size)]
        for name in names:
            for indexes, number in _numbers(evaluation.signals[name], port.type):
                output_leaves.append((name, indexes))
                rows.append(evaluation.slope(number))
    following = {name: evaluation.value(value) for name, value in law.next_values}
    kinds = {state.name: state.type for state in law.states}
    next_rows = [
        evaluation.slope(number)
        for name in _named(layout.discrete)
        for _, number in _numbers(following[name], kinds[name])
    ]
    for equation in law.derivative_equations:
        evaluation.signals[equation.name] = evaluation.value(equation.value)
    derived = {name: evaluation.value(value) for name, value in law.derivatives}
    rate_rows = [
        evaluation.slope(number)
        for name in _named(layout.continuous)
        for _, number in _numbers(derived[name], kinds[name])
    ]

    def matrix(found: list[Any]) -> Matrix:
        return numpy.array(found, dtype=float).reshape(len(found), evaluation.size)

    all_rows = (*next_rows, *rate_rows, *rows)
    if not all(numpy.isfinite(row).all() for row in all_rows):
        raise NotLinearError(f"`{law.definition}` has no slope at the operating point", law.span)
    return LinearLaw(
        tuple(layout.discrete),
        tuple(layout.continuous),
        tuple(layout.inputs),
        tuple(output_leaves),
        matrix(next_rows),
        matrix(rate_rows),
        matrix(rows),
        tuple(_once(evaluation.simplifications)),
    )


def _once(found: list[Simplification]) -> list[Simplification]:
    """Each simplification once: equations are evaluated for outputs and again for derivatives."""
    kept: dict[tuple[str, Any, bytes], Simplification] = {}
    for part in found:
        kept.setdefault((part.what, part.span, part.depends.tobytes()), part)
    return list(kept.values())


def _equations(law: SubmodelClass, evaluation: Linearization) -> None:
    for equation in law.equations:
        if not isinstance(equation, ExternalCall):
            evaluation.signals[equation.name] = evaluation.value(equation.value)
            continue
        for name, given in equation.inputs:
            if evaluation.slope(evaluation.value(given)).any():
                language = equation.external.language
                raise NotLinearError(
                    f"`{equation.name}` depends on `{name}`, but is written in {language}, which cannot be linearized",
                    equation.span,
                )
        # A call that depends on no state or input counts as a constant, whatever its value.
        evaluation.signals |= {local: zero(kind) for _, local, kind in equation.outputs}


def _following(law: SubmodelClass, evaluation: Linearization, layout: _Layout) -> dict[str, Any]:
    _equations(law, evaluation)
    return {name: evaluation.value(value) for name, value in law.next_values}


class _Layout:
    """Arranges the numbers within states and inputs in one vector, with their values at the operating point."""

    def __init__(
        self, law: SubmodelClass, parameters: Mapping[str, Any], point: Mapping[str, Any], time: float
    ) -> None:
        import numpy

        plain = Linearization(parameters, 0, time)
        for constant in law.constants:
            plain.signals[constant.name] = plain.value(constant.value)
        values = {state.name: point.get(state.name, plain.value(state.initial)) for state in law.states}
        self.discrete: list[Leaf] = []
        self.continuous: list[Leaf] = []
        self.inputs: list[Leaf] = []
        for state in law.states:
            target = self.continuous if state.continuous else self.discrete
            target += [(state.name, indexes) for indexes, _ in _numbers(values[state.name], state.type)]
        starts: dict[str, Any] = {}
        for port in law.ports:
            if port.direction == "in":
                names = [port.name] if port.size is None else [f"{port.name}[{k}]" for k in range(port.size)]
                for name in names:
                    starts[name] = point.get(name, zero(port.type))
                    self.inputs += [(name, indexes) for indexes, _ in _numbers(starts[name], port.type)]
        order = {leaf: k for k, leaf in enumerate((*self.discrete, *self.continuous, *self.inputs))}
        self.evaluation = Linearization(parameters, len(order), time)
        self.evaluation.signals |= plain.signals
        identity = numpy.eye(len(order))

        def with_slopes(name: str, indexes: tuple[int, ...], value: Any, kind: Type) -> Any:
            match kind:
                case RealType():
                    return Number(float(value), identity[order[name, indexes]])
                case ArrayType():
                    return tuple(with_slopes(name, (*indexes, k), part, kind.element) for k, part in enumerate(value))
                case StructType():
                    return tuple(
                        with_slopes(name, (*indexes, k), part, inner)
                        for k, (part, (_, inner)) in enumerate(zip(value, kind.fields, strict=True))
                    )
                case BoolType() | IntType() | TimeType() | TextType() | EnumType() | UnknownType():
                    return value
                case _:
                    assert_never(kind)

        for state in law.states:
            self.evaluation.signals[state.name] = with_slopes(state.name, (), values[state.name], state.type)
        for port in law.ports:
            if port.direction == "in":
                for name in [port.name] if port.size is None else [f"{port.name}[{k}]" for k in range(port.size)]:
                    self.evaluation.signals[name] = with_slopes(name, (), starts[name], port.type)


def _numbers(value: Any, kind: Type) -> Iterator[tuple[tuple[int, ...], Any]]:
    """The real numbers within a value, each with its indexes."""
    match kind:
        case RealType():
            yield (), value
        case ArrayType():
            for k, part in enumerate(value):
                for indexes, number in _numbers(part, kind.element):
                    yield (k, *indexes), number
        case StructType():
            for k, (part, (_, inner)) in enumerate(zip(value, kind.fields, strict=True)):
                for indexes, number in _numbers(part, inner):
                    yield (k, *indexes), number
        case BoolType() | IntType() | TimeType() | TextType() | EnumType() | UnknownType():
            return
        case _:
            assert_never(kind)


def leaves(kind: Type) -> list[tuple[int, ...]]:
    """The indexes of the real numbers within values of a type."""
    return [indexes for indexes, _ in _numbers(zero(kind), kind)]


def _has_numbers(kind: Type) -> bool:
    match kind:
        case RealType():
            return True
        case ArrayType():
            return _has_numbers(kind.element)
        case StructType():
            return any(_has_numbers(inner) for _, inner in kind.fields)
        case BoolType() | IntType() | TimeType() | TextType() | EnumType() | UnknownType():
            return False
        case _:
            assert_never(kind)


def _named(leaves: list[Leaf]) -> list[str]:
    """The names of the states or ports of some leaves, each once."""
    return list(dict.fromkeys(name for name, _ in leaves))
