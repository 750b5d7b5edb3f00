"""Compares two versions of a program."""

from __future__ import annotations

from collections.abc import Mapping
from typing import assert_never

from cspdiag.base.record import record, replaced
from cspdiag.draw.differences.change import Change, Parts, compare
from cspdiag.draw.differences.parts import KINDS, definition_parts, diagram_parts, kind_of
from cspdiag.draw.differences.renamed_parts import part_renames, with_new_names
from cspdiag.draw.differences.renames import pairs, renamed, vertex_renames, with_matched_arrows
from cspdiag.draw.elements import texts
from cspdiag.draw.elements.communication import Drawn
from cspdiag.draw.elements.compare_compositions import Compared, compared
from cspdiag.draw.elements.composition import CompositionDiagram
from cspdiag.draw.elements.diagram import CommunicationDiagram
from cspdiag.draw.elements.read_composition import composition_diagram
from cspdiag.draw.pictures import Pictures
from cspdiag.model.program import Program
from cspdiag.syntax import ast

ALIKE = 0.6
"""The fraction of two definitions that has to be equal for one to count as the other under a new name."""


@record
class Pair:
    """The diagrams of a definition in both versions; None if it was added or removed. In ``before`` renamed elements
    have their names of ``after``. ``changes`` are those within the definition, ``composition`` the composition of both
    versions, None if neither has one.
    """

    name: str
    before: CommunicationDiagram | None
    after: CommunicationDiagram | None
    composition: Compared | None
    changes: tuple[Change, ...]


@record
class Difference:
    """All changes in the order of the text, and the diagrams that changed. ``uncompared`` are the definitions that only
    one version has while the other could not be read whole, so that they may be there, too.
    """

    changes: tuple[Change, ...] = ()
    diagrams: tuple[Pair, ...] = ()
    uncompared: tuple[str, ...] = ()


def differences(
    before: Program, after: Program, *, whole: tuple[bool, bool] = (True, True), imported: bool = True
) -> Difference:
    """What changed from one version to the next; doc comments, layout of the text and order of declarations do not
    count. ``whole``: whether each version was read whole, without definitions that have syntax errors; ``imported``:
    whether definitions of imported files count.
    """
    return _Comparison(Pictures(before), Pictures(after), *whole, imported).difference()


