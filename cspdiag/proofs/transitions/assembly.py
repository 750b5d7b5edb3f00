"""Puts threads and channels together: every label of every thread becomes events with parties."""

from __future__ import annotations

from collections import defaultdict
from typing import Literal, assert_never

from cspdiag.base.record import record
from cspdiag.proofs.transitions.channel_events import ChannelEvents, Use
from cspdiag.proofs.transitions.classes.built_in_exceptions import FAULT, TIMEOUT
from cspdiag.proofs.transitions.occurrences import MediumFacts
from cspdiag.proofs.transitions.places import Places
from cspdiag.proofs.transitions.specifications import specification_abstractions
from cspdiag.proofs.transitions.systems.labels import (
    Alarm,
    Alone,
    Bind,
    Bound,
    Cancel,
    Cancelled,
    Delivered,
    End,
    Fork,
    Guarded,
    Input,
    Internal,
    Join,
    Label,
    Load,
    Miss,
    OfParent,
    Output,
    Read,
    Ready,
    Sample,
    Start,
    Store,
    Throw,
    Thrown,
    Time,
    Withdrawn,
    Write,
)
from cspdiag.proofs.transitions.systems.shape import Shape
from cspdiag.proofs.transitions.systems.system import INTERNAL, Abstraction, Component, Edge, EventKind, System
from cspdiag.proofs.transitions.systems.template import Template
from cspdiag.proofs.transitions.threads.alarms import Alarms, withdrawn
from cspdiag.proofs.transitions.threads.place_templates import MISSED_A_SAMPLE
from cspdiag.proofs.transitions.threads.thread import resolve
from cspdiag.proofs.transitions.threads.threads import ParallelKey, ThreadInstance, ThreadTree, parallel_key
from cspdiag.proofs.transitions.values import UNKNOWN, Known


@record
class Outside:
    """The event of a label that involves only the environment: its kind, what its party does, and whether
    specifications see it.
    """

    kind: EventKind
    role: Literal["!", "?", "*"]
    visible: bool = False


_OUTSIDE: dict[type[Alone], Outside] = {
    Input: Outside("external", "?", visible=True),
    Output: Outside("external", "!", visible=True),
    Sample: Outside("sample", "?", visible=True),
    Miss: Outside("miss", "?"),
    Ready: Outside("ready", "*"),
}


