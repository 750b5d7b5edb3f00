"""The loops of a program with their margins; what has none is named with the reason."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, ClassVar

from cspdiag.analyses.margins.law import Leaf
from cspdiag.analyses.margins.linear import NotLinearError, Simplification
from cspdiag.analyses.margins.margin import Margins, margins
from cspdiag.analyses.margins.open_loop import Cut, OpenLoop, minimal
from cspdiag.analyses.margins.system import Loops
from cspdiag.base import Span
from cspdiag.base.record import record
from cspdiag.network.ir.network import CoreNetwork, Environment

if TYPE_CHECKING:
    import control  # type: ignore[import-untyped]

MOTIONS = (0.1, 1.0, 10.0)
"""Speeds, in their units, at which a plant is looked at that does not answer at rest."""


@record
class AnalysedLoop:
    """One loop: where it is cut, as a system, its margins, and the states that were not at their initial values when it
    was linearized.
    """

    opened: OpenLoop
    margins: Margins
    point: Mapping[str, float]
    simplifications: tuple[Simplification, ...]

    def to_control(self) -> control.StateSpace:
        """The open loop L of negative feedback as a discrete-time system of python-control: the loop is closed by
        ``control.feedback(L, 1)``.

        So L is minus what the law computes for what it had written, and its Nyquist curve is looked at around -1. The
        time step is the period of the law, in seconds; the input is called ``e``, the output as the port of the law,
        the system as the law. ``control.stability_margins(L, method="frd")`` gives ``margins``; its polynomials
        (``method="poly"``) lose their digits where a plant is slow beside the sample period.
        """
        from cspdiag.analyses.margins.python_control import state_space

        return state_space(self.opened)


@record
class LawWithoutMargins:
    """A law that has no margins, why, and the place of what stands in the way."""

    uncompared: ClassVar[frozenset[str]] = frozenset()

    law: str
    reason: str
    span: Span | None


@record
class LoopReport:
    """All loops through one environment."""

    environment: str
    loops: tuple[AnalysedLoop, ...]
    refusals: tuple[LawWithoutMargins, ...]


def analyse_loops(
    network: CoreNetwork, environment: Environment, *, point: Mapping[str, float] | None = None, only: str | None = None
) -> LoopReport:
    """Margins of every loop that goes from a law through the plant back to it.

    States of the plant have their initial values, but for those in ``point``; inputs are zero. Where the plant does not
    answer there, because dry friction holds it, it is looked at in motion, unless ``point`` says where. ``only`` is a
    part of the paths of the loops that are wanted, each that of its law and the output. Raises NotLinearError where the
    plant as a whole cannot be linearized.
    """
    places = list(_points(network, environment, point))
    found: list[AnalysedLoop] = []
    refusals: list[LawWithoutMargins] = []
    first = places[0][1]
    for path in first.classes:
        if path not in first.periods or path not in first.structure.ways:
            continue
        try:
            found += _of_law(places, path, only)
        except NotLinearError as problem:
            if only is None or any(only in f"{path}.{port.name}" for port in first.classes[path].ports):
                refusals.append(LawWithoutMargins(path, problem.reason, problem.span))
    return LoopReport(environment.name, tuple(found), tuple(refusals))


def opened_again(network: CoreNetwork, environment: Environment, loop: AnalysedLoop) -> OpenLoop | None:
    """A loop of another variant of the same program, about the same point; None where that has no such loop. Raises
    NotLinearError.
    """
    loops = Loops(network, environment, dict(loop.point))
    cut = loop.opened.cut
    if cut.law not in loops.periods or _is_passed_on(loops, cut.law, cut.output[0]):
        return None
    opened = loops.open(cut)
    return opened if len(minimal(opened)[0]) else None


def _points(
    network: CoreNetwork, environment: Environment, point: Mapping[str, float] | None
) -> Iterator[tuple[dict[str, float], Loops]]:
    """Where to linearize: at rest, and in motion for what does not answer there."""
    rest = Loops(network, environment, dict(point or {}))
    yield dict(point or {}), rest
    if point:
        return
    plant = rest.plant
    first = len(plant.discrete)
    speeds = [
        name
        for k, (name, way) in enumerate(plant.continuous)
        if not way and any(row[first + k] == 1.0 and abs(row).sum() == 1.0 for row in plant.rates)
    ]
    for magnitude in MOTIONS if speeds else ():
        moving = dict.fromkeys(speeds, magnitude)
        yield moving, Loops(network, environment, moving)


def _of_law(places: list[tuple[dict[str, float], Loops]], path: str, only: str | None) -> Iterator[AnalysedLoop]:
    if not any(path in loops.reachable(path, [*loops.within(path), path]) for _, loops in places):
        return
    for name, way in places[0][1].law(path).output_names:
        cut = Cut(path, (name, way))
        if only is not None and only not in cut.path:
            continue
        for point, loops in places:
            if _is_passed_on(loops, path, name):
                continue
            opened = loops.open(cut)
            if not len(minimal(opened)[0]):
                continue
            yield AnalysedLoop(opened, margins(opened), _relevant(point, loops, opened), _within(loops, opened))
            break


def _is_passed_on(loops: Loops, path: str, port: str) -> bool:
    """Whether another law at the same rate goes on with the output, so that the loop is cut there."""
    net = loops.net_of.get((path, port))
    return net is not None and any(
        loops.periods[other] == loops.periods[path] and loops.is_read_by(net, other) and net not in loops.outside
        for other in loops.within(path)
    )


def _relevant(point: Mapping[str, float], loops: Loops, opened: OpenLoop) -> dict[str, float]:
    moved = {leaf[0] for kind, leaf in opened.kept if kind == "plant"}
    return {name: value for name, value in point.items() if name in moved}


def _within(loops: Loops, opened: OpenLoop) -> tuple[Simplification, ...]:
    """Of what was simplified, that which depends on something within the loop, each once."""
    kept = set(opened.kept)
    simplified: dict[tuple[str, Span | None], Simplification] = {}
    answering = {name for kind, (port, _) in kept if kind in ("latch", "held") for name in loops.answering(port)}
    for kind, law in (("plant", loops.plant), *((path, loops.law(path)) for path in opened.laws)):
        leaves = (*law.discrete, *law.continuous)
        inside = [(kind, leaf) in kept for leaf in leaves]
        inside += [kind != "plant" and _is_read_inside(loops, kept, answering, kind, leaf) for leaf in law.inputs]
        for part in law.simplifications:
            if any(part.depends[k] for k, is_inside in enumerate(inside) if is_inside):
                simplified.setdefault((part.what, part.span), part)
    return tuple(simplified.values())


def _is_read_inside(loops: Loops, kept: set[tuple[str, Leaf]], answering: set[str], law: str, leaf: Leaf) -> bool:
    net = loops.net_of.get((law, leaf[0]))
    if net is None:
        return False
    return ("net", (net, leaf[1])) in kept or loops.outside.get(net) in answering
