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
from cspdiag.codegen.c.text.code import CSP, Aggregate, Atom, Call, Code, Count, ignored, unsigned
from cspdiag.codegen.c.text.kernel import KERNEL
from cspdiag.codegen.c.text.names import Names
from cspdiag.codegen.c.text.rolling import VARIABLE, loop
from cspdiag.codegen.c.text.statements import (
    Blank,
    Block,
    Directive,
    DoWhile,
    For,
    Function,
    Goto,
    If,
    Plain,
    Remark,
    Return,
    Statement,
    While,
    can_wait,
    define,
    run,
    store,
)
from cspdiag.codegen.shared.trees import LEAST, Outline, nodes, numbers_in, outline, refilled, repetitions_from

_CLOSING = ("csp_observe_end", "csp_ends_close")
"""What a process does after its last step."""

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
    is_reported: bool = False
    """Whether only traces need it."""


@record
class _Table:
    """The numbers of all steps of one shape."""

    name: str
    columns: dict[int, _Column]
    """By the positions of the numbers in a step; those that are always the same are in no column."""
    rows: list[tuple[tuple[Count, ...], str]]
    """The numbers of each step in a loop, and its comment."""
    functions: list[Statement]
    """The function that takes the steps of some rows, unless these may jump."""

    def definitions(self, struct: str) -> list[Statement]:
        """The structure of a row, the table, what only traces need, and the function that takes its steps."""
        first: dict[str, int] = {}
        for position, column in self.columns.items():
            first.setdefault(column.name, position)
        kept = [position for position in first.values() if not self.columns[position].is_reported]
        rows: list[Statement] = []
        for numbers, step in self.rows:
            values = [(None, _literal(numbers[position])) for position in kept]
            end = "" if len(rows) + 1 == len(self.rows) else ","
            rows.append(Plain(Aggregate(tuple(values)), end, " ".join(step.split())))
        members = tuple(define(self.columns[position].type_name, self.columns[position].name) for position in kept)
        head = f"static const struct {struct} {self.name}[] ="
        remark = Remark("Steps of the process that differ only in these numbers, in their order.")
        row = Block(members, f"struct {struct}", "};")
        statements: list[Statement] = [remark]
        statements += [row, Blank(), Block(tuple(rows), head, "};"), Blank()] if kept else []
        for position in first.values():
            column = self.columns[position]
            if column.is_reported:
                values = [(None, _literal(numbers[position])) for numbers, _ in self.rows]
                array = store(f"static const {column.type_name} {self.array(column)}[]", Aggregate(tuple(values)))
                statements += [Directive("#if CSP_TRACE"), array, Directive("#endif"), Blank()]
        return [*statements, *self.functions]

    def array(self, column: _Column) -> str:
        """The name of the array of a column that only traces need."""
        return f"{self.name}_{column.name}"

    def element(self, column: _Column) -> Code:
        """The number in the row of a loop."""
        index = Atom(VARIABLE)
        if column.is_reported:
            return Atom(self.array(column)).at(index)
        return Atom(self.name).at(index).field(column.name)


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
                name = self.routine.states.fresh(f"{self.routine.name}_steps")
                self.tables[shape] = _Table(name, _columns(rows, _reported(groups[0].statements)), [], [])

    def rolled(self, statements: Sequence[Statement]) -> list[Statement]:
        """The statements with loops for repeated steps, also inside loops and branches."""
        result: list[Statement] = []
        for alike in _runs(statements):
            if not isinstance(alike, list):
                result.append(self._inside(alike))
            elif len(alike) < self._least(alike[0]):
                result += [statement for group in alike for statement in (group.remark, *group.statements)]
            else:
                result += self._loop(alike)
        return result

    def _least(self, group: _Group) -> int:
        """The least number of steps that are worth a loop: fewer, if there is a function for it."""
        table = self.tables.get(group.outline.shape)
        return LEAST if table is None or not table.functions else LEAST - 1

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
        if times == len(groups) >= LEAST:
            return [first.remark, loop(first.statements, second.statements, times)]
        table = self.tables[first.outline.shape]
        begin = len(table.rows)
        table.rows.extend((tuple(numbers_in(group.statements)), group.remark.text) for group in groups)
        positions = count()

        def made(number: Count, _: object) -> Code:
            column = table.columns.get(next(positions))
            return number if column is None else table.element(column)

        body = refilled(first.statements, made)
        limits = unsigned(begin), unsigned(len(table.rows))
        if self.routine.number is not None or any(isinstance(node, Goto) for node in nodes(body)):
            return [_counted(limits[0], limits[1], body)]
        if not table.functions:
            table.functions.extend(self._function(f"{self.routine.name}_takes_steps", body))
        (function, *_) = table.functions
        assert isinstance(function, Function)
        name = function.head.rpartition(" ")[2]
        return [run(Call(name, (CSP, Atom("party"), *limits)))]

    def _function(self, name: str, body: tuple[Statement, ...]) -> list[Statement]:
        """The function that takes the steps of the rows from ``begin`` to before ``end``."""
        parameters = (KERNEL, "csp_party *party", "uint32_t begin", "uint32_t end")
        own = self.routine.locals(body)
        loop = _counted(Atom("begin"), Atom("end"), body)
        # Without traces nothing in it may need the kernel.
        whole = (*own[:-1], run(ignored(CSP)), *own[-1:], loop)
        return [Function(f"static void {self.routine.states.fresh(name)}", parameters, whole), Blank()]


def _counted(begin: Code, end: Code, body: tuple[Statement, ...]) -> For:
    return For(Atom(VARIABLE), end, body, begin, "uint32_t")


def _columns(rows: Sequence[Sequence[Count]], reported: frozenset[int]) -> dict[int, _Column]:
    """The columns of the numbers that are not always the same; equal ones are one. Those at the positions ``reported``
    are needed by traces.
    """
    names = Names(())
    positions: dict[tuple[int, ...], list[int]] = {}
    for position, numbers in enumerate(zip(*rows, strict=True)):
        positions.setdefault(tuple(number.value for number in numbers), []).append(position)
    columns: dict[int, _Column] = {}
    for values, equal in positions.items():
        if len(set(values)) > 1:
            form = rows[0][equal[0]].form
            name = names.fresh({"index": "element", "unsigned": "number", "argument": "value"}[form])
            column = _Column(name, _type_name(max(values), signed=form == "argument"), reported.issuperset(equal))
            columns.update(dict.fromkeys(equal, column))
    return columns


def _reported(statements: Sequence[Statement]) -> frozenset[int]:
    """The positions of numbers in reports for traces."""
    found: set[int] = set()
    position = 0
    for statement in statements:
        end = position + len(numbers_in((statement,)))
        match statement:
            case Plain(code=Call(function="CSP_REPORT")):
                found.update(range(position, end))
            case _:  # Everything else is needed always.
                pass
        position = end
    return frozenset(found)


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
        case Plain(code=Call(function=function)):
            return function not in _CLOSING
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