class Assembly(ChannelEvents):
    """Makes the system of all threads."""

    def __init__(self, tree: ThreadTree) -> None:
        super().__init__(tree)
        self.tree = tree
        self._shapes: dict[tuple[int, bool, frozenset[Label]], Shape] = {}
        self._uses: dict[MediumFacts, list[Use]] = defaultdict(list)
        self._forks: dict[ParallelKey, list[ThreadInstance]] = {}

    def system(self) -> System:
        """All components and events."""
        for thread in self.threads:
            self.abstractions.update(thread.template.abstractions)
        world = self.tree.world
        if world.facts.specification is not None:
            self.abstractions.update(dict.fromkeys(specification_abstractions(world)))
        shapes = self._shaped()
        for thread, shape in zip(self.threads, shapes, strict=True):
            for label in shape.labels:
                self._note(thread, label)
        for medium, uses in self._uses.items():
            self.meet(medium, uses)
            if medium.coarse:
                what = f"of the values in `{medium.name}` only ranges are distinguished"
                self.abstractions[Abstraction(what, medium.span)] = None
        for key in self._forks:
            self._composition(key, shapes)
        components = [self._component(thread, shape) for thread, shape in zip(self.threads, shapes, strict=True)]
        apart = self.tree.world.inputs
        return System((*components, *self.extra), tuple(self.events), tuple(self.abstractions), apart)

    def _shaped(self) -> list[Shape]:
        """The state machines of all threads; where a parent starts a parallel before anything else, its branches have
        been started already.
        """
        started: set[ThreadInstance] = {self.tree.top}
        shapes: list[Shape] = []
        alarms = Alarms(self.threads)
        for thread in self.threads:
            shape = self._shape(thread.template, thread in started, alarms.silent(thread))
            shapes.append(shape)
            for key in shape.forked_at_once:
                started.update(self.tree.branches[parallel_key(thread.occurrence, key)])
        return shapes

    def _shape(self, template: Template, started: bool, silent: frozenset[Label]) -> Shape:
        key = (id(template), started, silent)
        if key not in self._shapes:
            self._shapes[key] = Shape(template, started=started, never=silent)
        return self._shapes[key]

    def _component(self, thread: ThreadInstance, shape: Shape) -> Component:
        of = self._of[thread.number]
        events = [(INTERNAL,) if isinstance(label, Internal) else of.get(label, ()) for label in shape.labels]
        edges: list[tuple[Edge, ...]] = []
        for compiled in shape.edges:
            edges.append(tuple([(event, target) for number, target in compiled for event in events[number]]))
        if self._echoes[thread.number]:
            edges = self._with_echoes(edges, thread, shape)
        return Component(
            thread.name,
            tuple(edges),
            shape.terminal,
            places=Places(shape.places, thread),
            failed=frozenset(state for state in shape.terminal if shape.places[state].words == MISSED_A_SAMPLE),
            path=thread.occurrence.path,
            span=thread.span,
        )

    def _with_echoes(
        self, edges: list[tuple[Edge, ...]], thread: ThreadInstance, shape: Shape
    ) -> list[tuple[Edge, ...]]:
        echoes = self._echoes[thread.number]
        labelled = [[(shape.labels[number], target) for number, target in compiled] for compiled in shape.edges]
        found: list[tuple[Edge, ...]] = []
        for state, (own, present, unsteady) in enumerate(zip(edges, labelled, withdrawn(labelled), strict=True)):
            shown = [
                (event, state)
                for label, _ in present
                for event in echoes.get(label, ())
                if event not in self._of_the_unsteady or label in unsteady
            ]
            found.append((*own, *dict.fromkeys(shown)))
        return found

    def _note(self, thread: ThreadInstance, label: Label) -> None:
        match label:
            case Alarm():
                self._alarm(thread, label)
            case Input() | Output() | Sample() | Miss() | Ready():
                self._outside(thread, label)
            case Time():
                words = f"{thread.name}: {label.words}"
                event = self._event(words, (thread.number,), "time", roles="*", instant=label.instant)
                self._for(thread, label, event)
            case (
                Read() | Write() | Guarded() | Bind() | Bound() | Load() | Store() | Delivered() | Withdrawn()
            ):  # fmt: skip
                self._uses[resolve(thread.occurrence, label.reference)].append((thread, label))
            case Fork() | Join():
                self._forks.setdefault(parallel_key(thread.occurrence, label.parallel), []).append(thread)
            case Internal() | Cancel() | Thrown() | Start() | End() | Cancelled() | Throw():
                pass  # It has no event, or ``_composition`` makes it.
            case _:
                assert_never(label)

    def _outside(self, thread: ThreadInstance, label: Alone) -> None:
        medium = resolve(thread.occurrence, label.reference)
        value: Known = UNKNOWN if isinstance(label, Miss | Ready) else label.value
        outside = _OUTSIDE[type(label)]
        parties = (thread.number,)
        event = self._event(
            medium.name, parties, outside.kind, value, medium.type, visible=outside.visible, roles=outside.role
        )
        self._for(thread, label, event)

    def _composition(self, key: ParallelKey, shapes: list[Shape]) -> None:
        branches = self.tree.branches[key]
        parents = [
            (thread, label)
            for thread in dict.fromkeys(self._forks[key])
            for label in shapes[thread.number].labels
            if isinstance(label, OfParent) and parallel_key(thread.occurrence, label.parallel) == key
        ]
        for parent, label in parents:
            match label:
                case Fork():
                    self._together(key, parent, label, (Start(), "start"), shapes)
                case Join():
                    self._together(key, parent, label, (End(), "end"), shapes)
                case Cancel():
                    self._together(key, parent, label, (Cancelled(), "cancel"), shapes)
                case Thrown():
                    self._thrown(parent, label, branches[label.branch], shapes)
                case _:
                    assert_never(label)

    def _together(
        self,
        key: ParallelKey,
        parent: ThreadInstance,
        label: Label,
        theirs: tuple[Label, EventKind],
        shapes: list[Shape],
    ) -> None:
        """What the parent of a parallel and all its branches do at once."""
        branches = self.tree.branches[key]
        of_branch, kind = theirs
        if not all(of_branch in shapes[branch.number].label_numbers for branch in branches):
            return
        parties = (parent.number, *(branch.number for branch in branches))
        event = self._event(f"{key[0].path}: parallel {kind}", parties, kind)
        self._for(parent, label, event)
        for branch in branches:
            self._for(branch, of_branch, event)

    def _thrown(self, parent: ThreadInstance, label: Thrown, branch: ThreadInstance, shapes: list[Shape]) -> None:
        throw = Throw(label.exception)
        if throw in shapes[branch.number].label_numbers:
            kind: EventKind = "failure" if label.exception in (FAULT, TIMEOUT) else "exception"
            event = self._event(f"{branch.name}: {label.exception}", (parent.number, branch.number), kind)
            self._for(parent, label, event)
            self._for(branch, throw, event)
