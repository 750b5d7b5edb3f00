"""Repeated steps in long step functions: a loop where their numbers count, and a loop over a table where they do not.

Fusion knows the order of the steps of some processes, so it writes them one after another; many of them differ only in
the numbers of channels, elements and values.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import count

from cspdiag.base.record import record, replaced
from cspdiag.codegen.c.process.divided import LONGEST
from cspdiag.codegen.c.process.routines import Routine
from cspdiag.codegen.c.text.code import Aggregate, Atom, Code, Count, unsigned
from cspdiag.codegen.c.text.names import Names
from cspdiag.codegen.c.text.rolling import VARIABLE, loop
from cspdiag.codegen.c.text.statements import (
    Blank,
    Block,
    DoWhile,
    For,
    Goto,
    If,
    Plain,
    Remark,
    Return,
    Statement,
    While,
    can_wait,
    define,
)
from cspdiag.codegen.shared.trees import LEAST, Outline, numbers_in, outline, refilled, repetitions_from

_WIDTHS = (8, 16, 32)
"""Of the integers in tables."""


@record
class _Group:
    """A step: its comment, and statements among which the process does not wait."""

    remark: Remark
    statements: tuple[Statement, ...]
    outline: Outline


@record
class _Column:
    """Numbers that change from row to row."""

    name: str
    type_name: str


@record
class _Table:
    """The numbers of all steps of one shape."""

    name: str
    columns: dict[int, _Column]
    """By the positions of the numbers in a step; those that are always the same are in no column."""
    rows: list[tuple[tuple[Count, ...], str]]
    """The numbers of each step in a loop, and its comment."""

    def definitions(self, struct: str) -> list[Statement]:
        """The structure of a row, and the table."""
        wanted = {column.name: position for position, column in reversed(self.columns.items())}
        names = [*dict.fromkeys(column.name for column in self.columns.values())]
        members = tuple(define(self.columns[wanted[name]].type_name, name) for name in names)
        rows: list[Statement] = []
        for numbers, step in self.rows:
            values = [(None, _literal(numbers[wanted[name]])) for name in names]
            end = "" if len(rows) + 1 == len(self.rows) else ","
            rows.append(Plain(Aggregate(tuple(values)), end, " ".join(step.split())))
        head = f"static const struct {struct} {self.name}[] ="
        remark = Remark("Steps of the process that differ only in these numbers, in their order.")
        return [remark, Block(members, f"struct {struct}", "};"), Blank(), Block(tuple(rows), head, "};"), Blank()]


def roll_repeated(routine: Routine, tables: list[Statement]) -> None:
    """Rolls repeated steps of a step function that is too long, and adds the ``tables`` that its loops use."""
    if len(routine.text()) <= LONGEST:
        return
    rolling = _Rolling(routine, {})
    rolling.note(routine.body)
    routine.body = rolling.rolled(routine.body)
    for table in rolling.tables.values():
        if table.rows:
            tables += table.definitions(routine.states.fresh(f"{table.name}_row"))


@record
class _Rolling:
    routine: Routine
    tables: dict[object, _Table]
    """By the shape of their steps."""

    def note(self, statements: Sequence[Statement]) -> None:
        """Finds the tables that the steps would need."""
        found: dict[object, list[_Group]] = {}
        for group in _all_groups(statements):
            found.setdefault(group.outline.shape, []).append(group)
        for shape, groups in found.items():
            if len(groups) >= LEAST:
                rows = [tuple(numbers_in(group.statements)) for group in groups]
                self.tables[shape] = _Table(self.routine.states.fresh(f"{self.routine.name}_steps"), _columns(rows), [])

    def rolled(self, statements: Sequence[Statement]) -> list[Statement]:
        """The statements with loops for repeated steps, also inside loops and branches."""
        result: list[Statement] = []
        for alike in _runs(statements):
            if not isinstance(alike, list):
                result.append(self._inside(alike))
            elif len(alike) < LEAST:
                result += [statement for group in alike for statement in (group.remark, *group.statements)]
            else:
                result += self._loop(alike)
        return result

    def _inside(self, statement: Statement) -> Statement:
        match statement:
            case While() | DoWhile() | For() | Block():
                return replaced(statement, body=tuple(self.rolled(statement.body)))
            case If(then=then, otherwise=otherwise):
                return replaced(statement, then=tuple(self.rolled(then)), otherwise=tuple(self.rolled(otherwise)))
            case _:  # Statements without others in them.
                return statement

    def _loop(self, groups: Sequence[_Group]) -> list[Statement]:
        first, second = groups[:2]
        times, _ = repetitions_from([group.outline for group in groups], 0, 1, any)
        if times == len(groups):
            return [first.remark, loop(first.statements, second.statements, times)]
        table = self.tables[first.outline.shape]
        begin = len(table.rows)
        table.rows.extend((tuple(numbers_in(group.statements)), group.remark.text) for group in groups)
        row = Atom(table.name).at(Atom(VARIABLE))
        positions = count()

        def made(number: Count, _: object) -> Code:
            column = table.columns.get(next(positions))
            return number if column is None else row.field(column.name)

        body = refilled(first.statements, made)
        return [For(Atom(VARIABLE), unsigned(len(table.rows)), body, unsigned(begin), "uint32_t")]


def _columns(rows: Sequence[Sequence[Count]]) -> dict[int, _Column]:
    """Equal columns are one."""
    names = Names(())
    made: dict[tuple[int, ...], _Column] = {}
    columns: dict[int, _Column] = {}
    for position, numbers in enumerate(zip(*rows, strict=True)):
        values = tuple(number.value for number in numbers)
        if len(set(values)) > 1:
            if values not in made:
                form = numbers[0].form
                name = names.fresh({"index": "element", "unsigned": "number", "argument": "value"}[form])
                made[values] = _Column(name, _type_name(max(values), signed=form == "argument"))
            columns[position] = made[values]
    return columns


def _literal(number: Count) -> Code:
    return unsigned(number.value) if number.form == "index" else number


def _type_name(largest: int, *, signed: bool) -> str:
    width = next((width for width in _WIDTHS if largest < 1 << (width - signed)), 64)
    return f"{'' if signed else 'u'}int{width}_t"


def _runs(statements: Sequence[Statement]) -> Iterator[list[_Group] | Statement]:
    """The statements, with consecutive steps that are alike together."""
    alike: list[_Group] = []
    for item in _groups(statements):
        if alike and not (isinstance(item, _Group) and item.outline.shape == alike[0].outline.shape):
            yield alike
            alike = []
        if isinstance(item, _Group):
            alike.append(item)
        else:
            yield item
    if alike:
        yield alike


def _groups(statements: Sequence[Statement]) -> Iterator[_Group | Statement]:
    """The statements, with those of each step together."""
    position = 0
    while position < len(statements):
        statement = statements[position]
        end = position + 1
        while end < len(statements) and _is_of_step(statements[end]):
            end += 1
        if isinstance(statement, Remark) and end > position + 1:
            inside = tuple(statements[position + 1 : end])
            yield _Group(statement, inside, outline(inside))
            position = end
        else:
            yield statement
            position += 1


def _is_of_step(statement: Statement) -> bool:
    """Whether a statement may belong to a step that is repeated: the process does not wait in it, or leave."""
    match statement:
        case Block():
            return not can_wait([statement])
        case Plain(code=code):
            return not isinstance(code, Goto | Return)
        case _:  # Comments, places to which something jumps, and what contains further steps.
            return False


def _all_groups(statements: Sequence[Statement]) -> Iterator[_Group]:
    for item in _groups(statements):
        match item:
            case _Group():
                yield item
            case While(body=body) | DoWhile(body=body) | For(body=body) | Block(body=body):
                yield from _all_groups(body)
            case If(then=then, otherwise=otherwise):
                yield from _all_groups((*then, *otherwise))
            case _:  # Statements without others in them.
                pass