class _Comparison:
    def __init__(
        self, before: Pictures, after: Pictures, before_is_whole: bool, after_is_whole: bool, imported: bool
    ) -> None:
        self.before = before
        self.after = after
        self.before_is_whole = before_is_whole
        self.after_is_whole = after_is_whole
        self.old = before.program.definitions if imported else _own_definitions(before.program)
        self.new = after.program.definitions if imported else _own_definitions(after.program)
        self.names = self._renamed_definitions()
        """New names of definitions that were renamed."""

    def difference(self) -> Difference:
        changes: list[Change] = []
        diagrams: list[Pair] = []
        uncompared: list[str] = []
        former = {new: old for old, new in self.names.items()}
        for name, definition in self.new.items():
            old = self.old.get(former.get(name, name))
            if old is not None and type(old) is not type(definition):
                old = None
            if old is None and not self.before_is_whole:
                uncompared.append(f"{kind_of(definition)} {name}")
                continue
            self._definition(name, old, definition, changes, diagrams)
        for name, definition in self.old.items():
            kept = self.new.get(self.names.get(name, name))
            if type(kept) is type(definition):
                continue
            if not self.after_is_whole:
                uncompared.append(f"{kind_of(definition)} {name}")
                continue
            self._definition(name, definition, None, changes, diagrams)
        if self.before_is_whole and self.after_is_whole:
            changes += self._assertions()
        order = ["const", "parameter", *list(KINDS.values())[1:]]
        changes.sort(key=lambda change: order.index(change.kind) if change.kind in order else len(order))
        return Difference(tuple(changes), tuple(diagrams), tuple(uncompared))

    def _definition(
        self,
        name: str,
        old: ast.Definition | None,
        new: ast.Definition | None,
        changes: list[Change],
        diagrams: list[Pair],
    ) -> None:
        shown = new or old
        assert shown is not None
        kind = kind_of(shown)
        whole = Change(
            action="changed",
            kind=kind,
            definition=name,
            span_before=None if old is None else old.name.span,
            span_after=None if new is None else new.name.span,
        )
        found: list[Change] = []
        if old is None or new is None:
            found.append(
                replaced(
                    whole,
                    action="added" if old is None else "removed",
                    before=None if old is None else _header(old),
                    after=None if new is None else _header(new),
                )
            )
        elif old.name.text != name:
            found.append(replaced(whole, action="renamed", before=old.name.text, after=name))
        first = self._diagram(self.before, old)
        second = self._diagram(self.after, new)
        names: dict[str, str] = {}
        if old is not None and new is not None:
            own_before, own_after = definition_parts(old), definition_parts(new)
            if first is not None and second is not None:
                first, names, renames = self._aligned(first, second, kind, name)
                found += renames
                own_before |= diagram_parts(first, _parameters(self.before.program, self.names))
                own_after |= diagram_parts(second, _parameters(self.after.program))
            if isinstance(new, ast.SubmodelDefinition):
                own_names = part_renames(own_before, own_after)
                found += _renamed_parts(whole, own_names, own_before, own_after)
                own_before = with_new_names(own_before, own_names)
            found += compare(kind, name, own_before, own_after)
        composition = self._composition(old, new, names)
        if composition is not None and old is not None and new is not None:
            found += _composition_changes(composition, old, new, whole)
        changes += found
        if found and (first is not None or second is not None):
            diagrams.append(Pair(name, first, second, composition, tuple(found)))

    def _diagram(self, pictures: Pictures, definition: ast.Definition | None) -> CommunicationDiagram | None:
        return pictures.communication(definition) if isinstance(definition, Drawn) else None

    def _aligned(
        self, before: CommunicationDiagram, after: CommunicationDiagram, kind: str, definition: str
    ) -> tuple[CommunicationDiagram, dict[str, str], list[Change]]:
        """The earlier diagram with the names of the later one, those names, and the renames as changes."""
        before = renamed(before, {}, self.names)
        names = vertex_renames(before, after)
        spans = {vertex.key: vertex.spans for vertex in (*before.vertices, *after.vertices)}
        changes = [
            Change(
                action="renamed",
                kind=kind,
                definition=definition,
                subject=_subject(after, new),
                name=new,
                before=old,
                after=new,
                key=new,
                span_before=next(iter(spans[old]), None),
                span_after=next(iter(spans[new]), None),
            )
            for old, new in names.items()
        ]
        return with_matched_arrows(renamed(before, names, {}), after), names, changes

    def _composition(
        self, old: ast.Definition | None, new: ast.Definition | None, names: Mapping[str, str]
    ) -> Compared | None:
        before, after = (
            composition_diagram(pictures.program.definitions, each)
            if isinstance(each, ast.ProcessDefinition) and each.composition is not None
            else None
            for pictures, each in ((self.before, old), (self.after, new))
        )
        shown = after or before
        if shown is None:
            return None
        empty = CompositionDiagram(key=shown.key, root=None)
        return compared(before or empty, after or empty, names)

    def _assertions(self) -> list[Change]:
        before, after = (
            {texts.meaning(_assertion(item)): (_assertion(item), item) for item in pictures.program.assertions}
            for pictures in (self.before, self.after)
        )
        removed = [
            Change(action="removed", kind="assert", definition=text, span_before=item.span, before=text)
            for meaning, (text, item) in before.items()
            if meaning not in after
        ]
        added = [
            Change(action="added", kind="assert", definition=text, span_after=item.span, after=text)
            for meaning, (text, item) in after.items()
            if meaning not in before
        ]
        return removed + added

    def _renamed_definitions(self) -> dict[str, str]:
        if not (self.before_is_whole and self.after_is_whole):
            return {}
        removed = [item for name, item in self.old.items() if type(self.new.get(name)) is not type(item)]
        added = [item for name, item in self.new.items() if type(self.old.get(name)) is not type(item)]
        old = {id(item): self._content(self.before, item) for item in removed}
        new = {id(item): self._content(self.after, item) for item in added}
        found: dict[str, str] = {}
        for first, second in pairs(removed, added, kind_of):
            one, other = old[id(first)], new[id(second)]
            if one and len(one & other) >= ALIKE * max(len(one), len(other)):
                found[first.name.text] = second.name.text
        for first, second in pairs(removed, added, lambda item: (type(item), old.get(id(item), new.get(id(item))))):
            if old[id(first)]:
                found[first.name.text] = second.name.text
        return found

    def _content(self, pictures: Pictures, definition: ast.Definition) -> frozenset[tuple[str, ...]]:
        """Everything about a definition except its name."""
        parts = definition_parts(definition)
        diagram = self._diagram(pictures, definition)
        if diagram is not None:
            parts |= diagram_parts(diagram, _parameters(pictures.program))
        found: set[tuple[str, ...]] = {
            (*key, aspect, *texts.meaning(value))
            for key, part in parts.items()
            for aspect, value in part.aspects.items()
            if value
        }
        if isinstance(definition, ast.ProcessDefinition) and definition.composition is not None:
            found.add(("composition", *texts.meaning(texts.written(definition.composition))))
        return frozenset(found)


