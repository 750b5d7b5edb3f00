"""Makes parameters of the program of its constants and of the arguments of its instances, for a program that is
compiled once and then runs with different values.

What decides about sizes, connections or instants cannot be one (E0911), nor can what follows from something else: that
changes with it.
"""

from __future__ import annotations

from collections.abc import Container, Iterator, Mapping, Sequence
from typing import TypeAlias

from cspdiag.base import Report
from cspdiag.base.record import node, record, replaced
from cspdiag.model.constants.evaluate import evaluate
from cspdiag.model.program import Program, Value
from cspdiag.network.checks.fixed_values import FixedPlaces
from cspdiag.network.elaborate.definitions import arguments_of
from cspdiag.syntax import ast
from cspdiag.syntax.walk import instances_in, names, nodes

_Owner: TypeAlias = "ast.Instance | ast.EnvironmentDefinition | ast.ProcessDefinition"
"""What gives a parameter its value: with an argument, or with a default."""


@node
class Settable:
    """A constant, or an argument, that can become a parameter of the program. ``setting`` is its name for ``--set``."""

    setting: str
    constant: ast.Constant
    path: str = ""
    """Of an argument: where it is inside the outermost process."""
    owner: _Owner | None = None
    """What has the argument; None for a constant."""
    parameter: ast.Parameter | None = None


@record
class Choice:
    """What can be set before a run, and for what cannot the reason, by its name for ``--set``."""

    settable: tuple[Settable, ...]
    constants: Mapping[str, str]


def choice_of(
    program: Program, process: ast.ProcessDefinition, environment: ast.EnvironmentDefinition | None
) -> Choice:
    """What can be set in a program with this outermost process, in this environment."""
    fixed = FixedPlaces(program, checked=True)
    ports = program.scopes[process].ports
    constants, reasons = _constants(program, fixed, dict.fromkeys(ports, "a port has this name"))
    found = [Settable(setting=item.name.text, constant=replaced(item, tunable=True)) for item in constants]
    follows = {*constants, *program.tunable}
    for path, owner, parameter, value in _arguments(program, process, environment):
        is_taken = path.partition(".")[0] in {*program.definitions, *ports}
        setting = f"{process.name.text}.{path}" if is_taken else path
        reason = fixed.parameters(_definition_of(program, owner)).get(parameter)
        if reason is not None:
            reasons[setting] = reason
        elif not _depends(program, value, follows):
            own = ast.Constant(
                span=parameter.span,
                doc=parameter.doc,
                name=replaced(parameter.name, text=setting),
                type=parameter.type,
                value=value,
                tunable=True,
            )
            found.append(Settable(setting=setting, constant=own, path=path, owner=owner, parameter=parameter))
    return Choice(tuple(found), reasons)


def values_in(program: Program, environment: ast.EnvironmentDefinition) -> dict[str, Value]:
    """The values of arguments of the instances in an environment that depend on nothing that may change, by the names
    for settings. Setting them changes no number, but each is then one of its own.
    """
    fixed, found = FixedPlaces(program, checked=True), dict[str, Value]()
    for setting, owner, parameter, value in _of_instances(program, environment):
        if parameter not in fixed.parameters(_definition_of(program, owner)):
            known = None if _depends(program, value, program.tunable) else evaluate(program, value, {}, Report())
            if known is not None:
                found[setting] = known
    return found


def _constants(
    program: Program, fixed: FixedPlaces, refused: Mapping[str, str]
) -> tuple[list[ast.Constant], dict[str, str]]:
    """The constants that can be set, and the others with the reason; some names are ``refused`` with a reason."""
    every = list(program.constants)
    reasons = {item: refused[item.name.text] for item in every if item.name.text in refused}
    for definition in program.definitions.values():
        for expression, what in fixed.places(definition):
            for name in names((expression,)):
                symbol = program.bindings.get(name)
                if isinstance(symbol, ast.Constant):
                    reasons.setdefault(symbol, what)
    for item in reversed(every):
        if item in reasons:
            for other in _used(program, item.value):
                reasons.setdefault(other, reasons[item])
    chosen: list[ast.Constant] = []
    for item in every:
        if item not in reasons and not _depends(program, item.value, {*chosen, *program.tunable}):
            chosen.append(item)
    return chosen, {item.name.text: reason for item, reason in reasons.items() if item in program.constants}


def _used(program: Program, expression: ast.Expression) -> Iterator[ast.Constant]:
    for name in names((expression,)):
        symbol = program.bindings.get(name)
        if isinstance(symbol, ast.Constant):
            yield symbol


def _depends(program: Program, expression: ast.Expression, others: Container[object]) -> bool:
    """Whether an expression changes with one of these constants, directly or by way of others, or with where it is."""
    for name in names((expression,)):
        symbol = program.bindings.get(name)
        if isinstance(symbol, ast.Parameter | ast.Replicator) or symbol in others:
            return True
        if isinstance(symbol, ast.Constant) and _depends(program, symbol.value, others):
            return True
    return False


def _arguments(
    program: Program, process: ast.ProcessDefinition, environment: ast.EnvironmentDefinition | None
) -> Iterator[tuple[str, _Owner, ast.Parameter, ast.Expression]]:
    """The values of parameters: name, owner, parameter and value; of instances those that occur once."""
    given = {} if environment is None else dict(arguments_of(process.parameters, environment.arguments))
    for parameter in process.parameters:
        value = given.get(parameter, parameter.default)
        if value is not None:
            owner = environment if environment is not None and parameter in given else process
            yield parameter.name.text, owner, parameter, value
    yield from _of_instances(program, process)


