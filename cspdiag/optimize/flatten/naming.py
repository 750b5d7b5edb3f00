"""Renaming of parts that are moved into the class around them: names get a prefix, parameters are replaced by their
values.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TypeVar

from cspdiag.base import Span
from cspdiag.base.record import replaced
from cspdiag.network.ir.equations import ExternalCall, SubmodelEquation
from cspdiag.network.ir.expressions import (
    Expression,
    LiteralValue,
    ParameterValue,
    SignalValue,
    TunableValue,
    VariableValue,
)
from cspdiag.network.ir.network import ClassParameter, InstanceOf
from cspdiag.optimize.changes import with_parts

T = TypeVar("T")


def parameter_constants(
    instance: InstanceOf, parameters: tuple[ClassParameter, ...]
) -> tuple[dict[str, Expression], tuple[SubmodelEquation, ...]]:
    """The expression that replaces each parameter of an instance, and the constants that this adds to the enclosing
    class.

    Literals and parameters of the enclosing class are used directly; anything else is computed once, as the constant
    ``servo.sample``.
    """
    spans = {parameter.name: parameter for parameter in parameters}
    values: dict[str, Expression] = {}
    constants = []
    for name, value in instance.arguments:
        if isinstance(value, LiteralValue | ParameterValue | TunableValue):
            values[name] = value
        else:
            constant = _constant(f"{instance.name}.{name}", value, instance.span, spans[name].doc)
            constants.append(constant)
            values[name] = SignalValue(type=value.type, name=constant.name)
    return values, tuple(constants)


def _constant(name: str, value: Expression, span: Span, doc: str | None) -> SubmodelEquation:
    return SubmodelEquation(name=name, doc=doc, span=span, type=value.type, value=value)


def renamed(item: T, prefix: str, values: Mapping[str, Expression], signals: Mapping[str, Expression] = {}) -> T:
    """Expressions, alone or in records or tuples, with the prefix added to their signals and variables, and ``values``
    in place of parameters.

    ``signals`` replace the signals of these names. Names of equations and channels outside expressions stay the same.
    """

    return with_parts(item, lambda part: renamed_part(part, prefix, values, signals))


def renamed_part(
    part: object, prefix: str, values: Mapping[str, Expression], signals: Mapping[str, Expression] = {}
) -> Expression | None:
    """As ``renamed``, for a value that has a name; None for any other part."""
    match part:
        case ParameterValue(name=name) | TunableValue(name=name):
            return values[name]
        case SignalValue(name=name):
            return signals[name] if name in signals else replaced(part, name=f"{prefix}.{name}")
        case VariableValue(channel=channel):
            return replaced(part, channel=f"{prefix}.{channel}")
        case _:  # Any other part has no name.
            return None


def renamed_equation(
    equation: SubmodelEquation | ExternalCall,
    prefix: str,
    values: Mapping[str, Expression],
    signals: Mapping[str, Expression] = {},
) -> SubmodelEquation | ExternalCall:
    """An equation renamed, including its own name."""
    inner = renamed(equation, prefix, values, signals)
    name = f"{prefix}.{equation.name}"
    if isinstance(inner, ExternalCall):
        outputs = tuple((port, f"{prefix}.{local}", kind) for port, local, kind in inner.outputs)
        return replaced(inner, name=name, outputs=outputs)
    return replaced(inner, name=name)
