"""Finds where a sample period that is not longer than zero comes from: the constant or argument that all its uses take
it from.

The search goes from the ports with such a period up through the arguments of instances, shapes of instances before
those that contain them.
"""

from __future__ import annotations

from collections.abc import Mapping

from cspdiag.base import Report, Span
from cspdiag.model.program import Program
from cspdiag.network.diagnostics.samples.periods import PeriodNotPositive
from cspdiag.network.elaborate.definitions import arguments_of
from cspdiag.network.shapes import Shape
from cspdiag.syntax import ast
from cspdiag.syntax.walk import names

Refused = tuple[int, Span]
"""The period in nanoseconds, and the port's use of it."""


class PeriodOrigins:
    """Finds the origins of all refused periods; each origin is reported once, with the outermost port that uses it."""

    def __init__(self, program: Program, refused: Mapping[Shape, list[tuple[ast.Expression, int]]]) -> None:
        self.program = program
        self.refused = refused
        self._given: dict[Shape, dict[ast.Parameter, Refused]] = {}
        """The parameters of each shape that get a refused period from outside."""
        self._found: dict[Span, PeriodNotPositive] = {}

    def shape(self, shape: Shape) -> None:
        """Follows the periods refused in a shape and in its instances, whose shapes must come first."""
        for instance in shape.instances.values():
            for parameter, refused in self._given.get(instance.shape, {}).items():
                self._argument(shape, instance.shape, instance.declaration.arguments, parameter, refused)
        # The last one found is kept: that of the first port of this shape.
        for expression, period in reversed(self.refused.get(shape, [])):
            self._follow(shape, expression, (period, expression.span))

    def root(self, shape: Shape, arguments: tuple[ast.Argument, ...]) -> None:
        """Follows the arguments that an outermost process gets from its environment."""
        for parameter, refused in self._given.get(shape, {}).items():
            self._argument(None, shape, arguments, parameter, refused)

    def report(self, report: Report) -> None:
        """Adds the diagnostics of all origins to a report."""
        for diagnostic in self._found.values():
            report.add(diagnostic)

    def _argument(
        self,
        shape: Shape | None,
        callee: Shape,
        arguments: tuple[ast.Argument, ...],
        parameter: ast.Parameter,
        refused: Refused,
    ) -> None:
        """Follows the argument for a parameter, or its default, which may use other parameters of the
        same definition.
        """
        given = dict(arguments_of(callee.definition.parameters, arguments))
        while True:
            is_set = parameter.name.text in callee.overrides
            if parameter in given and not is_set:
                self._follow(shape, given[parameter], refused)
                return
            if parameter.default is None or is_set:
                self._find(parameter.name.span, True, refused)
                return
            origin = self._origin(callee, parameter.default)
            if not isinstance(origin, ast.Parameter):
                self._find(*origin, refused)
                return
            parameter = origin

    def _follow(self, shape: Shape | None, expression: ast.Expression, refused: Refused) -> None:
        origin = self._origin(shape, expression)
        if not isinstance(origin, ast.Parameter):
            self._find(*origin, refused)
        elif shape is None or origin.name.text in shape.overrides:
            self._find(origin.name.span, True, refused)
        else:
            self._given.setdefault(shape, {})[origin] = refused

    def _origin(self, shape: Shape | None, expression: ast.Expression) -> ast.Parameter | tuple[Span, bool]:
        """The parameter that an expression gets its value from, or a place in the text, with whether the value there is
        set from outside.
        """
        while (name := self._refused_name(shape, expression)) is not None:
            symbol = self.program.bindings.get(name)
            if isinstance(symbol, ast.Parameter):
                return symbol
            assert isinstance(symbol, ast.Constant)
            if symbol.name.text in self.program.overrides:
                return symbol.name.span, True
            expression = symbol.value
        return expression.span, False

    def _refused_name(self, shape: Shape | None, expression: ast.Expression) -> ast.Name | None:
        """The name that makes an expression not longer than zero: the expression itself if it is a name, or the first
        name in it with such a value; None if no name has one.
        """
        for name in names((expression,)):
            symbol = self.program.bindings.get(name)
            value = None
            if isinstance(symbol, ast.Constant):
                value = self.program.constants.get(symbol)
            elif isinstance(symbol, ast.Parameter):
                value = shape.values.get(symbol) if shape is not None else None
            if name is expression and isinstance(symbol, ast.Constant | ast.Parameter):
                return name
            if isinstance(value, int | float) and not isinstance(value, bool) and value <= 0:
                return name
        return None

    def _find(self, span: Span, is_set: bool, refused: Refused) -> None:
        period, use = refused
        self._found[span] = PeriodNotPositive(span=span, period=period, use=use, is_set=is_set)
