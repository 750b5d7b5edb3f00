"""Makes classes of the network from submodels: flat, sorted, and with linear operators discretized."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import partial

from cspdiag.base import Report
from cspdiag.base.record import node, record, replaced
from cspdiag.model.program import BuiltinSymbol, Program
from cspdiag.model.remembered import ALWAYS, Checks
from cspdiag.network.diagnostics.usage import InputDiscarded
from cspdiag.network.elaborate.expression import lower_period
from cspdiag.network.ir.expressions import Value
from cspdiag.network.ir.network import ClassParameter, Direction, Port, SubmodelClass
from cspdiag.network.submodels.draft import SECONDS, Draft
from cspdiag.network.submodels.inline import Inlining, external_body
from cspdiag.network.submodels.operators import PARAMETERS
from cspdiag.network.submodels.signals import InlinedInto
from cspdiag.network.submodels.system import complete, evaluation_order
from cspdiag.syntax import ast
from cspdiag.syntax.walk import instances_in, nodes


@record
class LawUse:
    """An instance of a submodel: the known values of its parameters, its period in nanoseconds if known, values set
    from outside for parameters inside it, by path, and the names of parameters that follow parameters of the program.
    """

    definition: ast.SubmodelDefinition
    arguments: Mapping[str, Value]
    sample: int | None
    overrides: Mapping[str, Value]
    tunable: frozenset[str] = frozenset()

    @property
    def is_known(self) -> bool:
        """Whether every parameter has a value, or follows parameters of the program."""
        return len(self.arguments) + len(self.tunable) == len(self.definition.parameters)


@node
class Flattened:
    """A class with symbolic parameters; the values of its derived parameters for one instance; and the names in it."""

    cls: SubmodelClass
    derived: dict[str, Value]
    names: frozenset[str]


def flatten(program: Program, use: LawUse, report: Report, *, environment: bool = False) -> Flattened | None:
    """The class of an instance of a submodel.

    The values of its parameters affect only sizes and the values in ``derived``: instances with equal classes share one
    class. None if an error was reported. With ``environment`` the submodel may use ``time``.
    """
    definition = use.definition
    draft = Draft(
        owner=definition.name.span,
        sample=use.sample,
        arguments=use.arguments,
        overrides=use.overrides,
        tunable=use.tunable,
    )
    inlining = _inlined(program, draft, definition, environment, report)
    result: SubmodelClass | None = SubmodelClass(
        name=definition.name.text,
        definition=definition.name.text,
        doc=definition.doc,
        span=definition.name.span,
        ports=_ports(inlining),
        external=external_body(definition.external) if definition.external else None,
        wcet=_nanoseconds(inlining, definition.wcet),
        parameters=tuple(draft.parameters.values()),
    )
    if definition.external is None and result is not None:
        result = complete(result, draft, report)
    if result is None or not draft.complete:
        return None
    return Flattened(cls=result, derived=draft.derived, names=frozenset(draft.names))


def _inlined(
    program: Program, draft: Draft, definition: ast.SubmodelDefinition, environment: bool, report: Report
) -> Inlining:
    """Adds the outermost submodel, with everything in it, to a draft."""
    inlining = Inlining(program, draft, definition, report, InlinedInto(path=(), environment=environment))
    for parameter in definition.parameters:
        name = parameter.name.text
        kind = inlining.declared(parameter.type, program.types.get(parameter, SECONDS))
        draft.parameters[name] = ClassParameter(
            name=name,
            doc=parameter.doc,
            span=parameter.name.span,
            type=kind,
            tunable=name in draft.tunable,
        )
        draft.names.add(name)
    inlining.run()
    return inlining


def _ports(inlining: Inlining) -> tuple[Port, ...]:
    """The ports in text order. Each element of an array becomes a port; for a body in another language the whole array
    is one.
    """
    ports = []
    for symbol in inlining.scope.ports.values():
        direction: Direction = symbol.declaration.direction
        size = len(inlining.elements(symbol)) if symbol.port.dimensions else None
        port = Port(
            name=symbol.name,
            doc=symbol.declaration.doc,
            span=symbol.port.span,
            direction=direction,
            type=inlining.declared(symbol.declaration.type, symbol.type),
            size=size,
            period=lower_period(inlining.program, symbol.declaration.sampling, inlining.context),
        )
        if size is None or inlining.definition.external is not None:
            ports.append(port)
        else:
            ports += [replaced(port, name=f"{symbol.name}[{index}]", size=None) for index in range(size)]
    return tuple(ports)


def _nanoseconds(inlining: Inlining, duration: ast.Expression | None) -> int | None:
    value = inlining.draft.value_of(inlining.constant(duration)) if duration else None
    return value if isinstance(value, int) else None


_NEED_SAMPLE = frozenset(PARAMETERS) - {"pre", "delay"}


def needs_sample(program: Program, definition: ast.SubmodelDefinition) -> bool:
    """Whether the submodel or one inside it uses its sample period."""
    pending, met = [definition], {definition}
    while pending:
        for part in nodes(*pending.pop().items):
            match part:
                case ast.Derivative() if part not in program.poisoned:
                    return True
                case ast.Name():
                    symbol = program.bindings.get(part)
                    if isinstance(symbol, BuiltinSymbol) and symbol.name == "sample":
                        return True
                case ast.Call() if part.function.text in _NEED_SAMPLE:
                    return True
                case ast.Instance():
                    inner = program.bindings.get(part.definition)
                    if isinstance(inner, ast.SubmodelDefinition) and inner not in met:
                        met.add(inner)
                        pending.append(inner)
                case _:  # Any other node of an equation.
                    pass
    return False


def check(
    program: Program,
    report: Report,
    samples: Iterable[tuple[ast.SubmodelDefinition, int]] = (),
    laws: Iterable[LawUse] = (),
    checks: Checks = ALWAYS,
) -> None:
    """Reports algebraic loops and impossible operators in all submodels that run in a process, and in those of the text
    that are not used at all.

    Submodels inside others are checked with them. ``samples`` are submodels with the sample periods at which they run,
    as far as known; ``laws`` are instances with the known values of their parameters.
    """
    in_processes, elsewhere = _uses(program)
    known: dict[tuple[ast.SubmodelDefinition, int | None], list[LawUse]] = {}
    for use in laws:
        if use.is_known:
            known.setdefault((use.definition, use.sample), []).append(use)
    periods: dict[ast.SubmodelDefinition, list[int | None]] = {}
    for definition, period in samples:
        periods.setdefault(definition, []).append(period)
    for definition in in_processes:
        for sample in periods.get(definition, [None]):
            for use in known.get((definition, sample), [LawUse(definition, {}, sample, {})]):
                made = partial(_check, program, use)
                if not checks.result("law", definition, _facts(use), made, report):
                    break
        checks.result("inputs", definition, "", partial(_check_inputs, program, definition), report)
    libraries = {item for tree in program.trees if tree.source.name.startswith("std/") for item in tree.items}
    for candidate in program.definitions.values():
        is_used = candidate in in_processes or candidate in elsewhere or candidate in libraries
        if isinstance(candidate, ast.SubmodelDefinition) and not is_used:
            made = partial(_check, program, LawUse(candidate, {}, None, {}), environment=True)
            checks.result("unused law", candidate, "", made, report)


def _facts(use: LawUse) -> str:
    """What is known of an instance, except its definition."""
    return repr((use.arguments, use.sample, use.overrides, sorted(use.tunable)))


def _check_inputs(program: Program, definition: ast.SubmodelDefinition, report: Report) -> None:
    """Warns of inputs that no equation uses: the law reads their values and discards them."""
    if definition.external is not None or definition in program.poisoned:
        return
    used = {
        program.bindings.get(part) for part in nodes(*definition.items) if isinstance(part, ast.Name | ast.Reference)
    }
    for symbol in program.scopes[definition].ports.values():
        if symbol.declaration.direction == "in" and symbol not in used:
            report.add(InputDiscarded(span=symbol.port.span, port=symbol.name, submodel=definition.name.text))


def _check(program: Program, use: LawUse, report: Report, *, environment: bool = False) -> bool:
    """Checks an instance, or a definition by itself; returns whether another instance might have other errors."""
    definition = use.definition
    draft = Draft(
        owner=definition.name.span,
        sample=use.sample,
        arguments=use.arguments,
        concrete=use.is_known and not environment,
        overrides=use.overrides,
        tunable=use.tunable,
    )
    _inlined(program, draft, definition, environment, report)
    evaluation_order(draft, report)
    return draft.depends


def _uses(program: Program) -> tuple[dict[ast.SubmodelDefinition, None], set[object]]:
    """The submodels that run in processes, and those inside submodels and environments."""
    in_processes: dict[ast.SubmodelDefinition, None] = {}
    elsewhere: set[object] = set()
    for definition in program.definitions.values():
        found = [program.bindings.get(instance.definition) for instance in instances_in(definition)]
        if isinstance(definition, ast.ProcessDefinition):
            in_processes.update(dict.fromkeys(each for each in found if isinstance(each, ast.SubmodelDefinition)))
        else:
            elsewhere.update(found)
    return in_processes, elsewhere
