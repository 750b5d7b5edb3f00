"""The resolved, typed model: the syntax trees, with tables of what is known about their nodes."""

from __future__ import annotations

from typing import TypeAlias

from cspdiag.base import Span
from cspdiag.base.record import node
from cspdiag.model.types import Type
from cspdiag.syntax import ast

Value: TypeAlias = "bool | int | float | str | tuple[Value, ...]"
"""A constant: enum literals by index, ``time`` in nanoseconds, structs and arrays as tuples."""


@node
class PortSymbol:
    """One name of a port declaration."""

    declaration: ast.Ports
    port: ast.PortName
    type: Type

    @property
    def name(self) -> str:
        """The name of the port."""
        return self.port.name.text


@node
class EndLabelSymbol:
    """A label that ends an arrow, or names the communication object in the middle of one."""

    connection: ast.Connection
    type: Type
    ends_arrow: bool


@node
class EnumLiteralSymbol:
    """A literal of an enum."""

    definition: ast.EnumDefinition
    index: int


@node
class BuiltinSymbol:
    """``sample``, ``time``, ``pi``, ``Timeout``, ``Fault``, and the functions."""

    name: str


Symbol: TypeAlias = (
    ast.Definition
    | ast.Parameter
    | ast.Variable
    | ast.Channel
    | ast.Instance
    | ast.Let
    | ast.State
    | ast.Replicator
    | PortSymbol
    | EndLabelSymbol
    | EnumLiteralSymbol
    | BuiltinSymbol
)


class Scope:
    """The meanings of the names in a process, submodel, driver or environment; ``ports`` are in the order of the text.

    ``undeclared``: names without a declaration that have been reported once; further uses are not reported.
    ``incomplete``: names may be missing because of mistakes that were already reported.
    """

    def __init__(self) -> None:
        self.undeclared: set[str] = set()
        self.incomplete = False
        self.ports: dict[str, PortSymbol] = {}
        self.names: dict[str, Symbol] = {}


class Program:
    """A program after names and types have been resolved.

    ``bindings``: from ast.Name, ast.Reference (its first name) and ast.Identifier (of definitions used, members,
    callees) to what they mean. ``members``: from ast.Reference or ast.Member with a member to its port, literal or
    field. ``types``: of expressions, parameters, variables, channels, states, lets, constants, fields and type names;
    sizes that depend on parameters are None. ``constants``: those with a value that never changes; ``tunable``: the
    parameters of the program and the constants that follow from them, with their values before any change.
    ``time_uses``: submodels whose own equations use ``time``, and where. ``poisoned``: nodes with a mistake that was
    reported; later passes are silent about them. ``overrides``: values of constants that were set from outside
    (``--set``).
    """

    def __init__(self, main: ast.SourceTree, trees: tuple[ast.SourceTree, ...], overrides: dict[str, Value]) -> None:
        self.main = main
        self.trees = trees
        self.definitions: dict[str, ast.Definition] = {}
        self.assertions: list[ast.Assertion] = []
        self.scopes: dict[ast.Node, Scope] = {}
        self.bindings: dict[ast.Node, Symbol] = {}
        self.members: dict[ast.Node, PortSymbol | EnumLiteralSymbol | str] = {}
        self.types: dict[ast.Node, Type] = {}
        self.constants: dict[ast.Constant, Value] = {}
        self.tunable: dict[ast.Constant, Value] = {}
        self.time_uses: dict[ast.Node, Span] = {}
        self.poisoned: set[ast.Node] = set()
        self.overrides = overrides
