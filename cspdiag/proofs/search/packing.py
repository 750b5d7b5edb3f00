"""Global states packed into 64-bit words, and the steps of a system as arithmetic on them.

Every component has a bit field in one word. A step replaces the fields of its parties, which takes one addition for
each word, because their old contents are known: so whole layers of states take a step at once (as numpy vectors). The
two highest bits of a word are unused, so a state plus one is a positive number.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import cached_property
from itertools import product
from math import prod
from typing import TypeAlias

import numpy as np
import numpy.typing as npt

from cspdiag.base.record import record
from cspdiag.proofs.transitions.systems.system import INTERNAL, Component, System

Words: TypeAlias = list[npt.NDArray[np.int64]]
"""States: the arrays of their first, second, … words, all of one length."""

Flags: TypeAlias = npt.NDArray[np.bool_]
Indices: TypeAlias = npt.NDArray[np.intp]

WORD_BITS = 62
MOST_PATTERNS = 8
"""An event with more combinations of edges than this is looked up in tables, party by party, instead of compared."""


@record
class Field:
    """The bit field of a component: the index of its ``word``, and the ``mask`` to apply after shifting right."""

    word: int
    shift: int
    mask: int

    def of(self, words: Words) -> Indices:
        """The component's state in each of the global states."""
        return (words[self.word] >> self.shift) & self.mask


@record
class Pattern:
    """A step that is possible in states with certain values in the masked bits of some words, and adds a number to each
    of these words.
    """

    event: int
    parts: tuple[tuple[int, int, int, int], ...]
    """For each word: its index, the mask, the value under the mask, and what is added."""

    def enabled(self, words: Words) -> Flags:
        """Where the step is possible."""
        word, mask, value, _ = self.parts[0]
        found: Flags = (words[word] & mask) == value
        for word, mask, value, _ in self.parts[1:]:
            found &= (words[word] & mask) == value
        return found

    def after(self, words: Words, at: Indices) -> Words:
        """The states after the step from those ``at`` which it is possible."""
        result = [word.take(at) for word in words]
        for word, _, _, delta in self.parts:
            result[word] += delta
        return result


@record
class Lookup:
    """A step that is possible where each party's table says so, and adds what each party's table says."""

    event: int
    parties: tuple[tuple[Field, Flags, npt.NDArray[np.int64]], ...]

    def enabled(self, words: Words) -> Flags:
        """Where the step is possible."""
        field, offers, _ = self.parties[0]
        found: Flags = offers.take(field.of(words))
        for field, offers, _ in self.parties[1:]:
            found &= offers.take(field.of(words))
        return found

    def after(self, words: Words, at: Indices) -> Words:
        """The states after the step from those ``at`` which it is possible."""
        before = [word.take(at) for word in words]
        result = [word.copy() for word in before]
        for field, _, deltas in self.parties:
            result[field.word] += deltas.take(field.of(before))
        return result


Step: TypeAlias = Pattern | Lookup


class Packing:
    """The packing of the states of a system, and its steps."""

    def __init__(self, system: System) -> None:
        self.system = system
        self.fields = tuple(_fields(system.components))
        self.words = 1 + max((field.word for field in self.fields), default=0)

    @cached_property
    def steps(self) -> tuple[Step, ...]:
        """All steps: of every event, and of every internal edge."""
        return tuple(self._steps())

    def pack(self, states: Sequence[Sequence[int]]) -> Words:
        """Packs global states, each given by the states of all components."""
        words = [np.zeros(len(states), np.int64) for _ in range(self.words)]
        for at, state in enumerate(states):
            for field, local in zip(self.fields, state, strict=True):
                words[field.word][at] |= local << field.shift
        return words

    def unpack(self, words: Words, at: int) -> tuple[int, ...]:
        """The states of the components in one global state."""
        plain = [int(word[at]) for word in words]
        return tuple((plain[field.word] >> field.shift) & field.mask for field in self.fields)

    def _steps(self) -> Iterator[Step]:
        edges = [edges_by_event(component) for component in self.system.components]
        for party, by_event in enumerate(edges):
            if INTERNAL in by_event:
                yield from self._steps_of(INTERNAL, (party,), [by_event[INTERNAL]])
        for event, known in enumerate(self.system.events):
            yield from self._steps_of(event, known.parties, [edges[party].get(event, []) for party in known.parties])

    def _steps_of(
        self, event: int, parties: Sequence[int], choices: Sequence[Sequence[tuple[int, int]]]
    ) -> Iterator[Step]:
        """The steps with one event; ``choices`` has the states before and after for each party."""
        combinations = prod(len(choice) for choice in choices)
        if 0 < combinations <= MOST_PATTERNS:
            for combination in product(*choices):
                yield self._pattern(event, parties, combination)
        elif combinations:
            for functions in product(*(_functions(choice) for choice in choices)):
                yield self._lookup(event, parties, functions)

    def _pattern(self, event: int, parties: Sequence[int], edges: Sequence[tuple[int, int]]) -> Pattern:
        parts: dict[int, tuple[int, int, int]] = {}
        for party, (source, target) in zip(parties, edges, strict=True):
            field = self.fields[party]
            mask, value, delta = parts.get(field.word, (0, 0, 0))
            parts[field.word] = (
                mask | field.mask << field.shift,
                value | source << field.shift,
                delta + ((target - source) << field.shift),
            )
        return Pattern(event, tuple((word, *part) for word, part in parts.items()))

    def _lookup(self, event: int, parties: Sequence[int], functions: Sequence[dict[int, int]]) -> Lookup:
        tables = []
        for party, function in zip(parties, functions, strict=True):
            field = self.fields[party]
            offers = np.zeros(field.mask + 1, np.bool_)
            deltas = np.zeros(field.mask + 1, np.int64)
            for source, target in function.items():
                offers[source] = True
                deltas[source] = (target - source) << field.shift
            tables.append((field, offers, deltas))
        return Lookup(event, tuple(tables))


def edges_by_event(component: Component) -> dict[int, list[tuple[int, int]]]:
    """For each event of a component, the states before and after."""
    found: dict[int, list[tuple[int, int]]] = {}
    for source, edges in enumerate(component.edges):
        for event, target in dict.fromkeys(edges):
            found.setdefault(event, []).append((source, target))
    return found


def _fields(components: Iterable[Component]) -> Iterator[Field]:
    word, shift = 0, 0
    for component in components:
        bits = (len(component.edges) - 1).bit_length()
        if shift + bits > WORD_BITS:
            word, shift = word + 1, 0
        yield Field(word, shift, (1 << bits) - 1)
        shift += bits


def _functions(edges: Sequence[tuple[int, int]]) -> list[dict[int, int]]:
    """Edges with one event as partial functions from states to states; more than one function if a state has several
    edges.
    """
    functions: list[dict[int, int]] = []
    for source, target in edges:
        for function in functions:
            if source not in function:
                function[source] = target
                break
        else:
            functions.append({source: target})
    return functions