def _renamed_parts(whole: Change, names: Mapping[tuple[str, str], str], before: Parts, after: Parts) -> list[Change]:
    return [
        replaced(
            whole,
            action="renamed",
            subject=subject,
            name=new,
            before=old,
            after=new,
            span_before=before[subject, old].span if (subject, old) in before else None,
            span_after=after[subject, new].span,
        )
        for (subject, old), new in names.items()
    ]


def _composition_changes(
    composition: Compared, old: ast.Definition, new: ast.Definition, whole: Change
) -> list[Change]:
    """The change of the whole composition, and of each of its steps; empty if the two are the same."""
    if (
        not composition.changes
        or not isinstance(old, ast.ProcessDefinition)
        or not isinstance(new, ast.ProcessDefinition)
    ):
        return []
    before, after = texts.optional(old.composition), texts.optional(new.composition)
    places = (old.composition_span, new.composition_span)
    spans = {"span_before": places[0], "span_after": places[1]}
    found = [replaced(whole, subject="composition", before=before, after=after, **spans)]
    for step in composition.changes:
        found.append(
            replaced(
                whole,
                action=step.action,
                subject="composition",
                name=step.subject,
                before=step.before,
                after=step.after,
                span_before=step.span_before,
                span_after=step.span_after,
            )
        )
    return found


def _own_definitions(program: Program) -> dict[str, ast.Definition]:
    """The definitions of the file itself."""
    source = program.main.source
    return {name: item for name, item in program.definitions.items() if item.name.span.source is source}


def _subject(diagram: CommunicationDiagram, key: str) -> str:
    return next((subject for (subject, name) in diagram_parts(diagram, {}) if name == key), "")


def _parameters(program: Program, names: Mapping[str, str] | None = None) -> dict[str, tuple[str, ...]]:
    """The names of the parameters of each definition, which may have a new name."""
    return {
        (names or {}).get(name, name): tuple(parameter.name.text for parameter in getattr(item, "parameters", ()))
        for name, item in program.definitions.items()
    }


def _header(definition: ast.Definition) -> str:
    """A definition in a line."""
    match definition:
        case ast.ProcessDefinition() | ast.SubmodelDefinition() | ast.DriverDefinition():
            parameters = ", ".join(texts.parameters(definition.parameters))
            return f"{definition.name.text}({parameters})" if parameters else definition.name.text
        case ast.EnvironmentDefinition():
            return f"{definition.name.text} for {definition.process.text}"
        case ast.Constant():
            return f"{definition.name.text} = {texts.written(definition.value)}"
        case ast.TypeAliasDefinition():
            return f"{definition.name.text} = {texts.written(definition.type)}"
        case ast.EnumDefinition() | ast.StructDefinition() | ast.ExceptionDefinition():
            return definition.name.text
        case _:
            assert_never(definition)


def _assertion(item: ast.Assertion) -> str:
    return texts.written(item).removeprefix("assert ")
