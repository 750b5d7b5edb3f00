"""A deadlock or a knot as a formula: one variable for every state of every component, and one for "is in the stuck
set".

Every model is a choice of states that are possible together for each pair of neighbours, and of a set of components
that wait only for each other. If no model exists, no reachable state is a deadlock or a knot (Antonino, Gibson-Robinson
and Roscoe, iFM 2016, extended by the stuck set).
"""

from __future__ import annotations

from collections.abc import Collection, Iterable

from cspdiag.proofs.sat.solver import Clause
from cspdiag.proofs.structure.pairs import Neighbour, Structure
from cspdiag.proofs.structure.waiting import WaitingOrder

LARGEST_PAIRWISE = 6
"""Up to this number of variables are made exclusive pairwise, more through a chain of auxiliary variables."""


class Encoding:
    """The formula for one system.

    ``variables[i][state]`` is the variable of a state of component ``i``; ``stuck[i]`` that of its membership in the
    stuck set, 0 for those that are never in it. With ``together`` all components are in the set (deadlock), and only
    waiting states have variables. A model is sought for each of the ``goals``, with its literals assumed: for knots,
    that a component (whose number comes first) requests something and is stuck. Refuting one goal often excludes many
    others.
    """

    def __init__(self, structure: Structure, waiting: WaitingOrder, *, together: bool) -> None:
        self.structure, self.left, self.together = structure, waiting.left, together
        self.clauses: list[Clause] = []
        self.variables: list[dict[int, int]] = []
        self.stuck: list[int] = []
        self.goals: list[tuple[int, Clause]] = []
        self._count = 0
        self._choose_states()
        for component, neighbours in enumerate(structure.neighbours):
            structure.limits.check()
            for neighbour in neighbours:
                if self.together:
                    self._exclude_pairs_that_continue(component, neighbour)
                else:
                    self._exclude_unreachable_pairs(component, neighbour)
                    self._wait_for(component, neighbour)
        self._wait_at_multiway_events()
        self._require_waiting()

    def fresh(self) -> int:
        """A new variable."""
        self._count += 1
        return self._count

    def _choose_states(self) -> None:
        for shape, left in zip(self.structure.shapes, self.left, strict=True):
            states = sorted(left) if self.together else shape.reachable
            first = self._count + 1
            self._count += len(states)
            variables = dict(zip(states, range(first, self._count + 1), strict=True))
            self.variables.append(variables)
            self._exactly_one(list(variables.values()))
            stuck = 0
            if not self.together and left:
                stuck = self.fresh()
                self.clauses += [[-stuck, -variable] for state, variable in variables.items() if state not in left]
            self.stuck.append(stuck)

    def _exactly_one(self, variables: list[int]) -> None:
        self.clauses.append(variables)
        if len(variables) <= LARGEST_PAIRWISE:
            self.clauses += [[-one, -two] for at, one in enumerate(variables) for two in variables[at + 1 :]]
            return
        # seen: one of the variables so far is true (the sequential encoding of Sinz, CP 2005).
        seen = variables[0]
        for variable in variables[1:]:
            self.clauses.append([-seen, -variable])
            following = self.fresh()
            self.clauses += [[-seen, following], [-variable, following]]
            seen = following

    def _exclude_pairs_that_continue(self, component: int, neighbour: Neighbour) -> None:
        if component > neighbour.component:
            return
        others = self.variables[neighbour.component]
        for state, variable in self.variables[component].items():
            allowed = [others[other] for other in neighbour.blocked[state] if other in others]
            if len(allowed) < len(others):
                self.clauses.append([-variable, *allowed])

    def _exclude_unreachable_pairs(self, component: int, neighbour: Neighbour) -> None:
        if component > neighbour.component or not neighbour.complete:
            return
        others = self.variables[neighbour.component]
        for state, variable in self.variables[component].items():
            reached = neighbour.reached.get(state, ())
            if len(reached) < len(others):
                self.clauses.append([-variable, *(others[other] for other in reached)])

    def _wait_for(self, component: int, neighbour: Neighbour) -> None:
        others, left = self.variables[neighbour.component], self.left[neighbour.component]
        stuck, partner = self.stuck[component], self.stuck[neighbour.component]
        for state in neighbour.requests:
            if state in self.left[component]:
                here = [-stuck, -self.variables[component][state]]
                self.clauses.append([*here, partner])
                self.clauses.append(here + [others[other] for other in neighbour.blocked[state] if other in left])
        for state, without_failure in neighbour.without_failure.items():
            if state in self.left[component]:
                here = [-stuck, -self.variables[component][state]]
                self.clauses.append(here + [others[other] for other in without_failure])

    def _wait_at_multiway_events(self) -> None:
        """Adds clauses for events with three or more parties: a process that offers one waits for a party that is stuck
        and does not offer it.
        """
        for roles, event in zip(self.structure.roles, self.structure.system.events, strict=True):
            if len(roles) < 3 or (event.kind == "failure" and not self.together):
                continue
            refused = self.fresh()
            refusing = [refused * -1]
            for party, number in roles:
                offering, others = self._split(party, number)
                stuck = self.stuck[party]
                if not self.together and not stuck:
                    continue
                self.clauses += [[-offered, refused, *([] if self.together else [-stuck])] for offered in offering]
                if others:
                    refuses = self.fresh()
                    self.clauses.append([-refuses, *others])
                    if not self.together:
                        self.clauses.append([-refuses, stuck])
                    refusing.append(refuses)
            self.clauses.append(refusing)

    def _split(self, party: int, number: int) -> tuple[list[int], list[int]]:
        """The variables of the remaining states of a party, first of those in which it offers an event of its shape,
        then of the others.
        """
        offers, variables = self.structure.shapes[party].offers, self.variables[party]
        offering = [variables[state] for state in self.left[party] if number in offers[state]]
        return offering, [variables[state] for state in self.left[party] if number not in offers[state]]

    def _require_waiting(self) -> None:
        waiting = []
        for component, (shape, left, variables, stuck) in enumerate(
            zip(self.structure.shapes, self.left, self.variables, self.stuck, strict=True)
        ):
            if self.together:
                waiting += [variables[state] for state in left if shape.process and state not in shape.terminal]
            elif left and left <= shape.requesting:
                self.goals.append((component, [stuck]))
            elif requesting := [variables[state] for state in left if state in shape.requesting]:
                requests = self.fresh()
                self.clauses += [[-requests, stuck], [-requests, *requesting]]
                self.goals.append((component, [requests]))
        if self.together:
            self.clauses.append(waiting)
            self.goals = [(-1, [])]

    @property
    def deepest(self) -> int:
        """The largest number of steps that a component needs from its initial state to one that has a variable."""
        return max(
            (
                shape.depths[state]
                for shape, of in zip(self.structure.shapes, self.variables, strict=True)
                for state in of
            ),
            default=0,
        )

    def within(self, depth: int) -> tuple[int, list[Clause]]:
        """A variable, and clauses: if the variable is true, no component is more than ``depth`` steps from its initial
        state.
        """
        near = self.fresh()
        return near, [
            [-near, -variable]
            for shape, variables in zip(self.structure.shapes, self.variables, strict=True)
            for state, variable in variables.items()
            if shape.depths[state] > depth
        ]

    def states(self, model: Collection[int]) -> tuple[int, ...]:
        """The state of every component in a model."""
        return tuple(
            next(state for state, variable in variables.items() if variable in model) for variables in self.variables
        )

    def stuck_components(self, model: Collection[int]) -> tuple[int, ...]:
        """The components that are in the stuck set of a model."""
        if self.together:
            return tuple(range(len(self.variables)))
        return tuple(component for component, stuck in enumerate(self.stuck) if stuck in model)

    def some_of(self, places: Iterable[tuple[int, int]]) -> Clause:
        """The clause that at least one of the given places, each a component and a state of it, is occupied."""
        return [self.variables[component][state] for component, state in places if state in self.variables[component]]
