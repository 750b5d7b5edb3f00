"""What is known about a name, in the words of the language: for hover, completion and signatures."""

from __future__ import annotations

from typing import assert_never

from cspdiag.base.record import record
from cspdiag.draw.elements.facts import Facts
from cspdiag.editing.occurrences import Meaning, Owner
from cspdiag.model.constants.durations import duration
from cspdiag.model.expressions.functions import FUNCTIONS
from cspdiag.model.program import BuiltinSymbol, EndLabelSymbol, EnumLiteralSymbol, PortSymbol, Program
from cspdiag.model.sampling import Sampling
from cspdiag.model.types import TimeType
from cspdiag.syntax import ast

_BUILTINS = {
    "pi": ("pi : double", "The number 3.14159…"),
    "sample": ("sample : double<s>", "The sample period at which the submodel runs."),
    "time": ("time : double<s>", "The present instant, from the start of the program."),
    "now": ("now : time", "The present instant, from the start of the program."),
    "Timeout": ("exception Timeout", "Raised where a sample is missed."),
    "Fault": ("exception Fault", "Raised where a value does not exist, such as that of a division by zero."),
}


@record
class Description:
    """``code`` is the declaration as it would be written; ``facts`` are sentences about what was inferred."""

    code: str
    facts: tuple[str, ...] = ()
    doc: str | None = None

    @property
    def markdown(self) -> str:
        """All of it, for a pop-up."""
        parts = [f"```csp\n{self.code}\n```", "  \n".join(self.facts), self.doc or ""]
        return "\n\n".join(part for part in parts if part)


def described(program: Program, facts: Facts | None, meaning: Meaning, owner: Owner) -> Description:
    """What a name means that occurs in the definition ``owner``; without ``facts`` nothing inferred."""
    match meaning:
        case ast.Constant():
            return Description(_constant(meaning), _value(program, meaning), meaning.doc)
        case ast.TypeAliasDefinition():
            return Description(f"type {meaning.name.text} = {meaning.type.span.text}", (), meaning.doc)
        case ast.EnumDefinition():
            literals = ", ".join(literal.text for literal in meaning.literals)
            return Description(f"enum {meaning.name.text} {{ {literals} }}", (), meaning.doc)
        case ast.StructDefinition():
            fields = "".join(f"\n  {field.name.text} : {field.type.span.text}" for field in meaning.fields)
            return Description(f"struct {meaning.name.text} {{{fields}\n}}", (), meaning.doc)
        case ast.ExceptionDefinition():
            return Description(f"exception {meaning.name.text}", (), meaning.doc)
        case ast.ProcessDefinition() | ast.SubmodelDefinition() | ast.DriverDefinition():
            return Description(header(meaning), (), meaning.doc)
        case ast.EnvironmentDefinition():
            return Description(f"environment {meaning.name.text} for {meaning.process.text}", (), meaning.doc)
        case ast.Parameter():
            default = "" if meaning.default is None else f" = {meaning.default.span.text}"
            return Description(f"{meaning.name.text} : {meaning.type.span.text}{default}", (), meaning.doc)
        case ast.Field():
            return Description(f"{meaning.name.text} : {meaning.type.span.text}", (), meaning.doc)
        case ast.Variable():
            initial = "" if meaning.initial is None else f" = {meaning.initial.span.text}"
            code = f"var {meaning.name.text} : {meaning.type.span.text}{initial}"
            return Description(code, _flow(facts, owner, meaning), meaning.doc)
        case ast.Channel():
            code = f"channel {meaning.name.text} : {meaning.type.span.text}"
            return Description(code, _flow(facts, owner, meaning), meaning.doc)
        case ast.Instance():
            return _instance(program, facts, meaning, owner)
        case ast.Let():
            kind = program.types.get(meaning)
            shown = "" if kind is None else f" : {kind}"
            return Description(f"let {meaning.name.text}{shown} = {meaning.value.span.text}", (), meaning.doc)
        case ast.State():
            code = f"state {meaning.name.text} : {meaning.type.span.text} = {meaning.initial.span.text}"
            return Description(code, (), meaning.doc)
        case ast.Replicator():
            return Description(f"{meaning.name.text} < {meaning.count.span.text}", ("replicator, an `int`",))
        case PortSymbol():
            return Description(port_code(meaning), _port_facts(program, facts, meaning), meaning.declaration.doc)
        case EndLabelSymbol():
            label = meaning.connection.label
            code = f"{label.text if label else '_'} : {meaning.type}"
            return Description(code, _flow(facts, owner, meaning.connection), meaning.connection.doc)
        case EnumLiteralSymbol():
            name, literal = meaning.definition.name.text, meaning.definition.literals[meaning.index].text
            return Description(f"{name}.{literal}", (f"literal {meaning.index} of the enum",), meaning.definition.doc)
        case BuiltinSymbol():
            return builtin(meaning.name)
        case _:
            assert_never(meaning)


