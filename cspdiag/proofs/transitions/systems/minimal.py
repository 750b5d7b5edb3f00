"""Merges the states of a template that no observer can distinguish.

Such states differ, for example, in the value of a variable that is written before it is read again. The partition of
the states is refined until all states of a class lead to the same classes by the same labels (strong bisimulation,
Kanellakis and Smolka 1983); only states with the same description are merged.
"""

from __future__ import annotations

from cspdiag.proofs.transitions.systems.labels import Label
from cspdiag.proofs.transitions.systems.template import Template

_MOST_WORK = 400_000
"""States times rounds; a template that would take more stays as it is."""


def minimized(template: Template) -> Template:
    """The template with bisimilar states merged; the first state stays the first."""
    size = len(template.edges)
    labels: dict[Label, int] = {}
    edges = [[(labels.setdefault(label, len(labels)), target) for label, target in found] for found in template.edges]
    of, number = _numbered([(place, state in template.terminal) for state, place in enumerate(template.places)])
    for _ in range(max(1, _MOST_WORK // size)):
        refined, more = _numbered(
            [(of[state], frozenset([(label, of[target]) for label, target in edges[state]])) for state in range(size)]
        )
        if more == number:
            return template if number == size else _merged(template, of, number)
        of, number = refined, more
    return template


def _numbered(keys: list[object]) -> tuple[list[int], int]:
    numbers: dict[object, int] = {}
    return [numbers.setdefault(key, len(numbers)) for key in keys], len(numbers)


def _merged(template: Template, of: list[int], number: int) -> Template:
    first = [0] * number
    for state in range(len(of) - 1, -1, -1):
        first[of[state]] = state
    template.edges = [
        list(dict.fromkeys((label, of[target]) for label, target in template.edges[state])) for state in first
    ]
    template.places = [template.places[state] for state in first]
    template.terminal = {of[state] for state in template.terminal}
    return template
