"""Constant propagation: parameters with the same value in all instances of a class, variables that are never written,
and what follows from them.

Only process classes are changed; control laws and bodies in other languages keep the names of their parameters.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, TypeAlias, TypeGuard, TypeVar

from cspdiag.base.record import replaced
from cspdiag.network.ir import actions as ir
from cspdiag.network.ir.equations import SubmodelEquation
from cspdiag.network.ir.everywhere import rewritten
from cspdiag.network.ir.expressions import (
    Expression,
    LiteralValue,
    ParameterValue,
    SignalValue,
    Typed,
    Value,
    VariableValue,
)
from cspdiag.network.ir.network import ConstantEnd, InstanceOf, Instantiation, Network, ProcessClass, SubmodelClass
from cspdiag.network.ir.walk import channels_written, parts
from cspdiag.optimize.changes import changed, in_sequence
from cspdiag.optimize.constants.folding import folded, is_literal
from cspdiag.optimize.constants.turns import folded_alike
from cspdiag.optimize.dead.broadcasts import ends_at, possible_broadcasts

T = TypeVar("T")

Literals: TypeAlias = "dict[str, LiteralValue]"
Known: TypeAlias = "LiteralValue | ParameterValue | SignalValue"
Rewriting: TypeAlias = "Callable[[ir.Action, Callable[[Any], Any]], ir.Action]"
"""Applies a change to every record in an action, innermost first."""
Outputs: TypeAlias = "Mapping[str, set[str]]"
"""The outputs of each class."""


def fold_constants(network: Network) -> Network:
    """The network with constants propagated, parameters removed that are no longer needed, and constant conditions
    decided.
    """
    return _folded(network, rewritten)


def fold_constants_alike(network: Network) -> Network:
    """The same for targets that have loops: steps that differ only in numbers that count still do afterwards."""
    return _folded(network, folded_alike)


def _folded(network: Network, in_body: Rewriting) -> Network:
    classes = {entry.name: entry for entry in network.classes}
    given: dict[str, Literals | None] = {network.top: _arguments_of_top(network)}
    outputs = {name: {port.name for port in entry.ports if port.direction == "out"} for name, entry in classes.items()}
    results: dict[str, ProcessClass | SubmodelClass] = {}
    for entry in reversed(network.classes):
        if isinstance(entry, ProcessClass) and entry.external is None:
            folded_class = _class(entry, given.get(entry.name) or {}, outputs, in_body)
            for instance in folded_class.instances:
                _keep_common_arguments(given, instance)
            results[entry.name] = folded_class
        else:
            results[entry.name] = entry
    removed = {
        name: frozenset(given.get(name) or {})
        for name, entry in classes.items()
        if isinstance(entry, ProcessClass) and entry.external is None
    }
    return replaced(
        network,
        classes=tuple(_without_parameters(results[entry.name], removed) for entry in network.classes),
        arguments=tuple(item for item in network.arguments if item[0] not in removed[network.top]),
        instances=tuple(_without_arguments(item, removed) for item in network.instances),
    )


def _arguments_of_top(network: Network) -> Literals:
    parameters = {parameter.name: parameter for parameter in network.class_named(network.top).parameters}
    return {
        name: LiteralValue(type=parameters[name].type, span=parameters[name].span, value=value)
        for name, value in network.arguments
    }


def _keep_common_arguments(given: dict[str, Literals | None], instance: InstanceOf) -> None:
    """Take one more instance of a class into account: only arguments that are equal in all instances stay known."""
    found = {name: value for name, value in instance.arguments if isinstance(value, LiteralValue)}
    known = given.get(instance.class_name)
    if known is None:
        given[instance.class_name] = found
        return
    for name in list(known):
        if name not in found or not _same(known[name].value, found[name].value):
            del known[name]


def _same(one: Value, other: Value) -> bool:
    """Whether two values are equal to the last bit: -0.0 is not 0.0, and True is not 1."""
    return repr(one) == repr(other)


def _class(entry: ProcessClass, parameters: Literals, outputs: Outputs, in_body: Rewriting) -> ProcessClass:
    """The class with known values propagated, repeatedly as long as more values become known."""
    broadcasts = possible_broadcasts(entry)
    while True:
        known = dict(parameters)
        signals = _known_signals(entry)
        constants = {item.name for item in entry.constants if item.name in signals}
        variables = _constant_variables(entry, outputs)
        fold = _folding(known, signals, variables)
        result = replaced(
            entry,
            constants=tuple(rewritten(item, fold) for item in entry.constants if item.name not in constants),
            states=tuple(rewritten(item, fold) for item in entry.states),
            channels=tuple(rewritten(item, fold) for item in entry.channels),
            instances=tuple([_with_known_values(instance, fold) for instance in entry.instances]),
            ports=tuple(rewritten(item, fold) for item in entry.ports),
            body=None if entry.body is None else in_body(entry.body, _folding_and_deciding(fold, broadcasts)),
        )
        if result == entry:
            return result
        entry = result


def _with_known_values(instance: InstanceOf, fold: Callable[[Any], Any]) -> InstanceOf:
    """The instance with its arguments and the defaults of its inputs folded."""
    has_defaults = any(isinstance(connection.attachment, ConstantEnd) for connection in instance.connections)
    if not (instance.arguments or has_defaults):
        return instance
    return changed(
        instance,
        arguments=rewritten(instance.arguments, fold),
        connections=rewritten(instance.connections, fold) if has_defaults else instance.connections,
    )


def _known_signals(entry: ProcessClass) -> dict[str, Known]:
    """Constants of the class with a literal value, and signals of laws that always equal one literal, or always another
    signal.

    A signal that equals the present value of a state does not count: the state changes before the outputs are written.
    """
    found: dict[str, Expression | None] = {constant.name: constant.value for constant in entry.constants}
    states = {state.name for state in entry.states}
    for part in parts(entry.body):
        if isinstance(part, ir.RunLaw):
            for equation in (*part.equations, *part.derivative_equations):
                if isinstance(equation, SubmodelEquation):
                    other = found.setdefault(equation.name, equation.value)
                    same = other is equation.value or repr(other) == repr(equation.value)
                    found[equation.name] = equation.value if same else None
        elif isinstance(part, ir.InputRead):
            found[part.name] = None

    known = {name: value for name, value in found.items() if _is_known(value, states)}
    return {name: _resolved(value, known) for name, value in known.items()}


def _resolved(value: Known, known: Mapping[str, Known]) -> Known:
    """The last signal or value in a chain of equal signals: those in between may be removed before they are used."""
    while isinstance(value, SignalValue) and value.name in known:
        value = known[value.name]
    return value


def _is_known(value: Expression | None, states: set[str]) -> TypeGuard[Known]:
    return isinstance(value, LiteralValue | ParameterValue) or (
        isinstance(value, SignalValue) and value.name not in states
    )


def _constant_variables(entry: ProcessClass, outputs: Outputs) -> Literals:
    """Variables that keep their initial value."""
    known = {
        channel.name: channel.initial
        for channel in entry.channels
        if channel.kind == "var" and isinstance(channel.initial, LiteralValue)
    }
    if known:
        for name in _written(entry, outputs):
            known.pop(name, None)
    return known


def _written(entry: ProcessClass, outputs: Outputs) -> set[str]:
    """Channels that the class or an instance in it may write."""
    found = set(channels_written(entry.body))
    for instance in entry.instances:
        written = outputs[instance.class_name]
        for connection in instance.connections:
            if isinstance(connection.attachment, ir.ChannelEnd) and connection.port in written:
                found.add(connection.attachment.channel)
    return found


def _folding(
    parameters: Mapping[str, Known], signals: Mapping[str, Known], variables: Mapping[str, Known]
) -> Callable[[Any], Any]:
    names: dict[type, tuple[str, Mapping[str, Known]]] = {
        ParameterValue: ("name", parameters),
        SignalValue: ("name", signals),
        VariableValue: ("channel", variables),
    }

    def fold(item: Any) -> Any:
        kind = names.get(type(item))
        if kind is not None:
            attribute, known = kind
            value = known.get(getattr(item, attribute))
            return item if value is None else replaced(value, type=item.type, span=item.span)
        return folded(item) if isinstance(item, Typed) else item  # type: ignore[arg-type]

    return fold


def _folding_and_deciding(fold: Callable[[Any], Any], broadcasts: frozenset[str]) -> Callable[[Any], Any]:
    def change(item: Any) -> Any:
        result = _decided(fold(item))
        if result is not item and not ends_at(item, broadcasts) <= ends_at(result, broadcasts):
            return fold(item)
        return result

    return change


def _decided(item: Any) -> Any:
    """An action without conditions that are always true or always false."""
    match item:
        case ir.IfElse(condition=LiteralValue(value=bool(value))):
            return item.then if value else item.otherwise
        case ir.WhileLoop(condition=LiteralValue(value=False)):
            return ir.SkipStep(span=item.span)
        case ir.WhileLoop(condition=LiteralValue(value=True)):
            return ir.Repeat(span=item.span, body=item.body, until=None)
        case ir.Repeat(until=LiteralValue(value=True)):
            return item.body
        case ir.Repeat(until=LiteralValue(value=False)):
            return changed(item, until=None)
        case ir.InterruptOn(branch=ir.Branch(condition=LiteralValue(value=False))):
            return item.body
        case ir.InterruptOn(branch=ir.Branch(condition=LiteralValue(value=True)) as branch):
            return changed(item, branch=changed(branch, condition=None))
        case ir.Choice():
            return _choice(item)
        case ir.SequentialSteps():
            return in_sequence(item.steps, item) if any(map(_opens, item.steps)) else item
        case _:  # No other part has a condition.
            return item


def _opens(step: ir.Action) -> bool:
    return isinstance(step, ir.SequentialSteps | ir.SkipStep)


def _choice(choice: ir.Choice) -> ir.Choice:
    """The alternative without branches that can never be chosen.

    If only one branch remains it keeps its condition: without one the alternative would be a plain read or write, which
    is served before alternatives.
    """
    branches = [branch for branch in choice.branches if not is_literal(branch.condition, False)]
    if not branches:
        return choice
    if len(branches) > 1:
        branches = [changed(b, condition=None) if is_literal(b.condition, True) else b for b in branches]
    elif len(choice.branches) > 1 and branches[0].condition is None:
        return choice
    same = all(new is old for new, old in zip(branches, choice.branches, strict=False))
    return choice if same and len(branches) == len(choice.branches) else replaced(choice, branches=tuple(branches))


def _without_parameters(
    entry: ProcessClass | SubmodelClass, removed: Mapping[str, frozenset[str]]
) -> ProcessClass | SubmodelClass:
    if isinstance(entry, SubmodelClass) or entry.external is not None:
        return entry
    own = removed[entry.name]
    return replaced(
        entry,
        parameters=tuple(parameter for parameter in entry.parameters if parameter.name not in own),
        instances=tuple(
            changed(instance, arguments=_left(instance.arguments, removed.get(instance.class_name)))
            for instance in entry.instances
        ),
    )


def _without_arguments(instance: Instantiation, removed: Mapping[str, frozenset[str]]) -> Instantiation:
    return changed(instance, arguments=_left(instance.arguments, removed.get(instance.class_name)))


def _left(arguments: tuple[tuple[str, T], ...], removed: frozenset[str] | None) -> tuple[tuple[str, T], ...]:
    """The arguments for parameters that are not removed."""
    return tuple([item for item in arguments if item[0] not in removed]) if removed else arguments