def builtin(name: str) -> Description:
    """What a part of the language means."""
    if name in FUNCTIONS:
        return Description(FUNCTIONS[name].written, ("function of the language",))
    code, doc = _BUILTINS.get(name, (name, "a part of the language"))
    return Description(code, (), doc)


def signature(definition: ast.ProcessDefinition | ast.SubmodelDefinition | ast.DriverDefinition) -> str:
    """A definition with its parameters."""
    keyword = {ast.ProcessDefinition: "process", ast.SubmodelDefinition: "submodel", ast.DriverDefinition: "driver"}
    parameters = ", ".join(parameter_code(each) for each in definition.parameters)
    return f"{keyword[type(definition)]} {definition.name.text}{f'({parameters})' if parameters else ''}"


def header(definition: ast.ProcessDefinition | ast.SubmodelDefinition | ast.DriverDefinition) -> str:
    """A definition with its parameters and its ports."""
    ports = "".join(f"\n  {_declaration(ports)}" for ports in definition.ports)
    return f"{signature(definition)} {{{ports}\n}}" if ports else signature(definition)


def parameter_code(parameter: ast.Parameter) -> str:
    """A parameter as it is declared."""
    default = "" if parameter.default is None else f" = {parameter.default.span.text}"
    return f"{parameter.name.text}: {parameter.type.span.text}{default}"


def port_code(port: PortSymbol) -> str:
    """A port as if it were declared alone."""
    return _declaration(port.declaration, port.port.span.text)


def _declaration(ports: ast.Ports, names: str | None = None) -> str:
    names = names or ", ".join(port.span.text for port in ports.names)
    default = "" if ports.default is None else f" = {ports.default.span.text}"
    sampling = "" if ports.sampling is None else f" @ {' '.join(ports.sampling.span.text.split())}"
    safe = "" if ports.safe is None else f" safe {ports.safe.span.text}"
    immediate = " immediate" if ports.immediate else ""
    return f"{ports.direction} {names} : {ports.type.span.text}{default}{sampling}{immediate}{safe}"


def _constant(constant: ast.Constant) -> str:
    written = "" if constant.type is None else f" : {constant.type.span.text}"
    keyword = "parameter" if constant.tunable else "const"
    return f"{keyword} {constant.name.text}{written} = {constant.value.span.text}"


def _value(program: Program, constant: ast.Constant) -> tuple[str, ...]:
    kind = program.types.get(constant)
    value = program.constants.get(constant, program.tunable.get(constant))
    found = [] if kind is None else [f"type `{kind}`"]
    if isinstance(kind, TimeType) and isinstance(value, int):
        found.append(f"value {duration(value)}")
    elif isinstance(value, bool | int | float) and not isinstance(constant.value, ast.Number | ast.Boolean):
        found.append(f"value {value}")
    return tuple(found)


def _instance(program: Program, facts: Facts | None, instance: ast.Instance, owner: Owner) -> Description:
    definition = program.bindings.get(instance.definition)
    size = "" if instance.size is None else f"[{instance.size.span.text}]"
    arguments = ", ".join(" ".join(argument.span.text.split()) for argument in instance.arguments)
    code = f"{instance.name.text}{size} : {instance.definition.text}{f'({arguments})' if arguments else ''}"
    doc = instance.doc
    if isinstance(definition, ast.ProcessDefinition | ast.SubmodelDefinition | ast.DriverDefinition):
        code += "".join(f"\n  {_declaration(ports)}" for ports in definition.ports)
        doc = doc or definition.doc
    periods = facts.samples(owner, instance) if facts is not None and owner is not None else ()
    found = (f"runs every {_listed([duration(period) for period in periods])}",) if periods else ()
    return Description(code, found, doc)


def _flow(facts: Facts | None, owner: Owner, declaration: ast.Node) -> tuple[str, ...]:
    if facts is None or owner is None:
        return ()
    flow = facts.channel(owner, declaration)
    return _sentences(flow.kinds, flow.periods)


def _port_facts(program: Program, facts: Facts | None, port: PortSymbol) -> tuple[str, ...]:
    if facts is None:
        return ()
    owners = [
        definition
        for definition in program.definitions.values()
        if (scope := program.scopes.get(definition)) is not None
        and scope.ports.get(port.name) is port
        and not isinstance(definition, ast.EnvironmentDefinition)
    ]
    for owner in owners:
        flow = facts.port(owner, port.name)
        return _sentences(flow.kinds, flow.periods or facts.stated_periods(owner, port.name))
    return ()


def _sentences(kinds: tuple[str, ...], periods: tuple[Sampling, ...]) -> tuple[str, ...]:
    found = []
    if kinds:
        found.append(f"inferred kind: {_listed(list(kinds))}")
    if periods:
        found.append(f"sample period: {_listed([str(period) for period in periods])}")
    return tuple(found)


def _listed(words: list[str]) -> str:
    *first, last = words
    return f"{', '.join(first)} or {last}" if first else last