def _of_instances(
    program: Program, root: ast.ProcessDefinition | ast.EnvironmentDefinition
) -> Iterator[tuple[str, ast.Instance, ast.Parameter, ast.Expression]]:
    often = _more_than_once(program, root)
    pending: list[tuple[str, ast.Definition]] = [("", root)]
    while pending:
        prefix, definition = pending.pop()
        for instance in instances_in(definition):
            callee = program.bindings.get(instance.definition)
            if instance.size is not None or not isinstance(callee, ast.ProcessDefinition | ast.SubmodelDefinition):
                continue
            path = f"{prefix}{instance.name.text}"
            given = dict(arguments_of(callee.parameters, instance.arguments))
            for parameter in callee.parameters:
                value = given.get(parameter, parameter.default)
                if value is not None:
                    yield f"{path}.{parameter.name.text}", instance, parameter, value
            if callee not in often:
                pending.append((f"{path}.", callee))


def _more_than_once(program: Program, root: ast.Definition) -> set[ast.Node]:
    """The definitions with several instances, or with one inside something that has several."""
    seen: set[ast.Node] = set()
    often: set[ast.Node] = set()
    pending: list[tuple[ast.Definition, bool]] = [(root, False)]
    while pending:
        definition, many = pending.pop()
        if definition in often:
            continue
        if many or definition in seen:
            many = True
            often.add(definition)
        seen.add(definition)
        for instance in instances_in(definition):
            callee = program.bindings.get(instance.definition)
            repeated = instance.size is not None or _is_repeated(definition, instance)
            if isinstance(callee, ast.ProcessDefinition | ast.SubmodelDefinition):
                pending.append((callee, many or repeated))
    return often


def _is_repeated(definition: ast.Definition, instance: ast.Instance) -> bool:
    blocks = (part for part in nodes(definition) if isinstance(part, ast.RepeatedDeclarations))
    return any(instance in nodes(*block.declarations) for block in blocks)


def _definition_of(program: Program, owner: _Owner) -> ast.ProcessDefinition | ast.SubmodelDefinition:
    match owner:
        case ast.Instance(definition=name) | ast.EnvironmentDefinition(process=name):
            callee = program.bindings.get(name)
            assert isinstance(callee, ast.ProcessDefinition | ast.SubmodelDefinition)
            return callee
        case ast.ProcessDefinition():
            return owner


def with_parameters(trees: Sequence[ast.SourceTree], settable: Sequence[Settable]) -> tuple[ast.SourceTree, ...]:
    """The trees in which these constants and arguments are parameters of the program."""
    by_owner: dict[ast.Node, list[Settable]] = {}
    for item in settable:
        if item.owner is not None:
            by_owner.setdefault(item.owner, []).append(item)
    constants = {(item.setting): item.constant for item in settable if item.owner is None}
    added = tuple(item.constant for item in settable if item.owner is not None)

    def made(tree: ast.SourceTree) -> ast.SourceTree:
        items = tuple(
            constants.get(item.name.text, item) if isinstance(item, ast.Constant) else _with_arguments(item, by_owner)
            for item in tree.items
        )
        return replaced(tree, items=(*items, *added) if tree is trees[0] else items)

    return tuple(map(made, trees))


def _with_arguments(item: ast.Node, by_owner: Mapping[ast.Node, Sequence[Settable]]) -> ast.Node:
    """A definition in which the instances get these arguments."""
    match item:
        case ast.ProcessDefinition():
            own = {entry.parameter: entry for entry in by_owner.get(item, ())}
            parameters = tuple(
                replaced(parameter, default=_use(own[parameter])) if parameter in own else parameter
                for parameter in item.parameters
            )
            block = item.communication
            if block is not None:
                block = replaced(block, declarations=_declared(block.declarations, by_owner))
            return replaced(item, parameters=parameters, communication=block)
        case ast.SubmodelDefinition():
            return replaced(item, items=_declared(item.items, by_owner))
        case ast.EnvironmentDefinition():
            return replaced(item, arguments=_arguments_with(item.arguments, by_owner.get(item, ())))
        case _:  # Nothing else has instances of the program.
            return item


def _declared(items: tuple[ast.Node, ...], by_owner: Mapping[ast.Node, Sequence[Settable]]) -> tuple[ast.Node, ...]:
    return tuple(
        replaced(item, arguments=_arguments_with(item.arguments, by_owner[item]))
        if isinstance(item, ast.Instance) and item in by_owner
        else item
        for item in items
    )


def _arguments_with(arguments: tuple[ast.Argument, ...], settable: Sequence[Settable]) -> tuple[ast.Argument, ...]:
    """The arguments, some of them replaced, and others added by name."""
    by_value = {entry.constant.value: entry for entry in settable}
    made = [
        replaced(argument, value=_use(by_value.pop(argument.value))) if argument.value in by_value else argument
        for argument in arguments
    ]
    for entry in by_value.values():
        assert entry.parameter is not None
        made.append(ast.Argument(span=entry.parameter.span, name=entry.parameter.name, value=_use(entry)))
    return tuple(made)


def _use(entry: Settable) -> ast.Name:
    return ast.Name(span=entry.constant.value.span, name=entry.setting)
