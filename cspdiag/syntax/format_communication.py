"""The layout of ports and of the communication diagram."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple, assert_never

from cspdiag.syntax import ast
from cspdiag.syntax.format_expressions import ExpressionFormatter
from cspdiag.syntax.layout import SPACE, WIDTH, Break, Padding, flat_width


class Cell(NamedTuple):
    """A part of a row that is followed by padding; ``width`` is None if it cannot be on one line."""

    width: int | None
    padding: Padding


WIDEST_ALIGNED = 40
"""Cells wider than this are left out of the alignment of their column."""


class CommunicationFormatter(ExpressionFormatter):
    """Writes ports and declarations. Rows that follow each other directly are aligned in columns."""

    def ports(self, ports: Sequence[ast.Ports]) -> None:
        """Port declarations, a line each."""
        rows: list[list[Cell]] = []
        for port in ports:
            directly = self.writer.begin_line()
            if not directly:
                _align(rows)
                rows = []
            rows.append(self._port(port))
        _align(rows)

    def _port(self, node: ast.Ports) -> list[Cell]:
        cells = [self._cell(lambda: self.token())]
        cells.append(self._cell(lambda: self._port_names(node.names)))
        cells.append(self._cell(lambda: self._port_type(node.type)))
        if node.default is not None:
            self.token(" ")
            self.expression(node.default, " ")
        if node.period is not None:
            self.token(" ")
            self.expression(node.period, " ")
            if node.immediate:
                self.token(" ")
        if node.safe is not None:
            self.token(" ")
            self.expression(node.safe, " ")
        if node.default is None and node.period is None and node.safe is None:
            # Nothing follows in the row that would have to be aligned.
            cells.pop()
        return cells

    def _port_names(self, names: Sequence[ast.PortName]) -> None:
        with self.writer.group(" "), self.writer.indented():
            self.listed(names, self._port_name)

    def _port_type(self, node: ast.TypeName) -> None:
        self.token(" ")
        self.type_name(node, " ")

    def _port_name(self, node: ast.PortName, before: str | Break) -> None:
        self.token(before)
        self.indexes(node.dimensions)

    def _cell(self, write: Callable[[], None]) -> Cell:
        begin = len(self.writer.pieces)
        write()
        return Cell(flat_width(self.writer.pieces[begin:]), self.writer.padding())

    def declarations(self, declarations: Sequence[ast.Declaration]) -> None:
        """Declarations, a line each; the arrows of communication relationships with one source are aligned."""
        rows: list[list[Cell]] = []
        for declaration in declarations:
            directly = self.writer.begin_line()
            row = self._declaration(declaration)
            if not directly or row is None:
                _align(rows)
                rows = []
            if row is not None:
                rows.append(row)
        _align(rows)

    def _declaration(self, node: ast.Declaration) -> list[Cell] | None:
        match node:
            case ast.Instance():
                self.instance(node)
            case ast.Variable(type=variable_type, initial=initial):
                self.token()
                self.token(" ")
                self.token(" ")
                self.type_name(variable_type, " ")
                if initial is not None:
                    self.token(" ")
                    self.expression(initial, " ")
            case ast.Channel(type=channel_type, kind=kind):
                self.token()
                self.token(" ")
                self.token(" ")
                self.type_name(channel_type, " ")
                self._kind(kind)
            case ast.Connection():
                return self._connection(node)
            case ast.RepeatedDeclarations(replicator=replicator, declarations=declarations):
                self.token()
                self.replicator(replicator, " ")
                with self.writer.block():
                    self.declarations(declarations)
            case _:
                assert_never(node)
        return None

    def instance(self, node: ast.Instance) -> None:
        """``cell[i < 8] : Cell(id = i)``."""
        self.token()
        if node.size is not None:
            self.token()
            if isinstance(node.size, ast.Replicator):
                self.replicator(node.size)
            else:
                self.expression(node.size)
            self.token()
        self.token(" ")
        self.token(" ")
        if self.writer.next == "(":
            self.arguments(node.arguments)

    def _kind(self, node: ast.Kind | None) -> None:
        if node is None:
            return
        self.token(" ")
        if node.capacity is not None:
            self.expression(node.capacity, " ")

    def _connection(self, node: ast.Connection) -> list[Cell] | None:
        row = None
        with self.writer.group():
            with self.writer.group():
                cell = self._cell(lambda: self.listed(node.sources, self.reference))
            if len(node.sources) == 1:
                row = [cell]
            with self.writer.indented():
                self.token(SPACE if len(node.sources) > 1 else " ")
                if node.label is not None or node.type is not None or node.kind is not None:
                    self._medium(node)
                    if node.sinks:
                        self.token(SPACE)
                if node.sinks:
                    with self.writer.group(" "), self.writer.indented():
                        self.listed(node.sinks, self.reference)
        return row

    def _medium(self, node: ast.Connection) -> None:
        if node.label is not None:
            self.token(" ")
        if node.type is not None:
            self.token(" ")
            self.type_name(node.type, " ")
        self._kind(node.kind)


def _align(rows: list[list[Cell]]) -> None:
    """Widens the cells of each column to the widest one."""
    if len(rows) < 2:
        return
    for column in range(max(len(row) for row in rows)):
        cells = [row[column] for row in rows if column < len(row)]
        widths = [cell.width for cell in cells if cell.width is not None and cell.width <= WIDEST_ALIGNED]
        for cell in cells:
            if cell.width is not None and cell.width <= WIDEST_ALIGNED:
                cell.padding.width = min(max(widths) - cell.width, WIDTH)
