"""All passes over the processes of a program, in order, for both ``check`` and ``lower``.

Relations, kinds and periods go from inner processes to outer ones; contexts of ports from outer processes to inner
ones.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property

from cspdiag.base import Report
from cspdiag.model.program import Program, Value
from cspdiag.network.checks.agreement import Agreement
from cspdiag.network.checks.assignment import Flow, check_assignment
from cspdiag.network.checks.composition import check_progress, check_runs
from cspdiag.network.checks.drivers.buttons import check_releases
from cspdiag.network.checks.guards import check_guards
from cspdiag.network.checks.raised import RaisedExceptions
from cspdiag.network.checks.rate_boundaries import RateBoundaries
from cspdiag.network.checks.samples.missed import MissedSamples
from cspdiag.network.checks.usage import check_usage
from cspdiag.network.diagnostics.arrays import TooManyInstances
from cspdiag.network.diagnostics.samples.periods import SampleUnknown
from cspdiag.network.elaborate.definitions import Definitions
from cspdiag.network.elaborate.definitions_to_shapes import Elaboration
from cspdiag.network.infer.contexts import Contexts, Placed, Surroundings
from cspdiag.network.infer.kinds import (
    RequestedKinds,
    check_outermost,
    excuse_unknown_uses,
    infer_kinds,
    requested_kinds,
)
from cspdiag.network.infer.parameter_ranges import ranges_of
from cspdiag.network.infer.period_origins import PeriodOrigins
from cspdiag.network.infer.periods import Rates, check_event_ports, net_rates
from cspdiag.network.infer.waiting import MayWait
from cspdiag.network.occurrences import Occurrence, Occurrences, tunable_parameters
from cspdiag.network.relations import Relations
from cspdiag.network.shapes import Overrides, Shape, attached_key
from cspdiag.network.submodels.classes import LawUse, needs_sample
from cspdiag.syntax import ast
from cspdiag.syntax.diagnostics.structure import NestedTooDeeply

LARGEST_PROGRAM = 1_000_000
"""Programs with more instances are refused."""

DEEPEST_PROCESSES = 100
"""Levels of processes inside each other: Python imports at most some 190 modules inside each other, C some 200 headers.
"""


class Analysis:
    """The shapes of a program with everything that is known about them."""

    def __init__(self, program: Program, report: Report) -> None:
        self.program = program
        self.report = report
        self.definitions = Definitions(program)
        self.elaboration = Elaboration(program, self.definitions, report)
        self.relations = Relations()
        self.requested: dict[Shape, RequestedKinds] = {}
        self.rates: dict[Shape, Rates] = {}
        self.contexts = Contexts(self.rates, report)
        self.flows: dict[Shape, Flow] = {}
        self._agreement = Agreement()
        self._sizes: dict[Shape, int] = {}
        self._depths: dict[Shape, int] = {}
        self._roots: list[tuple[Shape, Surroundings]] = []
        self._root_arguments: list[tuple[Shape, tuple[ast.Argument, ...]]] = []
        self._root_values: list[tuple[Shape, Surroundings, Mapping[str, Value], frozenset[str]]] = []
        self.laws: list[LawUse] = []
        """The submodel instances, with the values of their parameters as far as known; empty if errors were reported
        before.
        """
        self._ranks: dict[ast.Node, int] = {definition: n for n, definition in enumerate(self.definitions.order)}
        self._needs_sample: dict[ast.SubmodelDefinition, bool] = {}

    def add_root(
        self,
        definition: ast.ProcessDefinition,
        arguments: tuple[ast.Argument, ...],
        values: Mapping[str, Value],
        overrides: Overrides,
        surroundings: Surroundings = "environment",
    ) -> Shape:
        """Adds an outermost process, with the arguments of its environment and the values that these, defaults and
        overrides give its parameters.
        """
        shape = self.elaboration.root(definition, values, overrides)
        self._root_arguments.append((shape, arguments))
        tunable = tunable_parameters(self.program, definition.parameters, arguments, overrides)
        self._root_values.append((shape, surroundings, values, tunable))
        if (shape, surroundings) not in self._roots:
            self._roots.append((shape, surroundings))
        return shape

    def known_root(self, definition: ast.ProcessDefinition, values: Mapping[str, Value]) -> tuple[Shape, Placed] | None:
        """The shape and context of an outermost process that ``run`` has analysed with these values of its parameters;
        None if it has not.
        """
        shape = self.elaboration.root(definition, values, {})
        return (shape, self.contexts.outermost(shape, "environment")) if (shape, "environment") in self._roots else None

    def run(self) -> list[Placed]:
        """Runs all passes; returns the outermost processes in their contexts."""
        for shape in self.inside_out():
            self._count(shape)
            self._measure(shape)
            self._infer(shape)
        self._report_periods()
        raised = RaisedExceptions(self.program, self.report)
        for shape in self.inside_out():
            raised.process(shape)
        raised.warn()
        for shape, surroundings in self._roots:
            if surroundings != "unknown" and not shape.incomplete:
                check_outermost(shape, self.relations.of(shape), self.requested[shape], self.report)
                check_event_ports(shape, self.rates[shape], self.report)
        outermost = [self.contexts.outermost(shape, surroundings) for shape, surroundings in self._roots]
        if not self.report.has_errors:
            self._give_values()
        waiting = MayWait()
        instances = {inside: name for owner in self.contexts.placed for name, inside in reversed(owner.inside.items())}
        for placed in self._inside_out_in_context():
            waiting.process(placed)
            check_guards(placed, self.report)
            check_progress(placed, waiting, self.report, self._agreement, instances.get(placed))
            check_releases(placed, self._agreement)
            self._check_samples(placed)
        self._agreement.report(self.report)
        if not self.report.has_errors and any(
            kind == "sampled" for placed in self.contexts.placed for kind, _ in placed.facts.values()
        ):
            missed = MissedSamples(self.report)
            for placed in self._inside_out_in_context():
                missed.process(placed, is_outermost=placed in outermost)
        if len({period for placed in self.contexts.placed for period in placed.samples.values()}) > 1:
            boundaries = RateBoundaries(self.report)
            for placed in self._inside_out_in_context():
                boundaries.process(placed)
        return outermost

    def _give_values(self) -> None:
        """Passes the values of parameters down to the innermost instances; those of the outermost processes of a
        library are unknown.
        """
        laws: list[LawUse] = []
        by_context: dict[Placed, list[Occurrence]] = {}
        for shape, surroundings, given, tunable in self._root_values:
            own = [] if surroundings == "unknown" else shape.definition.parameters
            values: dict[ast.Node, Value] = {one: given[one.name.text] for one in own if one.name.text in given}
            occurrences = Occurrences(self.program, self.elaboration, self.report)
            occurrences.outermost(self.contexts.outermost(shape, surroundings), values, tunable)
            for found in occurrences.found:
                by_context.setdefault(found.placed, []).append(found)
            laws += (law.use for law in occurrences.laws)
        if self.report.has_errors:
            return
        self.laws = laws
        for placed, several in by_context.items():
            placed.given.extend(occurrence.arguments() for occurrence in several)
            placed.parameters.update(ranges_of(placed.given))

    def law_samples(self) -> set[tuple[ast.SubmodelDefinition, int]]:
        """The submodels of the program, with the sample periods at which they run."""
        return {
            (definition, placed.samples[instance.name])
            for placed in self.contexts.placed
            for instance in placed.shape.instances.values()
            if instance.name in placed.samples
            and isinstance(definition := instance.shape.definition, ast.SubmodelDefinition)
        }

    def inside_out(self) -> list[Shape]:
        """The shapes of processes, each after those of its instances."""
        processes = [shape for shape in self.elaboration.shapes if not shape.is_submodel]
        return sorted(processes, key=self._rank)

    def _inside_out_in_context(self) -> list[Placed]:
        return sorted(self.contexts.placed, key=lambda placed: self._rank(placed.shape))

    def _rank(self, shape: Shape) -> int:
        return self._ranks.get(shape.definition, 0)

    def _measure(self, shape: Shape) -> None:
        """Measures how deep processes are inside each other; too deep is reported for the innermost process from which
        on they are.
        """
        depth = 1 + max([self._depths.get(instance.shape, 0) for instance in shape.instances.values()], default=0)
        if depth > DEEPEST_PROCESSES:
            span, name = shape.definition.name.span, shape.name
            self.report.add(NestedTooDeeply(span=span, limit=DEEPEST_PROCESSES, process=name))
            depth = 0
        self._depths[shape] = depth

    def _count(self, shape: Shape) -> None:
        """Counts the instances in a process at all levels; too many are reported for the innermost process that has too
        many.
        """
        inside = sum(self._sizes.get(instance.shape, 1) for instance in shape.instances.values())
        if inside > LARGEST_PROGRAM:
            what = f"the process `{shape.name}`, with everything inside it,"
            span = shape.definition.name.span
            self.report.add(TooManyInstances(span=span, what=what, number=inside, limit=LARGEST_PROGRAM))
            inside = 0
        self._sizes[shape] = 1 + inside

    def _report_periods(self) -> None:
        origins = PeriodOrigins(self.program, self.elaboration.refused_periods)
        for shape in self.inside_out() if self.elaboration.refused_periods else ():
            origins.shape(shape)
        for shape, arguments in self._root_arguments:
            origins.root(shape, arguments)
        origins.report(self.report)

    def _infer(self, shape: Shape) -> None:
        uses = self.relations.of(shape)
        self.requested[shape] = requested_kinds(shape, self.requested)
        self.rates[shape] = net_rates(shape, self.rates, self.report)
        excuse_unknown_uses(shape, self.relations)
        check_runs(shape, uses, self.report)
        infer_kinds(shape, uses, self.requested[shape], self.report)
        is_specification = isinstance(shape.definition, ast.ProcessDefinition) and self.definitions.is_specification(
            shape.definition
        )
        check_usage(shape, uses, self.report, self._agreement, named=self._named, is_specification=is_specification)
        self.flows[shape] = check_assignment(shape, uses, self.flows, self.report, self._agreement)

    @cached_property
    def _named(self) -> frozenset[ast.Node]:
        """The variables and channels that are named in the text."""
        symbols = self.program.bindings.values()
        return frozenset(symbol for symbol in symbols if isinstance(symbol, ast.Variable | ast.Channel))

    def _check_samples(self, placed: Placed) -> None:
        """Reports submodel instances that need a sample period and have none, unless nothing is known about their nets
        either.
        """
        for instance in placed.shape.instances.values():
            definition = instance.shape.definition
            if not isinstance(definition, ast.SubmodelDefinition) or instance.name in placed.samples:
                continue
            if instance.name in placed.unknown_samples:
                continue
            keys = [attached_key(attached) for attached in instance.attachments.values()]
            if any(key is not None and placed.facts[key][0] == "open" for key in keys) or placed.shape.incomplete:
                continue
            if definition not in self._needs_sample:
                self._needs_sample[definition] = needs_sample(self.program, definition)
            if self._needs_sample[definition]:
                self.report.add(
                    SampleUnknown(span=instance.span, instance=instance.name, definition=instance.shape.name)
                )
