"""Extracts the elements of a composition diagram from the syntax tree, so programs with errors have them too."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal, TypeAlias, TypeGuard, assert_never

from cspdiag.draw.elements.composition import (
    Activity,
    ActivityForm,
    Case,
    Chain,
    Choice,
    Composition,
    CompositionDiagram,
    Condition,
    Guard,
    Guarded,
    GuardForm,
    Handler,
    Inside,
    Loop,
    NamedGroup,
    Operator,
    Replication,
    Watched,
)
from cspdiag.draw.elements.diagram import BoxKind
from cspdiag.draw.elements.texts import optional, replicator, written, written_span
from cspdiag.syntax import ast
from cspdiag.syntax.parse.nesting import raised_recursion_limit
from cspdiag.syntax.walk import instances_in

Definitions: TypeAlias = Mapping[str, ast.Definition]


@raised_recursion_limit()
def composition_diagram(definitions: Definitions, process: ast.ProcessDefinition, depth: int = 1) -> CompositionDiagram:
    """The composition diagram of a process, given the definitions of its program by name.

    ``depth`` 2 shows the compositions of its instances instead of their names, and so on.
    """
    reader = _Reader(definitions, process, depth, (process,))
    root = None if process.composition is None else reader.composition(process.composition, "1")
    span = process.composition_span
    return CompositionDiagram(key=process.name.text, doc=process.doc, spans=() if span is None else (span,), root=root)


_REPLICATED: dict[ast.ReplicatedOperator, tuple[Operator, bool]] = {
    "seq": ("sequence", False),
    "par": ("parallel", False),
    "pripar": ("parallel", True),
    "alt": ("alternative", False),
    "prialt": ("alternative", True),
}


class _Reader:
    """Reads one composition; ``within`` are the processes around it, itself included."""

    def __init__(
        self,
        definitions: Definitions,
        process: ast.ProcessDefinition,
        depth: int,
        within: tuple[ast.ProcessDefinition, ...],
    ) -> None:
        self._definitions = definitions
        self._depth = depth
        self._within = within
        self._instances: dict[str, ast.Instance] = {}
        for instance in instances_in(process):
            self._instances.setdefault(instance.name.text, instance)

    def composition(self, node: ast.Composition, key: str) -> Composition:
        match node:
            case ast.Sequence(processes=processes):
                return self._chain(node, key, "sequence", False, processes)
            case ast.Parallel(processes=processes):
                return self._chain(node, key, "parallel", node.prioritized, processes)
            case ast.Alternative(branches=branches):
                return self._chain(node, key, "alternative", node.prioritized, branches)
            case ast.Guarded():
                return Guarded(
                    key=key,
                    spans=(node.span,),
                    guard=_guard(node.guard, f"{key}.1"),
                    process=self.composition(node.process, f"{key}.2"),
                )
            case ast.Mu():
                return self._loop(node, key, "mu", node.until)
            case ast.While():
                return self._loop(node, key, "while", node.condition)
            case ast.If():
                return self._choice(node, key)
            case ast.Catch() | ast.Interrupt():
                return self._watched(node, key)
            case ast.Replicated():
                operator, prioritized = _REPLICATED[node.operator]
                return Replication(
                    key=key,
                    spans=(node.span,),
                    operator=operator,
                    prioritized=prioritized,
                    replicator=replicator(node.replicator),
                    process=self.composition(node.process, f"{key}.1"),
                )
            case ast.Labelled():
                return NamedGroup(
                    key=key,
                    spans=(node.span,),
                    label=node.label.text,
                    process=self.composition(node.process, f"{key}.1"),
                )
            case (
                ast.Run() | ast.Read() | ast.Write() | ast.Assign() | ast.Skip() | ast.Stop() | ast.Wait()
                | ast.Reset() | ast.Raise()
            ):  # fmt: skip
                return self._activity(node, key)
            case _:
                assert_never(node)

    def _chain(
        self,
        node: ast.Composition,
        key: str,
        operator: Operator,
        prioritized: bool,
        processes: tuple[ast.Composition, ...],
    ) -> Chain:
        return Chain(
            key=key,
            spans=(node.span,),
            operator=operator,
            prioritized=prioritized,
            parts=tuple(self.composition(part, f"{key}.{number}") for number, part in enumerate(processes, 1)),
        )

    def _loop(
        self, node: ast.Mu | ast.While, key: str, form: Literal["mu", "while"], condition: ast.Expression | None
    ) -> Loop:
        body = self.composition(node.process, f"{key}.1")
        test = None
        if condition is not None:
            test = Condition(key=f"{key}.2", spans=(condition.span,), text=written(condition))
        return Loop(key=key, spans=(node.span,), form=form, process=body, condition=test)

    def _choice(self, node: ast.If, key: str) -> Choice:
        cases: list[Case] = []
        step: ast.Composition | None = node
        while isinstance(step, ast.If) and (not cases or not step.parenthesized):
            place = f"{key}.{len(cases) + 1}"
            process = self.composition(step.then, f"{place}.1")
            cases.append(Case(key=place, spans=(step.span,), condition=written(step.condition), process=process))
            step = step.otherwise
        otherwise = None if step is None else self.composition(step, f"{key}.{len(cases) + 1}")
        return Choice(key=key, spans=(node.span,), cases=tuple(cases), otherwise=otherwise)

    def _watched(self, node: ast.Catch | ast.Interrupt, key: str) -> Watched:
        layers = [node]
        while isinstance(layers[-1].process, ast.Catch | ast.Interrupt) and not layers[-1].process.parenthesized:
            layers.append(layers[-1].process)
        handlers = tuple(self._handler(layer, f"{key}.{number}") for number, layer in enumerate(reversed(layers), 2))
        process = self.composition(layers[-1].process, f"{key}.1")
        return Watched(key=key, spans=(node.span,), process=process, handlers=handlers)

    def _handler(self, node: ast.Catch | ast.Interrupt, key: str) -> Handler:
        if isinstance(node, ast.Catch):
            process = self.composition(node.handler, f"{key}.1")
            return Handler(key=key, spans=(node.span,), exception=node.exception.text, process=process)
        process = self.composition(node.handler, f"{key}.2")
        return Handler(key=key, spans=(node.span,), guard=_guard(node.guard, f"{key}.1"), process=process)

    def _activity(
        self,
        node: ast.Run | ast.Read | ast.Write | ast.Assign | ast.Skip | ast.Stop | ast.Wait | ast.Reset | ast.Raise,
        key: str,
    ) -> Activity | Inside:
        text = written_span(node.place)
        if not isinstance(node, ast.Run):
            return Activity(key=key, spans=(node.place,), form=_FORMS[type(node)], text=text)
        instance = self._instances.get(node.instance.name.text)
        if instance is None:
            return Activity(key=key, spans=(node.place,), form="run", text=text, kind="unknown")
        definition = self._definitions.get(instance.definition.text)
        if self._shows_inside(definition) and definition.composition is not None:
            reader = _Reader(self._definitions, definition, self._depth - 1, (*self._within, definition))
            return Inside(
                key=key,
                doc=instance.doc,
                spans=(node.place,),
                text=text,
                definition=instance.definition.text,
                process=reader.composition(definition.composition, f"{key}.1"),
            )
        return Activity(
            key=key,
            doc=instance.doc,
            spans=(node.place,),
            form="run",
            text=text,
            kind=_kind(definition),
            definition=instance.definition.text,
            language=_language(definition),
            definition_doc=None if definition is None else definition.doc,
        )

    def _shows_inside(self, definition: ast.Definition | None) -> TypeGuard[ast.ProcessDefinition]:
        is_process = isinstance(definition, ast.ProcessDefinition)
        return is_process and self._depth > 1 and definition not in self._within


_FORMS: dict[type[ast.Node], ActivityForm] = {
    ast.Read: "read",
    ast.Write: "write",
    ast.Assign: "assign",
    ast.Skip: "skip",
    ast.Stop: "stop",
    ast.Wait: "wait",
    ast.Reset: "reset",
    ast.Raise: "raise",
}


def _kind(definition: ast.Definition | None) -> BoxKind:
    if isinstance(definition, ast.ProcessDefinition):
        return "process"
    return "submodel" if isinstance(definition, ast.SubmodelDefinition) else "unknown"


def _language(definition: ast.Definition | None) -> str | None:
    if isinstance(definition, ast.ProcessDefinition | ast.SubmodelDefinition) and definition.external is not None:
        return definition.external.language.text
    return None


_GUARD_FORMS: dict[type[ast.Node], GuardForm] = {
    ast.ReadyGuard: "ready",
    ast.InputGuard: "input",
    ast.OutputGuard: "output",
    ast.TimeGuard: "after",
    ast.SkipGuard: "skip",
}


def _guard(node: ast.Guard, key: str) -> Guard:
    return Guard(
        key=key,
        spans=(node.span,),
        form=_GUARD_FORMS[type(node.event)],
        text=written(node.event),
        condition=optional(node.condition),
    )
