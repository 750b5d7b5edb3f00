"""Inlines submodels into the equations of one system, under the names of their instances."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import get_args

from cspdiag.base import Report
from cspdiag.base.record import replaced
from cspdiag.model.diagnostics.equations import MissingEquation, UnconnectedInput
from cspdiag.model.names.described import LANGUAGE
from cspdiag.model.program import Program
from cspdiag.model.types import UNKNOWN, ArrayType, Type, UnknownType
from cspdiag.network.diagnostics.operators import UnknownMethod
from cspdiag.network.diagnostics.submodels import IntegrationStepNotPositive, TooManyEquations
from cspdiag.network.elaborate.definitions import arguments_of
from cspdiag.network.elaborate.expression import LoweringContext, lower_expression
from cspdiag.network.ir.equations import ExternalBody, ExternalCall, SubmodelEquation
from cspdiag.network.ir.expression_walk import walk
from cspdiag.network.ir.expressions import ElementValue, Expression, LiteralValue, SignalValue
from cspdiag.network.ir.network import SubmodelState
from cspdiag.network.submodels.discretize import Method
from cspdiag.network.submodels.draft import SECONDS, Draft
from cspdiag.network.submodels.operators import PARAMETERS, Application, realize
from cspdiag.network.submodels.signals import InlinedInto, SubmodelSignals
from cspdiag.syntax import ast

MOST_EQUATIONS = 20_000


class Inlining(SubmodelSignals):
    """Inlines one instance of a submodel into a draft: its states, its equations and the instances inside it."""

    def __init__(
        self,
        program: Program,
        draft: Draft,
        definition: ast.SubmodelDefinition,
        report: Report,
        surroundings: InlinedInto,
        prefix: str = "",
    ) -> None:
        super().__init__(program, draft, definition, report, surroundings, prefix)
        self.inner: dict[str, Inlining] = {}
        self.continuous = {item.name.text for item in definition.items if isinstance(item, ast.Derivative)}
        self.method: Method = "tustin"
        self.operator_target: str | None = None
        """The signal that the expression being lowered defines, if it is an operator as a whole."""
        self.counts: dict[str, int] = {}

    def instance(self, name: str) -> SubmodelSignals | None:
        """The instance with this name inside this one."""
        return self.inner.get(name)

    def refuse_instance(self, name: str, indexes: Sequence[ast.Expression]) -> None:
        """Handles an instance that does not exist inside this one; an index out of the range of an array
        is reported.
        """
        self.draft.complete = False
        for item in self.definition.items:
            if isinstance(item, ast.Instance) and item.name.text == name and item.size is not None and indexes:
                count = item.size.count if isinstance(item.size, ast.Replicator) else item.size
                self.refuse_index(indexes[-1], f"the array of instances `{name}`", self.size(count), item.name.span)

    def _refuse(self, missing: MissingEquation | UnconnectedInput) -> None:
        """Reports a missing equation or connection, unless another one was refused, which may be the reason."""
        if self.draft.concrete and self.draft.complete:
            self.report.add(missing)
        self.draft.complete = False

    def run(self) -> None:
        """Adds the states and equations of the definition; the enclosing submodel adds those of its inputs."""
        if len(self.draft.equations) > MOST_EQUATIONS:
            name = self.surroundings.path[0].name if self.surroundings.path else self.definition.name
            self.report.add(TooManyEquations(name.span, name.text, MOST_EQUATIONS))
            self.draft.complete = False
            return
        if self.program.poisoned.intersection((self.definition, *self.definition.items)):
            self.draft.complete = False
        if self.definition.external:
            return
        self._options()
        self.draft.names.update(self.prefix + name for name in (*self.scope.ports, *self.scope.names))
        # Equations may read instances that are declared later.
        for item in self.definition.items:
            if isinstance(item, ast.Instance) and item not in self.program.poisoned:
                self._declare(item)
        for item in self.definition.items:
            self._item(item)
        for key, instance in self.inner.items():
            instance.close(key)
        for port, key, _ in self.ports("out"):
            if key not in self.draft.equations:
                element, owner = key.removeprefix(self.prefix), self.definition.name.text
                self._refuse(MissingEquation(port.port.span, name=element, owner=owner))

    def close(self, name: str) -> None:
        """Completes the instance after its inputs have been connected: other inputs get their defaults, and an external
        body becomes a call.
        """
        for port, key, kind in self.ports("in"):
            if key in self.draft.equations:
                continue
            default = port.declaration.default
            if default is None:
                names, declared = (key.removeprefix(self.prefix),), port.port.span
                self._refuse(UnconnectedInput(self.draft.owner, names=names, instance=name, declared=declared))
                continue
            self.draft.equation(key, self.constant(default), port.port.span, kind=kind)
        if self.definition.external:
            self._external_call(name, self.definition.external)

    def value(self, expression: ast.Expression, target: str) -> Expression:
        """The right-hand side of the equation for ``target``."""
        is_operator = isinstance(expression, ast.Call) and self._is_operator(expression)
        self.operator_target = target if is_operator else None
        return lower_expression(self.program, expression, self.context)

    def _options(self) -> None:
        definition = self.definition
        if definition.method is not None:
            name = definition.method.text
            if name in get_args(Method):
                self.method = name  # type: ignore[assignment]
            elif name != "rk4":
                self.report.add(UnknownMethod(definition.method.span, name))
            self.draft.methods.append(name)
        elif any(isinstance(item, ast.Derivative) for item in definition.items):
            self.draft.methods.append("rk4")
        if definition.step is not None:
            step = self.draft.value_of(self.constant(definition.step))
            if isinstance(step, int) and step <= 0:
                self.report.add(IntegrationStepNotPositive(definition.step.span))
            elif isinstance(step, int):
                self.draft.steps.append(step)

    def _item(self, item: ast.SubmodelItem) -> None:
        if item in self.program.poisoned:
            self.draft.complete = False
            return
        match item:
            case ast.Instance():
                for name, _ in self._elements_of(item):
                    if name in self.inner:
                        self.inner[name].run()
            case ast.Let():
                name = self.prefix + item.name.text
                value = self.value(item.value, name)
                kind = self.program.types.get(item, value.type)
                self.draft.equation(name, value, item.span, item.doc, _sized(kind, value.type))
            case ast.State():
                self._state(item)
            case ast.Next():
                name = self.prefix + item.name.text
                self.draft.next_values[name] = self.value(item.value, "")
                self.draft.changes[name] = item.span
            case ast.Derivative():
                self.draft.sample_period()
                name = self.prefix + item.name.text
                self.draft.derivatives[name] = self.value(item.value, "")
                self.draft.changes[name] = item.span
            case ast.Equation():
                self._equation(item)

    def _state(self, item: ast.State) -> None:
        name = self.prefix + item.name.text
        kind = self.declared(item.type, self.program.types.get(item, SECONDS))
        initial = self.constant(item.initial)
        continuous = item.name.text in self.continuous
        self.draft.states[name] = SubmodelState(
            name=name, type=kind, initial=initial, continuous=continuous, span=item.span, doc=item.doc
        )

    def _equation(self, item: ast.Equation) -> None:
        target = item.target
        if target.member is None:
            symbol = self.scope.ports.get(target.name.text)
            owner, port, indexes = self, target.name.text, target.indexes
        else:
            name = target.name.text + "".join(f"[{self.index(index)}]" for index in target.indexes)
            if name not in self.inner:
                self.refuse_instance(target.name.text, target.indexes)
                return
            owner, port, indexes = self.inner[name], target.member.text, target.member_indexes
            symbol = owner.scope.ports.get(port)
        if symbol is None:
            self.draft.complete = False
            return
        key = owner.prefix + port
        if indexes:
            # Elements of an array of ports are numbered in row-major order.
            flat = 0
            for index, dimension in zip(indexes, symbol.port.dimensions, strict=False):
                size, value = owner.size(dimension), self.index(index)
                if not 0 <= value < size:
                    self.refuse_index(index, f"the array of ports `{symbol.name}`", size, symbol.port.span)
                flat = flat * size + value
            key += f"[{flat}]"
        kind = owner.declared(symbol.declaration.type, symbol.type)
        self.draft.equation(key, self.value(item.value, key), item.span, symbol.declaration.doc, kind)

    def _declare(self, instance: ast.Instance) -> None:
        definition = self.program.bindings.get(instance.definition)
        if not isinstance(definition, ast.SubmodelDefinition):
            self.draft.complete = False
            return
        path = (*self.surroundings.path, self.definition)
        if definition in path:
            self.draft.complete = False
            return
        surroundings = InlinedInto(path=path, environment=self.surroundings.environment)
        for name, values in self._elements_of(instance):
            context = LoweringContext(values=values, lower_name=self.lower_name, lower_call=self.lower_call)
            arguments = {}
            for parameter, argument in arguments_of(definition.parameters, instance.arguments):
                self.examine(argument, values)
                arguments[parameter] = lower_expression(self.program, argument, context)
            self.inner[name] = nested(
                self.program, self.draft, definition, self.report, surroundings, self.prefix + name, arguments
            )

    def _elements_of(self, instance: ast.Instance) -> Iterator[tuple[str, dict[ast.Node, int]]]:
        """The names of the elements of an array of instances, each with the value of its replicator."""
        name, size = instance.name.text, instance.size
        if size is None:
            yield name, {}
            return
        count = size.count if isinstance(size, ast.Replicator) else size
        for index in range(self.size(count)):
            yield f"{name}[{index}]", {size: index} if isinstance(size, ast.Replicator) else {}

    def _external_call(self, name: str, external: ast.External) -> None:
        """Adds a call with the equations of the inputs as its arguments, which computes all outputs."""
        draft = self.draft
        inputs = []
        for _, key, _ in self.ports("in"):
            equation = draft.equations.pop(key, None)
            if isinstance(equation, SubmodelEquation):
                inputs.append((key.removeprefix(self.prefix), equation.value))
        outputs = tuple((key.removeprefix(self.prefix), key, kind) for _, key, kind in self.ports("out"))
        arguments = [(p.name.text, self.parameters[p]) for p in self.definition.parameters if p in self.parameters]
        key = self.prefix.removesuffix(".")
        body = external_body(external)
        if body.language == LANGUAGE:
            body = replaced(body, **self._integration())
        draft.equations[key] = ExternalCall(
            name=key,
            doc=self.definition.doc,
            span=external.span,
            external=body,
            definition=self.definition.name.text,
            arguments=tuple(arguments),
            inputs=tuple(inputs),
            outputs=outputs,
        )

    def _integration(self) -> dict[str, str | int]:
        """How an FMU for model exchange is integrated."""
        found: dict[str, str | int] = {}
        if self.definition.method is not None:
            if self.definition.method.text not in ("rk4", "euler"):
                self.report.add(UnknownMethod(self.definition.method.span, self.definition.method.text))
            found["method"] = self.definition.method.text
        step = None if self.definition.step is None else self.draft.value_of(self.constant(self.definition.step))
        if isinstance(step, int) and step <= 0 and self.definition.step is not None:
            self.report.add(IntegrationStepNotPositive(self.definition.step.span))
        elif isinstance(step, int):
            found["step"] = step
        return found

    def _is_operator(self, expression: ast.Call) -> bool:
        symbol = self.program.bindings.get(expression.function)
        return expression.function.text in PARAMETERS and not isinstance(symbol, ast.Node)

    def lower_call(self, expression: ast.Call) -> Expression | None:
        """The value of an operator with memory, whose states are added; None for a function."""
        name = expression.function.text
        if not self._is_operator(expression):
            return None
        target, self.operator_target = self.operator_target, None
        arguments = self._operator_arguments(expression)
        if arguments is None:
            self.draft.complete = False
            return LiteralValue(type=UNKNOWN, value=0, span=expression.span)
        output = target or self._operator_name(expression)
        use = Application(
            operator=name,
            arguments=arguments,
            output=output,
            base=output,
            type=_operator_type(self.program.types.get(expression, SECONDS), arguments["x"].type, name),
            method=self._operator_method(expression),
            span=expression.span,
        )
        value = realize(self.draft, use, self.report)
        if value is None:
            self.draft.complete = False
            return LiteralValue(type=use.type, value=0.0, span=expression.span)
        self.draft.held.add(output)
        if target or isinstance(value, SignalValue | ElementValue):
            return value
        self.draft.equation(output, value, expression.span, kind=use.type)
        return SignalValue(type=use.type, name=output, span=expression.span)

    def _operator_arguments(self, expression: ast.Call) -> dict[str, Expression] | None:
        """The arguments by name; None if an error in them was reported."""
        positional = [argument.value for argument in expression.arguments if argument.name is None]
        names = PARAMETERS[expression.function.text]
        if expression in self.program.poisoned or len(positional) != len(names):
            return None
        for argument, value in zip(names, positional, strict=True):
            if argument != "x":
                self.examine(value)
        values = [lower_expression(self.program, value, self.context) for value in positional]
        if any(isinstance(part.type, UnknownType) for value in values for part in walk(value)):
            return None
        return dict(zip(names, values, strict=True))

    def _operator_method(self, expression: ast.Call) -> Method:
        for argument in expression.arguments:
            if argument.name and isinstance(argument.value, ast.Name) and argument.value.name in get_args(Method):
                return argument.value.name  # type: ignore[return-value]
        return self.method

    def _operator_name(self, expression: ast.Call) -> str:
        """A name for the output of an operator inside an expression: ``lag_1``."""
        name = expression.function.text
        self.counts[name] = self.counts.get(name, 0) + 1
        chosen = self.draft.unique(f"{self.prefix}{name}_{self.counts[name]}")
        text = expression.span.text
        self.draft.written[chosen] = text if len(text) <= 40 and "\n" not in text else f"{name}(...)"
        return chosen


def nested(
    program: Program,
    draft: Draft,
    definition: ast.SubmodelDefinition,
    report: Report,
    surroundings: InlinedInto,
    name: str,
    arguments: Mapping[ast.Parameter, Expression],
) -> Inlining:
    """An instance called ``name`` inside the draft; parameters without an argument get their defaults.

    The caller still has to ``run`` it, to add equations for its inputs, and to ``close`` it.
    """
    result = Inlining(program, draft, definition, report, surroundings, f"{name}.")
    # Defaults may use earlier parameters.
    complete = result.parameters = dict(arguments)
    for parameter in definition.parameters:
        override = draft.overrides.get(f"{name}.{parameter.name.text}")
        if override is not None:
            kind = program.types.get(parameter, SECONDS)
            complete[parameter] = LiteralValue(type=kind, value=override)
        elif parameter in complete:
            continue
        elif parameter.default is None:
            draft.complete = False
        else:
            complete[parameter] = result.constant(parameter.default)
    draft.names.add(name)
    return result


def external_body(external: ast.External) -> ExternalBody:
    """An external body as part of the network."""
    return ExternalBody(language=external.language.text, target=external.target, span=external.target_span)


def _sized(declared: Type, found: Type) -> Type:
    """The declared type with the sizes of the value."""
    return found if isinstance(declared, ArrayType) and isinstance(found, ArrayType) else declared


def _operator_type(declared: Type, operand: Type, operator: str) -> Type:
    """The type of an operator: ``pre`` and ``delay`` have the sizes of their operand."""
    return _sized(declared, operand) if operator in ("pre", "delay") else declared
