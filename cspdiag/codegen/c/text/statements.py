"""C statements as trees, and their lines."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Iterator, Sequence
from typing import TypeAlias, assert_never

from cspdiag.base.record import record
from cspdiag.codegen.c.text.code import (
    CHANGES,
    CSP,
    INDENT,
    LINE_LENGTH,
    NOW,
    STEP,
    Atom,
    Call,
    Code,
    Own,
    assign,
    code,
    ignored,
    negated,
)
from cspdiag.codegen.c.text.documents import comment
from cspdiag.codegen.c.text.kernel import USES_KERNEL
from cspdiag.codegen.c.text.literals import in_comment
from cspdiag.codegen.shared.document import LINE, SOFT, Document, Fill, FirstThatFits, Nest, listed, render
from cspdiag.codegen.shared.trees import nodes

_LEAST_REMARK = 40
"""The columns that a comment may use at least, however deep its indentation."""

_SELF = Atom("self")
_KERNEL = (CSP, NOW, CHANGES)


@record
class Remark:
    """A comment on lines of its own."""

    text: str


@record
class Plain:
    """An expression statement, a definition or a jump. ``remark`` is written after it, or above it if the line would be
    too long.
    """

    code: Code
    end: str = ";"
    remark: str | None = None
    declares: bool = False


@record
class Wait:
    """The macro of the kernel in which the process can wait: it contains a ``case`` of the step function."""

    code: Code


@record
class Block:
    """Statements in braces, between ``head`` and ``tail``: the members of a struct, for example."""

    body: tuple[Statement, ...]
    head: str = ""
    tail: str = "}"


@record
class If:
    """A conditional statement; use `choose` to make one, which leaves no branch empty."""

    condition: Code
    then: tuple[Statement, ...]
    otherwise: tuple[Statement, ...] = ()


@record
class While:
    """A loop; without a condition it is an endless loop."""

    condition: Code | None
    body: tuple[Statement, ...]


@record
class For:
    """A loop that counts from ``begin`` up to, but not including, ``limit``; with a type, it declares its counter."""

    counter: Code
    limit: Code
    body: tuple[Statement, ...]
    begin: Code = Atom("0")
    type_name: str | None = None


@record
class DoWhile:
    """A loop that evaluates its condition after each iteration."""

    body: tuple[Statement, ...]
    condition: Code


@record
class Switch:
    """Branches by the text of their labels: ``case 0``, ``default``."""

    value: Code
    cases: tuple[tuple[str, tuple[Statement, ...]], ...]


@record
class Label:
    """The target of a ``goto``."""

    name: str


@record
class State:
    """A ``case`` of the step function."""

    name: str


@record
class Directive:
    """A line of the preprocessor."""

    text: str


@record
class Blank:
    """An empty line."""


@record
class Function:
    """A function; ``head`` is its return type and name."""

    head: str
    parameters: tuple[str, ...]
    body: tuple[Statement, ...]


Statement: TypeAlias = (
    "Function | Remark | Plain | Wait | Block | If | While | For | DoWhile | Switch | Label | State | Directive | Blank"
)


def run(function: Code | str, end: str = ";") -> Plain:
    """A statement that is an expression."""
    return Plain(code(function), end)


def store(target: Code | str, value: Code | str, remark: str | None = None) -> Plain:
    """``target = value;``."""
    return Plain(assign(target, value), remark=remark)


def with_kernel(statements: Sequence[Statement]) -> tuple[Statement, ...]:
    """The body of a function that is passed the kernel, whether or not it uses it."""
    return (*([] if mentions_kernel(statements) else [run(ignored(CSP))]), *statements)


def mentions_self(item: object) -> bool:
    """Whether an expression or statements use ``self``."""
    return any(isinstance(node, Own) or node == _SELF for node in nodes(item))


def mentions_kernel(item: object) -> bool:
    """Whether an expression or statements use ``csp``, the state of the run."""
    return any(node in _KERNEL or (isinstance(node, Call) and node.function in USES_KERNEL) for node in nodes(item))


def define(type_name: str, name: str, value: Code | str | None = None, remark: str | None = None) -> Plain:
    """``type name = value;``."""
    declared = code(f"{type_name} {name}" if not type_name.endswith("*") else f"{type_name}{name}")
    return Plain(declared if value is None else assign(declared, value), remark=remark, declares=True)


def goto(label: str) -> Plain:
    """``goto label;``."""
    return Plain(Goto(label))


def return_value(value: Code | str) -> Plain:
    """``return value;``."""
    return Plain(Return(code(value)))


@record
class Goto(Code):
    """``goto label``."""

    label: str

    def _document(self) -> Document:
        return f"goto {self.label}"


@record
class Return(Code):
    """``return value``, or ``return`` in a function without a result."""

    value: Code | None = None

    def _document(self) -> Document:
        return "return" if self.value is None else ("return ", self.value.document)


def return_if(condition: Code, value: Code | str | None = None) -> If:
    """``if (condition) return value;``."""
    return If(condition, (Plain(Return()) if value is None else return_value(value),))


def goto_if(condition: Code, label: str) -> If:
    """``if (condition) goto label;``."""
    return If(condition, (goto(label),))


def choose(condition: Code, then: Sequence[Statement], otherwise: Sequence[Statement] = ()) -> list[Statement]:
    """A conditional statement without empty branches. Comments of a branch that does nothing are left out if the other
    one does something: they would stand above the condition of that.
    """
    if has_effect(then):
        return [If(condition, tuple(then), tuple(otherwise) if has_effect(otherwise) else ())]
    if has_effect(otherwise):
        return [If(negated(condition), tuple(otherwise))]
    return [*then, *otherwise]


def has_effect(statements: Sequence[Statement]) -> bool:
    """Whether any of the statements does something."""
    return any(not isinstance(statement, Remark | Blank) for statement in statements)


def in_block(statements: Sequence[Statement]) -> list[Statement]:
    """Statements for use among others: in braces if they declare names."""
    declares = any(isinstance(statement, Plain) and statement.declares for statement in statements)
    return [Block(tuple(statements))] if declares else list(statements)


def jumps_to(label: str, statements: Sequence[Statement]) -> bool:
    """Whether anything in the statements jumps to a label: a ``goto``, or a macro of the kernel with the label as an
    argument.
    """
    return any(isinstance(node, Goto) and node.label == label for node in nodes(tuple(statements))) or any(
        isinstance(node, Call) and Atom(label) in node.arguments for node in nodes(tuple(statements))
    )


def can_wait(statements: Sequence[Statement]) -> bool:
    """Whether the statements contain a state of the step function."""
    return any(isinstance(node, Wait | State) for node in nodes(statements))


def signature(head: str, parameters: Sequence[str], tail: str = "") -> list[str]:
    """The head of a function; with ``;`` as ``tail``, its declaration."""
    given = Fill(listed(list(parameters) or ["void"]))
    end = f"){tail}"
    before, space, name = head.rpartition(" ")
    layouts: list[Document] = [(head, "(", Nest(STEP, given), end), (head, "(", Nest(STEP, (SOFT, given)), end)]
    if space:
        layouts.append((before, Nest(STEP, (LINE, name, "(", SOFT, given)), end))
    return render(FirstThatFits(tuple(layouts)), LINE_LENGTH)


def lines(statements: Iterable[Statement], depth: int = 0) -> list[str]:
    """The text of statements, as lines; a comment that says what the one above it says is left out."""
    given = list(statements)
    items = [item for before, item in zip([None, *given], given, strict=False) if _is_news(item, before)]
    return [line for position, item in enumerate(items) for line in _lines(item, depth, items, position + 1)]


def _is_news(item: Statement, before: Statement | None) -> bool:
    return not (isinstance(item, Remark) and item == before)


def _lines(statement: Statement, depth: int, items: Sequence[Statement], following: int) -> Iterator[str]:
    """The lines of a statement; those of ``items`` from position ``following`` on come after it."""
    indent = INDENT * depth
    match statement:
        case Remark(text=text):
            yield from _remark(text, indent)
        case Blank():
            yield ""
        case Directive(text=text):
            yield text
        case Function(head=head, parameters=parameters, body=body):
            yield from signature(head, parameters)
            yield from lines([Block(body)])
        case Label(name=name):
            yield f"{INDENT * (depth - 1)}{name}:{'' if _is_labelled(items, following) else ';'}"
        case State(name=name):
            yield f"{INDENT * (depth - 1)}case {name}:{'' if _is_labelled(items, following) else ';'}"
        case Plain():
            yield from _plain(statement, depth)
        case Wait(code=item):
            yield from _broken(item.document, depth)
        case Block(body=body, head=head, tail=tail):
            yield f"{indent}{head} {{" if head else f"{indent}{{"
            yield from lines(body, depth + 1)
            yield f"{indent}{tail}"
        case If():
            yield from _if(statement, depth, "")
        case While(condition=None, body=body):
            yield f"{indent}for (;;) {{"
            yield from lines(body, depth + 1)
            yield f"{indent}}}"
        case While(condition=condition, body=body):
            assert condition is not None
            yield from _broken(("while (", Nest(len(INDENT), condition.document), ") {"), depth)
            yield from lines(body, depth + 1)
            yield f"{indent}}}"
        case For():
            yield from _broken(_for(statement), depth)
            yield from lines(statement.body, depth + 1)
            yield f"{indent}}}"
        case DoWhile(body=body, condition=condition):
            yield f"{indent}do {{"
            yield from lines(body, depth + 1)
            yield from _broken(("} while (", Nest(len(INDENT), condition.document), ");"), depth)
        case Switch(value=value, cases=cases):
            yield from _broken(("switch (", value.document, ") {"), depth)
            for label, body in cases:
                yield f"{indent}{label}:"
                yield from lines(body, depth + 1)
            yield f"{indent}}}"
        case _:
            assert_never(statement)


def _is_labelled(items: Sequence[Statement], start: int) -> bool:
    """Whether the first statement from position ``start`` on can be labelled; a declaration cannot, and at the end
    there is none.
    """
    rest = (items[position] for position in range(start, len(items)))
    first = next((item for item in rest if not isinstance(item, Remark | Blank)), None)
    return first is not None and not isinstance(first, Directive) and not (isinstance(first, Plain) and first.declares)


def _if(statement: If, depth: int, before: str) -> Iterator[str]:
    indent = INDENT * depth
    head: Document = (f"{before}if (", Nest(len(INDENT), statement.condition.document), ") {")
    yield from _broken(head, depth)
    yield from lines(statement.then, depth + 1)
    match statement.otherwise:
        case ():
            yield f"{indent}}}"
        case (If() as inner,):
            yield from _if(inner, depth, "} else ")
        case otherwise:  # Statements of every kind, at least one.
            yield f"{indent}}} else {{"
            yield from lines(otherwise, depth + 1)
            yield f"{indent}}}"


def _for(loop: For) -> Document:
    counter = loop.counter.document
    declared = () if loop.type_name is None else (loop.type_name, " ")
    begin, limit = loop.begin.document, loop.limit.document
    head = (declared, counter, " = ", begin, "; ", counter, " < ", limit, "; ", counter, "++")
    return ("for (", Nest(len(INDENT), head), ") {")


def _plain(statement: Plain, depth: int) -> Iterator[str]:
    document = (statement.code.document, statement.end)
    found = _broken(document, depth)
    if statement.remark is None:
        yield from found
        return
    remark = f"/* {in_comment(statement.remark)} */"
    if len(found) == 1 and len(found[0]) + 1 + len(remark) <= LINE_LENGTH:
        yield f"{found[0]} {remark}"
    else:
        yield from (INDENT * depth + remark, *found)


def _broken(document: Document, depth: int) -> list[str]:
    return render(document, LINE_LENGTH, len(INDENT) * depth)


def _remark(text: str, indent: str) -> list[str]:
    width = max(LINE_LENGTH - len(indent) - 6, _LEAST_REMARK)
    return comment(textwrap.wrap(" ".join(text.split()), width, break_long_words=False) or [""], indent)
