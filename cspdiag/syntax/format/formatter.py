"""The standard format of programs: indentation by two spaces, lines of up to 120 characters.

The formatter changes only the space between tokens; parentheses, order and comments stay as they are.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import assert_never

from cspdiag.syntax import ast
from cspdiag.syntax.format.columns import Columns
from cspdiag.syntax.format.communication import CommunicationFormatter
from cspdiag.syntax.format.composition import CompositionFormatter
from cspdiag.syntax.format.layout import SPACE, TWO_SPACES, render
from cspdiag.syntax.format.writer import Writer
from cspdiag.syntax.parse.nesting import raised_recursion_limit


def format_tree(tree: ast.SourceTree) -> str:
    """The text of a file in the standard format; the file must not have syntax errors."""
    writer = Writer(tree.source.text)
    with raised_recursion_limit():
        _Formatter(writer).file(tree)
    return render(writer.pieces)


_BLOCKS = (ast.ProcessDefinition, ast.SubmodelDefinition, ast.DriverDefinition, ast.EnvironmentDefinition)


class _Formatter(CommunicationFormatter, CompositionFormatter):
    def file(self, tree: ast.SourceTree) -> None:
        """All items; definitions with a block have empty lines around them."""
        previous: ast.Item | None = None
        for item in tree.items:
            apart = previous is not None and (isinstance(item, _BLOCKS) or isinstance(previous, _BLOCKS))
            self.writer.begin_line(blank=True if apart else None)
            self._item(item)
            previous = item
        self.writer.begin_line()

    def _item(self, node: ast.Item) -> None:
        match node:
            case ast.Import(library=library):
                self.token()
                self.token(" ")
                if library is not None:
                    for _ in range(2 * library.count(".")):
                        self.token()
            case ast.Constant(type=constant_type, value=value):
                self.token()
                self.token(" ")
                if constant_type is not None:
                    self.token(" ")
                    self.type_name(constant_type, " ")
                self.token(" ")
                self.expression(value, " ")
            case ast.TypeAliasDefinition(type=meant):
                self.token()
                self.token(" ")
                self.token(" ")
                self.type_name(meant, " ")
            case ast.EnumDefinition(literals=literals):
                self._enum(literals)
            case ast.StructDefinition(fields=fields):
                self._struct(fields)
            case ast.ExceptionDefinition():
                self.token()
                self.token(" ")
            case ast.Assertion():
                self._assertion(node)
            case ast.ProcessDefinition():
                self._process(node)
            case ast.SubmodelDefinition():
                self._submodel(node)
            case ast.DriverDefinition(parameters=parameters, ports=ports):
                self._head(parameters)
                self._clauses({})
                with self.writer.block():
                    self.ports(ports)
            case ast.EnvironmentDefinition():
                self._environment(node)
            case _:
                assert_never(node)

    def _enum(self, literals: Sequence[ast.Identifier]) -> None:
        self.token()
        self.token(" ")
        self.token(" ")
        with self.writer.group():
            self.writer.keep_broken()
            with self.writer.indented():
                for position in range(len(literals)):
                    if position:
                        self.token()
                    self.token(SPACE)
                self.writer.comments()
            self.token(SPACE)

    def _struct(self, fields: Sequence[ast.Field]) -> None:
        self.token()
        self.token(" ")
        self.token(" ")
        with self.writer.group():
            self.writer.keep_broken()
            with self.writer.indented():
                for position, field in enumerate(fields):
                    self.token(TWO_SPACES if position else SPACE)
                    self.token()
                    self.type_name(field.type, " ")
                self.writer.comments()
            self.token(SPACE)

    def _assertion(self, node: ast.Assertion) -> None:
        self.token()
        self.token(" ")
        self.token(" ")
        if node.property in {"deadlock free", "livelock free", "refines"}:
            self.token(" ")
        if self.writer.next == "in" and node.model == "failures":
            self.token(" ")
            self.token(" ")
        if node.hidden:
            self._hidden(len(node.hidden))

    def _hidden(self, number: int) -> None:
        """``hide`` with this number of ports, on a line of its own if the assertion is too long."""
        with self.writer.group(), self.writer.indented():
            self.token(SPACE)
            with self.writer.group(), self.writer.indented():
                for position in range(number):
                    if position:
                        self.token()
                    self.token(SPACE if position else " ")
                self.writer.comments()

    def _head(self, parameters: Sequence[ast.Parameter]) -> None:
        """The head of a definition, up to the opening brace."""
        self.token()
        self.token(" ")
        if self.writer.next == "(":
            self.parameters(parameters)

    def _clauses(self, clauses: Mapping[str, ast.Expression | None]) -> None:
        """The clauses of a head, in the order of the text."""
        while self.writer.next != "{":
            clause = clauses.get(self.writer.next)
            # Otherwise `method = tustin`, `on miss count` or `python "file.py:Class"`.
            if self.writer.next == "place":
                self._place()
                continue
            words = 3 if self.writer.next in {"method", "on"} else 2
            self.token(" ")
            if clause is not None:
                self.expression(clause, " ")
                continue
            self.token(" ")
            if words == 3:
                self.token(" ")

    def _place(self) -> None:
        """``place pan : horizontal, camera``."""
        for _ in range(4):
            self.token(" ")
        while self.writer.next == ",":
            self.token()
            self.token(" ")

    def _process(self, node: ast.ProcessDefinition) -> None:
        self._head(node.parameters)
        self._clauses({"wcet": node.wcet})
        with self.writer.block():
            self.ports(node.ports)
            has_parts = bool(node.ports)
            if node.communication is not None:
                self.writer.begin_line(blank=has_parts)
                self.token()
                with self.writer.block():
                    self.declarations(node.communication.declarations)
                has_parts = True
            if node.composition is not None:
                self.writer.begin_line(blank=has_parts)
                self.token()
                with self.writer.block():
                    self.writer.begin_line()
                    self.composition(node.composition)

    def _submodel(self, node: ast.SubmodelDefinition) -> None:
        self._head(node.parameters)
        self._clauses({"wcet": node.wcet, "step": node.step})
        with self.writer.block():
            self.ports(node.ports)
            columns = Columns(self.writer)
            for position, item in enumerate(node.items):
                self._equation(item, columns, blank=True if position == 0 and node.ports else None)
            columns.end()

    def _equation(self, node: ast.SubmodelItem, columns: Columns, *, blank: bool | None) -> None:
        match node:
            case ast.Instance():
                columns.begin_row("instance", blank=blank)
                self.instance(node, columns)
            case ast.State(type=state_type, initial=initial):
                columns.begin_row("state", blank=blank)
                self.typed_name(state_type, initial, columns)
            case ast.Let(value=value) | ast.Next(value=value) | ast.Derivative(value=value):
                columns.begin_row(type(node).__name__, blank=blank)
                self.token()
                with columns.cell():
                    self.token(" ")
                self.token(" ")
                self.value(value)
            case ast.Equation(target=target, value=value):
                columns.begin_row("equation", blank=blank)
                with columns.cell():
                    self.reference(target)
                self.token(" ")
                self.value(value)
            case _:
                assert_never(node)

    def _environment(self, node: ast.EnvironmentDefinition) -> None:
        self.token()
        self.token(" ")
        self.token(" ")
        self.token(" ")
        if self.writer.next == "(":
            self.arguments(node.arguments)
        self._clauses({"step": node.step})
        with self.writer.block():
            self.declarations(node.declarations)
