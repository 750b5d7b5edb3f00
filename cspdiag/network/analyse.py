"""All passes over the processes of a program, in their order; ``check`` and ``lower`` both go through here.

Inside out: relations, kinds, periods. Outside in: what each port meets in its context.
"""

from __future__ import annotations

from collections.abc import Mapping

from cspdiag.diagnostics import Report
from cspdiag.model.program import Program, Value
from cspdiag.network.contexts import Contexts, Placed
from cspdiag.network.definitions import Definitions
from cspdiag.network.elaborate import Elaboration
from cspdiag.network.kinds import Asked, asked_kinds, check_outermost, infer_kinds
from cspdiag.network.periods import Rates, net_rates
from cspdiag.network.relations import Relations
from cspdiag.network.shapes import Overrides, Shape
from cspdiag.syntax import ast


class Analysis:
    """The shapes of a program with everything that is known about them."""

    def __init__(self, program: Program, report: Report) -> None:
        self.program = program
        self.report = report
        self.definitions = Definitions(program)
        self.elaboration = Elaboration(program, self.definitions, report)
        self.relations = Relations()
        self.asked: dict[Shape, Asked] = {}
        self.rates: dict[Shape, Rates] = {}
        self.contexts = Contexts(self.rates, report)
        self._roots: list[tuple[Shape, bool]] = []

    def add_root(
        self, definition: ast.ProcessDefinition, values: Mapping[str, Value], overrides: Overrides, *, is_open: bool
    ) -> Shape:
        """An outermost process; ``is_open``: it belongs to a library, and what its ports meet is unknown."""
        shape = self.elaboration.root(definition, values, overrides)
        if (shape, is_open) not in self._roots:
            self._roots.append((shape, is_open))
        return shape

    def run(self) -> list[Placed]:
        """All passes; returns the outermost processes in their contexts."""
        for shape in self.inside_out():
            self._infer(shape)
        for shape, is_open in self._roots:
            if not is_open and not shape.incomplete:
                check_outermost(shape, self.relations.of(shape), self.asked[shape], self.report)
        return [self.contexts.outermost(shape, is_open) for shape, is_open in self._roots]

    def inside_out(self) -> list[Shape]:
        """The shapes of processes, each after those of its instances."""
        rank = {definition: position for position, definition in enumerate(self.definitions.order)}
        processes = [shape for shape in self.elaboration.shapes if shape.definition in rank]
        return sorted(processes, key=lambda shape: rank[shape.definition])  # type: ignore[index]

    def _infer(self, shape: Shape) -> None:
        uses = self.relations.of(shape)
        self.asked[shape] = asked_kinds(shape, self.asked)
        self.rates[shape] = net_rates(shape, self.rates, self.report)
        infer_kinds(shape, uses, self.asked[shape], self.report)
