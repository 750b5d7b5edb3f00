"""Counterexamples for diagrams: which elements each step concerns."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from cspdiag.draw.deadlock.marks import StuckProcess, definition_at, marks_beside, path_around, surroundings
from cspdiag.draw.deadlock.steps import steps_beside
from cspdiag.draw.elements.composition import CompositionDiagram
from cspdiag.draw.elements.read_composition import composition_diagram
from cspdiag.model.program import Program
from cspdiag.network.ir.network import CoreNetwork
from cspdiag.proofs.counterexamples.counterexample import Counterexample, Step
from cspdiag.proofs.counterexamples.table import event_text
from cspdiag.syntax import ast
from cspdiag.verify.deadlock_picture import deadlock_shown_by

MOST_STEPS = 200
"""At most this number of steps is shown: the first, and what they lead to."""


def steps_shown(program: Program, found: Counterexample, network: CoreNetwork | None) -> list[dict[str, Any]]:
    """The steps that diagrams show, those that repeat forever after them, and the end, as objects of JSON.

    Each has a ``text``, the ``process`` in whose diagrams it happens, and the keys of the elements of both diagrams
    that are ``communicating`` or ``waiting``.
    """
    deadlock = deadlock_shown_by(found, network)
    waiting = () if deadlock is None else (*deadlock.cycle, *deadlock.besides)
    shown = _Shown(program, found, waiting, network)
    return [*shown.communications(), *shown.silent_round(), *shown.end()]


class _Shown:
    """The steps of one counterexample, which ends with processes ``waiting``."""

    def __init__(
        self, program: Program, found: Counterexample, waiting: Sequence[StuckProcess], network: CoreNetwork | None
    ) -> None:
        self._program = program
        self._found = found
        self._waiting = waiting
        self._declared = {} if network is None else {net.path: net.span for net in network.nets}
        self._compositions: dict[str, CompositionDiagram] = {}

    def communications(self) -> Iterator[dict[str, Any]]:
        """The steps that are shown; a process waits to the end from the step on that follows its last one."""
        top = self._found.process
        steps = (*self._found.steps, *self._found.cycle)
        repeats_from = len(self._found.steps)
        last = {party.path: number for number, step in enumerate(steps) for party in _parties(step, top, ())}
        shown = [(number, step) for number, step in enumerate(steps) if step.shown]
        once = [entry for entry in shown if entry[0] < repeats_from]
        for number, step in (*once[:MOST_STEPS], *shown[len(once) :][:MOST_STEPS]):
            parties = _parties(step, top, (step.channel,) if step.channel else ())
            already = [each for each in self._waiting if last.get(each.path, -1) < number]
            place = self._place(parties, already)
            if place is None:
                continue
            process, communicating, waiting = place
            alone = f" of {step.parties[0].name}" if len(step.parties) == 1 else ""
            repeated = ", again and again" if number >= repeats_from else ""
            yield {
                "process": process,
                "text": f"{event_text(step, top)}{alone}{repeated}",
                "communicating": communicating,
                "waiting": waiting,
            }

    def silent_round(self) -> Iterator[dict[str, Any]]:
        """What repeats forever, if none of it is shown: who takes part."""
        cycle, top = self._found.cycle, self._found.process
        if any(step.shown for step in cycle):
            return
        parties = list({party.path: party for step in cycle for party in _parties(step, top, ())}.values())
        place = self._place(parties)
        if place is not None:
            process, keys, _ = place
            who = ", ".join(each.path.partition(".")[2] or each.path for each in parties)
            text = f"{who}, again and again, without a communication or a delay"
            yield {"process": process, "text": text, "communicating": keys, "waiting": []}

    def end(self) -> Iterator[dict[str, Any]]:
        """Which processes wait, if any do, or what a specification does not allow."""
        waiting = self._waiting
        place = self._place(waiting)
        if place is not None:
            process, keys, _ = place
            words = "; ".join(f"{each.path.partition('.')[2] or each.path} waits {each.words}" for each in waiting)
            yield {"process": process, "text": words, "communicating": [], "waiting": keys}
        elif self._found.failure == "refinement" and self._found.reason:
            yield {"process": self._found.process, "text": self._found.reason, "communicating": [], "waiting": []}

    def _place(
        self, parties: Sequence[StuckProcess], already: Sequence[StuckProcess] = ()
    ) -> tuple[str, list[str], list[str]] | None:
        """The process around some parties, the keys of the elements of its diagrams that concern them, and those of
        others, which concern processes that wait ``already``; None if there is no such process.
        """
        path, top = path_around(parties), self._found.process
        definition = definition_at(self._program, path.split(".")) if path.split(".")[0] == top else None
        if definition is None:
            return None
        name = definition.name.text
        keys, waiting = self._composed(name, path, parties), self._composed(name, path, already)
        drawn = surroundings(self._program, top, parties, self._declared)
        if drawn is not None:
            diagram, marks = drawn
            keys = [*marks, *keys]
            waiting = [*marks_beside(diagram, parties, already, self._declared), *waiting]
        return name, keys, [key for key in waiting if key not in keys]

    def _composed(self, name: str, path: str, processes: Sequence[StuckProcess]) -> list[str]:
        """The elements of the composition of a definition, that of the process at a path, which concern processes."""
        definition = self._program.definitions.get(name)
        if not isinstance(definition, ast.ProcessDefinition):
            return []
        if name not in self._compositions:
            self._compositions[name] = composition_diagram(self._program.definitions, definition)
        # Pictures have elements of both diagrams, and those of compositions begin with this.
        return [f"step-{key}" for key in steps_beside(self._compositions[name], path, processes)]


def _parties(step: Step, top: str, channels: tuple[str, ...]) -> list[StuckProcess]:
    return [
        StuckProcess(each.path or f"{top}.{each.name}", each.words, channels=channels, span=each.span)
        for each in step.parties
    ]
