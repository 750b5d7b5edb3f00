"""What is nested deeper than Python allows in one function continues in functions inside it.

CPython compiles at most 20 loops, ``try`` and ``with`` statements inside each other, 100 levels of indentation, and
between 100 and 200 brackets. A function inside begins each count anew, but for one level of indentation.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from functools import cached_property
from typing import TypeVar, assert_never

from cspdiag.base.record import field_names, is_record, replaced
from cspdiag.codegen.python.text.code import (
    Call,
    Code,
    Comprehension,
    Element,
    Entry,
    Formatted,
    Items,
    Name,
    Named,
    Parenthesized,
    Prefix,
    Starred,
    awaited,
    call,
    delegated,
    mentions,
)
from cspdiag.codegen.python.text.imports import Imports
from cspdiag.codegen.python.text.statements import (
    BREAK,
    YIELD,
    Assign,
    Block,
    Declare,
    For,
    Function,
    Plain,
    Remark,
    Statement,
    Statements,
    Unpack,
    lines,
    nonlocal_,
    return_,
    run,
)
from cspdiag.codegen.shared.trees import nodes

T = TypeVar("T")

MOST_BLOCKS = 16
"""Blocks of CPython inside each other in one function, of the 20 that it can compile."""

MOST_LEVELS = 20
"""Levels of indentation in one function."""

MOST_BRACKETS = 40
"""Brackets inside each other in one expression."""

_BLOCKS: Mapping[str, int] = {"while": 1, "try": 1, "with": 1, "except": 2, "finally": 2}
"""How many blocks a statement is: in a handler, the exception is one and the name that is bound to it another."""

_CONTINUING = ("elif", "else", "except", "finally")

_NAMES: Mapping[str, str] = {"while": "_loop", "try": "_attempt", "with": "_attempt"}

_DOC = "Continue: Python limits how deeply the statements of one function are nested."
_VALUE_DOC = "Compute a part of an expression: Python limits how deep it is nested."


def methods(functions: Iterable[Function], imports: Imports) -> list[list[str]]:
    """The lines of the methods of a class, each with the functions inside that it needs; ``imports`` are not complete
    before.
    """
    return [lines([split(function, imports)], "    ") for function in functions]


def split(function: Function, imports: Imports) -> Function:
    """The function with what is nested too deep in functions inside it, and these in front of the statement that needs
    them.
    """
    return _Splitting(function, imports, _PartNames(function)).result()


class _PartNames:
    """Names for the parts of a function, other than those that it mentions."""

    def __init__(self, function: Function) -> None:
        self._function = function

    @cached_property
    def _taken(self) -> set[str]:
        found = list(nodes(self._function))
        return {item.text for item in found if isinstance(item, Name)} | {
            item.name for item in found if isinstance(item, Function)
        }

    def fresh(self, wanted: str) -> str:
        """The name, or one like it that is not in use."""
        name, count = wanted, 1
        while name in self._taken:
            count += 1
            name = f"{wanted}_{count}"
        self._taken.add(name)
        return name


class _Splitting:
    """One function; ``names`` are for its parts and those of the functions around it."""

    def __init__(self, function: Function, imports: Imports, names: _PartNames) -> None:
        self.function = function
        self.imports = imports
        self.names = names
        self.shared: set[str] = set()
        """The local variables of the function that its parts assign."""
        self.parts: list[Function] = []
        """Those that the present statement of the function needs."""

    def result(self) -> Function:
        body: list[Statement] = []
        for compound in _compounds(self.function.body):
            self.parts = []
            whole = self._shallow(compound, 0, 1)
            body += [*self.parts, *whole]
        return replaced(self.function, body=(*self._declarations(tuple(body)), *body))

    def _declarations(self, body: Statements) -> Statements:
        """What makes local variables of the function of those that only its parts assign."""
        parameters = {parameter.partition(":")[0] for parameter in self.function.parameters}
        if not self.shared:
            return ()
        missing = sorted(self.shared - _assigned(body) - _named(tuple(_own_statements(body))) - parameters)
        return tuple([Declare(Name(name), self._anything()) for name in missing])

    def _anything(self) -> str:
        return self.imports.standard("typing", "Any")

    # Statements

    def _shallow(self, compound: Statements, blocks: int, level: int) -> Statements:
        """A statement and what continues it, inside this number of blocks and levels of indentation of a function."""
        return tuple([self._statement(statement, blocks, level) for statement in compound])

    def _statement(self, statement: Statement, blocks: int, level: int) -> Statement:
        if isinstance(statement, Function):
            return _Splitting(statement, self.imports, self.names).result()
        if not isinstance(statement, Block | For):
            return self._with_values(statement)
        blocks, level = blocks + _blocks(statement), level + 1
        body: list[Statement] = []
        for compound in _compounds(statement.body):
            if _is_too_deep(compound, blocks, level):
                body.append(self._part(compound))
            else:
                body += self._shallow(compound, blocks, level)
        return replaced(self._with_values(replaced(statement, body=())), body=tuple(body))

    def _part(self, compound: Statements) -> Statement:
        """The call of a function for a statement."""
        first = compound[0]
        name = self.names.fresh(_NAMES.get(first.keyword, "_branch") if isinstance(first, Block) else "_loop")
        assigned = _assigned(compound)
        awaits = {item.text for item in nodes(compound) if isinstance(item, Prefix)}
        is_generator = "yield from " in awaits or YIELD in nodes(compound)
        returns = self.function.returns if is_generator else "None"
        part = self._added(name, (), assigned, compound, returns, _DOC, waits="await " in awaits)
        called: Code = call(name)
        return run(delegated(called) if is_generator else awaited(called) if part.waits else called)

    def _added(
        self,
        name: str,
        parameters: tuple[str, ...],
        assigned: set[str],
        body: Statements,
        returns: str,
        doc: str,
        *,
        waits: bool = False,
    ) -> Function:
        self.shared |= assigned
        part = Function(name, parameters, (*nonlocal_(sorted(assigned)), *body), returns, doc, waits)
        self.parts.append(_Splitting(part, self.imports, self.names).result())
        return part

    # Expressions

    def _with_values(self, statement: Statement) -> Statement:
        """A statement of which no expression has too many brackets inside each other."""
        if _opening_brackets(statement) <= MOST_BRACKETS or _brackets(statement) <= MOST_BRACKETS:
            return statement
        return self._within(statement, 0, ())

    def _within(self, item: T, depth: int, counting: tuple[str, ...]) -> T:
        """An expression, or a part of one, inside this number of brackets and in the loops of these variables."""
        if isinstance(item, tuple):
            return tuple([self._within(part, depth, counting) for part in item])  # type: ignore[return-value]
        if not is_record(item):
            return item
        if depth >= MOST_BRACKETS and _is_value(item) and _brackets(item):
            return self._value(item, counting)  # type: ignore[arg-type, return-value]
        if isinstance(item, Comprehension):
            counting = (*counting, item.variable)
        depth += _is_bracketed(item)
        return replaced(
            item, **{name: self._within(getattr(item, name), depth, counting) for name in field_names(item)}
        )

    def _value(self, code: Code, counting: tuple[str, ...]) -> Code:
        """The call of a function for an expression."""
        name = self.names.fresh("_value")
        given = [variable for variable in counting if mentions(code, variable)]
        parameters = tuple([f"{variable}: int" for variable in given])
        self._added(name, parameters, _named(code), (return_(code),), self._anything(), _VALUE_DOC)
        return call(name, *map(Name, given))


def _compounds(statements: Statements) -> Iterator[Statements]:
    """Each statement with what continues it, such as the handlers of a ``try``."""
    compound: list[Statement] = []
    for statement in statements:
        continues = isinstance(statement, Block) and statement.keyword in _CONTINUING
        if compound and not continues:
            yield tuple(compound)
            compound = []
        compound.append(statement)
    if compound:
        yield tuple(compound)


def _is_too_deep(compound: Statements, blocks: int, level: int) -> bool:
    """Whether a statement inside this number of blocks and levels of indentation has to be a function of its own."""
    first = compound[0]
    if not isinstance(first, Block | For) or (isinstance(first, Block) and first.keyword == "case"):
        return False
    deepest = blocks + max(map(_blocks, compound))
    levels = level + (2 if isinstance(first, Block) and first.keyword == "match" else 1)
    return (deepest > MOST_BLOCKS or levels > MOST_LEVELS) and not _leaves(compound)


def _blocks(statement: Statement) -> int:
    if isinstance(statement, For):
        return 1
    return _BLOCKS.get(statement.keyword, 0) if isinstance(statement, Block) else 0


def _leaves(compound: Statements) -> bool:
    """Whether a ``break`` inside ends a loop outside, or a ``return`` the function."""
    for statement in compound:
        if statement == BREAK or (isinstance(statement, Plain) and statement.keyword == "return"):
            return True
        is_loop = isinstance(statement, For) or (isinstance(statement, Block) and statement.keyword == "while")
        if isinstance(statement, Block | For) and not is_loop and _leaves(statement.body):
            return True
    return False


def _assigned(statements: Statements) -> set[str]:
    """The local variables of a function that its statements assign or declare; those of loops are separate."""
    found: set[str] = set()
    for item in _own_statements(statements):
        match item:
            case Assign(target=Name(text=name)) | Declare(target=Name(text=name)):
                found.add(name)
            case Unpack(targets=targets) | Plain(keyword="nonlocal", code=Items(items=targets)):
                found.update([target.text for target in targets if isinstance(target, Name)])
            case _:  # Any other statement assigns nothing that outlives it.
                pass
    return found


def _own_statements(statements: Statements) -> Iterator[Statement]:
    """All statements, each without its body, and without those of functions inside."""
    for item in statements:
        if isinstance(item, Block | For):
            yield replaced(item, body=())
            yield from _own_statements(item.body)
        elif not isinstance(item, Function):
            yield item


def _named(item: object) -> set[str]:
    """The variables that expressions assign."""
    return {node.name for node in nodes(item) if isinstance(node, Named)}


def _is_value(item: object) -> bool:
    """Whether an expression can be what a function returns."""
    waits = any(isinstance(node, Prefix) and node.text in ("await ", "yield from ") for node in nodes(item))
    return isinstance(item, Code) and not isinstance(item, Entry | Named | Starred) and not waits


def _opening_brackets(statement: Statement) -> int:
    """The largest number of brackets in an expression of a statement: seldom enough that their nesting matters."""
    match statement:
        case Plain(code=value) | Block(code=value) | For(items=value) | Assign(value=value) | Unpack(value=value):
            text = "" if value is None else value.flat
            return text.count("(") + text.count("[") + text.count("{")
        case Remark() | Declare() | Function():
            return 0
    assert_never(statement)


def _brackets(item: object) -> int:
    """How many brackets are inside each other, in the expressions of a statement but not in those of its body."""
    if isinstance(item, tuple):
        return max(map(_brackets, item), default=0)
    if not is_record(item):
        return 0
    inner = max([_brackets(getattr(item, name)) for name in field_names(item)], default=0)
    return inner + _is_bracketed(item)


def _is_bracketed(item: object) -> bool:
    if isinstance(item, Items):
        return bool(item.brackets)
    return isinstance(item, Call | Parenthesized | Comprehension | Element | Formatted)
