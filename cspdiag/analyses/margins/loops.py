"""The loops of a program with their margins; laws without margins are listed with the reason."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, ClassVar

from cspdiag.analyses.margins.law import Leaf
from cspdiag.analyses.margins.linear import NotLinearError, Simplification
from cspdiag.analyses.margins.margin import Margins, margins
from cspdiag.analyses.margins.one_period import PeriodSimulation
from cspdiag.analyses.margins.open_loop import Cut, OpenLoop, minimal
from cspdiag.analyses.margins.system import LinearizedProgram
from cspdiag.base import Span
from cspdiag.base.record import record
from cspdiag.network.ir.network import CoreNetwork, Environment

if TYPE_CHECKING:
    import control  # type: ignore[import-untyped]

MOTIONS = (0.1, 1.0, 10.0)
"""Speeds, in their units, at which a plant is linearized that does not respond at rest."""


@record
class AnalysedLoop:
    """One loop: the system cut open, its margins, and the states that were not at their initial values when it was
    linearized.
    """

    opened: OpenLoop
    margins: Margins
    point: Mapping[str, float]
    simplifications: tuple[Simplification, ...]

    def to_control(self) -> control.StateSpace:
        """The open loop L of negative feedback as a discrete-time system of python-control: the loop is closed by
        ``control.feedback(L, 1)``.

        So L is the negative of what the law computes for what it had written, and its Nyquist curve is compared with
        -1. The time step is the period of the law, in seconds; the input is called ``e``, the output as the port of the
        law, the system as the law. ``control.stability_margins(L, method="frd")`` gives ``margins``; its polynomials
        (``method="poly"``) are inaccurate if a plant is slow compared with the sample period.
        """
        from cspdiag.analyses.margins.python_control import state_space

        return state_space(self.opened)


@record
class LawWithoutMargins:
    """A law that has no margins, with the reason and its place."""

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
    """Margins of every loop from a law through the plant back to the law.

    States of the plant have their initial values, except for those in ``point``; inputs are zero. If the plant does not
    respond there, because dry friction holds it, it is linearized in motion, unless ``point`` is given. ``only``
    selects loops by a part of their path, which is that of the law and its output. Raises NotLinearError if the plant
    as a whole cannot be linearized.
    """
    points = list(_points(network, environment, point))
    found: list[AnalysedLoop] = []
    refusals: list[LawWithoutMargins] = []
    first = points[0][1]
    for path in first.classes:
        if path not in first.search.runs:
            continue
        try:
            found += _of_law(points, path, only)
        except NotLinearError as problem:
            if only is None or any(only in f"{path}.{port.name}" for port in first.classes[path].ports):
                refusals.append(LawWithoutMargins(path, problem.reason, problem.span))
    return LoopReport(environment.name, tuple(found), tuple(refusals))


def reopen(network: CoreNetwork, environment: Environment, loop: AnalysedLoop) -> OpenLoop | None:
    """The same loop in another variant of the program, about the same point; None if that has no such loop. Raises
    NotLinearError.
    """
    program = LinearizedProgram(network, environment, dict(loop.point))
    cut = loop.opened.cut
    if not program.comes_back(cut.law, cut.output[0]) or program.is_passed_on(cut.law, cut.output[0]):
        return None
    opened = PeriodSimulation(program, cut).open_loop()
    return opened if len(minimal(opened)[0]) else None


def _points(
    network: CoreNetwork, environment: Environment, point: Mapping[str, float] | None
) -> Iterator[tuple[dict[str, float], LinearizedProgram]]:
    """Where to linearize: at rest, and in motion for plants that do not respond there."""
    rest = LinearizedProgram(network, environment, dict(point or {}))
    yield dict(point or {}), rest
    if point:
        return
    plant = rest.plant
    first = len(plant.discrete)
    speeds = [
        name
        for k, (name, indexes) in enumerate(plant.continuous)
        if not indexes and any(row[first + k] == 1.0 and abs(row).sum() == 1.0 for row in plant.rates)
    ]
    for magnitude in MOTIONS if speeds else ():
        moving = dict.fromkeys(speeds, magnitude)
        yield moving, LinearizedProgram(network, environment, moving, rest.search)


def _of_law(
    points: list[tuple[dict[str, float], LinearizedProgram]], path: str, only: str | None
) -> Iterator[AnalysedLoop]:
    first = points[0][1]
    if not first.search.of(path).members:
        return
    unanswered: dict[str, None] = {}
    for name, indexes in first.law(path).output_names:
        cut = Cut(path, (name, indexes))
        is_chosen = only is None or only in cut.path
        if not is_chosen or not first.comes_back(path, name) or first.is_passed_on(path, name):
            continue
        unanswered.setdefault(name)
        for point, program in points:
            opened = PeriodSimulation(program, cut).open_loop()
            if not len(minimal(opened)[0]):
                continue
            yield AnalysedLoop(opened, margins(opened), _relevant(point, program, opened), _within(program, opened))
            unanswered.pop(name, None)
            break
    for name in unanswered:
        raise NotLinearError(
            f"a small change of `{name}` does not come back to it at the operating point; choose another one with "
            "--at, or see whether something overwrites it",
            first.classes[path].span,
        )


def _relevant(point: Mapping[str, float], program: LinearizedProgram, opened: OpenLoop) -> dict[str, float]:
    moved = {leaf[0] for kind, leaf in opened.kept if kind == "plant"}
    return {name: value for name, value in point.items() if name in moved}


def _within(program: LinearizedProgram, opened: OpenLoop) -> tuple[Simplification, ...]:
    """The simplifications that depend on something within the loop, each once."""
    kept = set(opened.kept)
    simplified: dict[tuple[str, Span | None], Simplification] = {}
    responding = {
        name for kind, (port, _) in kept if kind in ("latch", "held") for name in program.responding_inputs(port)
    }
    for kind, law in (("plant", program.plant), *((path, program.law(path)) for path in opened.laws)):
        leaves = (*law.discrete, *law.continuous)
        inside = [(kind, leaf) in kept for leaf in leaves]
        inside += [kind != "plant" and _is_read_inside(program, kept, responding, kind, leaf) for leaf in law.inputs]
        for part in law.simplifications:
            if any(part.depends[k] for k, is_inside in enumerate(inside) if is_inside):
                simplified.setdefault((part.what, part.span), part)
    return tuple(simplified.values())


def _is_read_inside(
    program: LinearizedProgram, kept: set[tuple[str, Leaf]], responding: set[str], law: str, leaf: Leaf
) -> bool:
    net = program.net_of.get((law, leaf[0]))
    if net is None:
        return False
    return ("net", (net, leaf[1])) in kept or program.outside.get(net) in responding
