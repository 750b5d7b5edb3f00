"""The layout of ports and of the communication diagram."""

from __future__ import annotations

from collections.abc import Sequence
from typing import assert_never

from cspdiag.syntax import ast
from cspdiag.syntax.format.columns import Columns
from cspdiag.syntax.format.expressions import ExpressionFormatter
from cspdiag.syntax.format.layout import SPACE, Separator


class CommunicationFormatter(ExpressionFormatter):
    """Writes ports and declarations, one per line; consecutive ones are aligned in columns."""

    def ports(self, ports: Sequence[ast.Ports]) -> None:
        """Port declarations."""
        columns = Columns(self.writer)
        for port in ports:
            columns.begin_row("port")
            self._port(port, columns)
        columns.end()

    def _port(self, node: ast.Ports, columns: Columns) -> None:
        with columns.cell():
            self.token()
        with columns.cell(), self.writer.group(" "), self.writer.indented():
            self.listed(node.names, self._port_name)
        if node.default is None and node.sampling is None and node.safe is None:
            # Nothing follows in the row, so there is nothing to align.
            self._port_type(node.type)
            return
        with columns.cell():
            self._port_type(node.type)
        if node.default is not None:
            self.token(" ")
            self.expression(node.default, " ")
        if node.sampling is not None:
            self.token(" ")
            self._sampling(node.sampling)
            if node.immediate:
                self.token(" ")
        if node.safe is not None:
            self.token(" ")
            self.expression(node.safe, " ")

    def _sampling(self, node: ast.Sampling) -> None:
        self.expression(node.period, " ")
        if node.offset is not None:
            self.token(" ")
            self.expression(node.offset, " ")

    def _port_type(self, node: ast.TypeName) -> None:
        self.token(" ")
        self.type_name(node, " ")

    def _port_name(self, node: ast.PortName, before: Separator) -> None:
        self.token(before)
        self.indexes(node.dimensions)

    def declarations(self, declarations: Sequence[ast.Declaration]) -> None:
        """The contents of a communication block or an environment."""
        columns = Columns(self.writer)
        for declaration in declarations:
            self._declaration(declaration, columns)
        columns.end()

    def _declaration(self, node: ast.Declaration, columns: Columns) -> None:
        match node:
            case ast.Instance():
                columns.begin_row("instance")
                self.instance(node, columns)
            case ast.Variable(type=variable_type, initial=initial):
                columns.begin_row("var")
                self.typed_name(variable_type, initial, columns)
            case ast.Channel(type=channel_type, kind=kind):
                columns.begin_row("channel")
                self.typed_name(channel_type, None, columns)
                self._kind(kind)
            case ast.Connection(sources=sources):
                columns.begin_row("connection" if len(sources) == 1 else "")
                self._connection(node, columns)
            case ast.RepeatedDeclarations(replicator=replicator, declarations=declarations):
                columns.begin_row("")
                self.token()
                self.replicator(replicator, " ")
                with self.writer.block():
                    self.declarations(declarations)
            case _:
                assert_never(node)

    def typed_name(self, declared: ast.TypeName, initial: ast.Expression | None, columns: Columns) -> None:
        """``var name : type = initial`` and similar declarations."""
        self.token()
        with columns.cell():
            self.token(" ")
        if initial is None:
            self._port_type(declared)
            return
        with columns.cell():
            self._port_type(declared)
        self.token(" ")
        self.expression(initial, " ")

    def instance(self, node: ast.Instance, columns: Columns) -> None:
        """``cell[i < 8] : Cell(id = i)``."""
        with columns.cell():
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

    def _connection(self, node: ast.Connection, columns: Columns) -> None:
        several = len(node.sources) > 1
        with self.writer.group():
            with columns.cell(), self.writer.group():
                self.listed(node.sources, self.reference)
            with self.writer.indented():
                self.token(SPACE if several else " ")
                if node.label is not None or node.type is not None or node.kind is not None:
                    self._medium(node, columns)
                    if node.sinks:
                        self.token(SPACE)
                if node.sinks:
                    with self.writer.group(" "), self.writer.indented():
                        self.listed(node.sinks, self.reference)

    def _medium(self, node: ast.Connection, columns: Columns) -> None:
        if node.label is None:
            self._medium_type(node)
            return
        with columns.cell():
            self.token(" ")
        if not node.sinks:
            self._medium_type(node)
            return
        with columns.cell():
            self._medium_type(node)

    def _medium_type(self, node: ast.Connection) -> None:
        if node.type is not None:
            self._port_type(node.type)
        self._kind(node.kind)
