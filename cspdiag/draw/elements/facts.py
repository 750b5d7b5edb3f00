"""The compiler's results about the channels, ports and instances that a diagram shows."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, TypeVar, cast, get_args

from cspdiag.base import Report
from cspdiag.base.record import record
from cspdiag.draw.elements.diagram import FlowKind
from cspdiag.model.sampling import Sampling
from cspdiag.network.shapes import UNKNOWN_SAMPLING
from cspdiag.syntax import ast

if TYPE_CHECKING:
    from cspdiag.model.program import Program
    from cspdiag.network.analyse import Analysis
    from cspdiag.network.infer.contexts import Fact, Placed

T = TypeVar("T")
_FLOW_KINDS: tuple[str, ...] = get_args(FlowKind)


@record
class Flow:
    """The kinds and sample periods that a channel or port has in the contexts of its process.

    Empty if nothing is known; ``kinds`` are in the order in which contexts were found.
    """

    kinds: tuple[FlowKind, ...] = ()
    periods: tuple[Sampling, ...] = ()


NOTHING = Flow()


class Facts:
    """The facts of a program by their subject; of a program with errors, those that could still be inferred.
    ``analysis`` has the results of its check, if there was one.
    """

    def __init__(self, program: Program, analysis: Analysis | None = None) -> None:
        from cspdiag.network.check import analysed

        known = analysed(program, Report()) if analysis is None else analysis
        self._ports: dict[tuple[ast.Node, str], list[Fact]] = {}
        self._channels: dict[tuple[ast.Node, ast.Node], list[Fact]] = {}
        self._samples: dict[tuple[ast.Node, ast.Node], list[int]] = {}
        self._stated: dict[tuple[ast.Node, str], list[Sampling | None]] = {}
        """By definition, or by the declaration of an instance."""
        for placed in known.contexts.placed:
            self._collect(placed)

    def _collect(self, placed: Placed) -> None:
        definition = placed.shape.definition
        for port, _, key in placed.shape.port_elements():
            self._stated.setdefault((definition, port.name), []).append(port.sampling)
            if key in placed.facts:
                self._ports.setdefault((definition, port.name), []).append(placed.facts[key])
        for key, channel in placed.shape.channels.items():
            if key in placed.facts:
                self._channels.setdefault((definition, channel.declaration), []).append(placed.facts[key])
        for instance in placed.shape.instances.values():
            for port in instance.shape.ports.values():
                self._stated.setdefault((instance.declaration, port.name), []).append(port.sampling)
            if instance.name in placed.samples:
                self._samples.setdefault((definition, instance.declaration), []).append(placed.samples[instance.name])

    def port(self, definition: ast.Node, name: str) -> Flow:
        """The flow at the port of a process; for an array of ports, that of its elements."""
        return _flow(self._ports.get((definition, name), ()))

    def channel(self, definition: ast.Node, declaration: ast.Node) -> Flow:
        """The flow of a variable, a channel or the object of a relationship, within a process."""
        return _flow(self._channels.get((definition, declaration), ()))

    def samples(self, definition: ast.Node, declaration: ast.Instance) -> tuple[int, ...]:
        """The sample periods at which a submodel instance of a process runs."""
        return _distinct(self._samples.get((definition, declaration), ()))

    def stated_periods(self, of: ast.Node, name: str) -> tuple[Sampling, ...]:
        """The periods that a port states: ``of`` a definition, or of the declaration of an instance of it."""
        return _periods(self._stated.get((of, name), ()))


def _flow(pairs: Sequence[Fact]) -> Flow:
    kinds = dict.fromkeys(kind for kind, _ in pairs if kind in _FLOW_KINDS)
    return Flow(tuple(cast("FlowKind", kind) for kind in kinds), _periods(sampling for _, sampling in pairs))


def _periods(samplings: Iterable[Sampling | None]) -> tuple[Sampling, ...]:
    return _distinct(each for each in samplings if each is not None and each != UNKNOWN_SAMPLING)


def _distinct(values: Iterable[T]) -> tuple[T, ...]:
    return tuple(dict.fromkeys(values))
