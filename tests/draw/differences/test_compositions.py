"""What differs between two versions of a composition."""

from __future__ import annotations

from random import Random

import pytest
from hypothesis import HealthCheck, given, note, settings
from hypothesis import strategies as st

from cspdiag.draw.composition.diagram import draw_composition
from cspdiag.draw.elements.compare_compositions import Compared, compared, own_text
from cspdiag.draw.elements.composition import CompositionDiagram, Part, outline, parts, rebuilt
from tests.draw.composition.random_compositions import random_composition
from tests.draw.composition.test_composition import diagram
from tests.draw.geometry.compositions import faults


def content(element: Part, without: frozenset[str] = frozenset()) -> tuple[object, ...]:
    inner = (content(part, without) for part in parts(element) if part.key not in without)
    return (type(element), own_text(element), *inner)


def changes(before: str, after: str) -> list[str]:
    return [str(change) for change in compared(diagram(before), diagram(after)).changes]


@pytest.mark.parametrize(
    ("before", "after", "expected"),
    [
        ("a ; b ; c", "a ; c", ["process b removed"]),
        ("a ; c", "a ; b ; c", ["process b added"]),
        ("a ; b ; c", "a ; (x := 1 || skip) ; c", ["process b removed", "process (x := 1 || skip) added"]),
        ("a || b", "a ||> b", ["operator || → ||>"]),
        ("a ; b", "a || b", ["operator ; → ||"]),
        ("mu a until x", "mu a until x > 3", ["condition x → x > 3"]),
        ("mu a", "while x do a", ["loop mu → while", "condition x added"]),
        ("a ; b", "a ; (mu b until x)", ["loop mu until x added"]),
        ("a", "a catch E -> skip", ["handler catch E -> skip added"]),
        ("a", "a ; b", ["process b added"]),
        ("a ; (mu b)", "a ; b", ["process (mu b) removed", "process b added"]),
        ("a ; control ! 0", "a ; control ! 1", ["process control ! 0 → control ! 1"]),
        (
            "a ? x -> skip [] b -> c",
            "a ? x -> skip [] when x < 3 & b -> c",
            ["guard b → when x < 3 & b"],
        ),
        ("a ? x -> skip [] b -> c", "b -> c [] after 1 ms -> skip", [
            "process a ? x -> skip removed", "process after 1 ms -> skip added",
        ]),
        ("if x then a else b", "if x then a else if y then c else b", ["condition if y then c added"]),
        ("if x then a else b", "if x then a", ["process b removed"]),
        ("a catch E -> b", "a catch E -> b catch F -> c", ["handler catch F -> c added"]),
        ("a interrupt b -> c", "a interrupt b ? x -> c", ["guard b → b ? x"]),
        ("par i < 3 : a", "par i < 4 : a", ["replication || for i < 3 → || for i < 4"]),
        ("h: a", "v: a", ["group h: → v:"]),
    ],
)  # fmt: skip
def test_changes_are_reported_as_small_as_they_are(before: str, after: str, expected: list[str]) -> None:
    assert changes(before, after) == expected


def test_renamed_instances_are_no_change_of_the_composition() -> None:
    old, new = diagram("mu (a ; x := a1) until a.x"), diagram("mu (b ; x := a1) until b.x")
    assert compared(old, new).changes != ()
    assert compared(old, new, {"a": "b"}).changes == ()


def test_an_added_or_removed_composition_is_one_change() -> None:
    without = CompositionDiagram(key="P", root=None)
    addition = compared(without, diagram("a ; b"))
    assert [change.action for change in addition.changes] == ["added"]
    removal = compared(diagram("a ; b"), without)
    assert [change.action for change in removal.changes] == ["removed"]
    assert {mark.kind for mark in addition.marks.values()} == {"added"}
    assert outline(addition.diagram) == outline(removal.diagram)
    assert compared(without, without).changes == ()


def edited(seed: int) -> tuple[str, str]:
    """A composition, and the same after some parts of its chain were added, removed or replaced."""
    random = Random(seed)
    before = [f"({random_composition(seed + number)})" for number in range(random.randint(2, 6))]
    after = list(before)
    for _ in range(random.randint(1, 3)):
        place = random.randrange(len(after) + 1)
        after[place : place + random.randint(0, 1)] = [f"({random_composition(random.randrange(10**6))})"]
    return tuple(random.choice((" ; ", " || ")).join(each) for each in (before, after))  # type: ignore[return-value]


@settings(max_examples=15, deadline=None, suppress_health_check=list(HealthCheck))
@given(st.integers(min_value=0))
def test_what_is_left_without_the_removed_is_the_new_version(seed: int) -> None:
    before, after = edited(seed)
    note(f"{before}\n\n{after}")
    found = compared(diagram(before), diagram(after))
    expected = diagram(after).root
    assert found.diagram.root is not None
    assert expected is not None
    removed = frozenset(key for key, mark in found.marks.items() if mark.kind == "removed")
    assert content(found.diagram.root, removed) == content(expected)
    assert {change.key for change in found.changes} <= {element.key for element in found.diagram.elements()}
    assert bool(found.changes) is (content(expected) != content(_root(before)))
    assert faults(draw_composition(found.diagram, marks=found.marks)) == []


def _root(text: str) -> Part:
    root = diagram(text).root
    assert root is not None
    return root


@settings(max_examples=25, deadline=None, suppress_health_check=list(HealthCheck))
@given(st.integers(min_value=0))
def test_equal_compositions_have_no_marks(seed: int) -> None:
    text = random_composition(seed)
    found: Compared = compared(diagram(text), diagram(text))
    assert found.marks == {}
    assert found.changes == ()
    assert outline(found.diagram) == outline(diagram(text))


def test_rebuilding_changes_nothing_but_the_key() -> None:
    for seed in range(40):
        root = _root(random_composition(seed))
        again = rebuilt(root, "7", parts(root))
        assert again.key == "7"
        assert content(again) == content(root)
