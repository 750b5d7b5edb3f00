"""docs/notation.md: an up-to-date drawing of every construct."""

from __future__ import annotations

from typing import get_args

import pytest

from cspdiag.draw.composition.diagram import draw_composition
from cspdiag.draw.elements.composition import (
    OPERATORS,
    Activity,
    ActivityForm,
    Case,
    Chain,
    Choice,
    Condition,
    Guard,
    Guarded,
    GuardForm,
    Handler,
    Inside,
    Loop,
    NamedGroup,
    Part,
    Replication,
    Watched,
)
from distribution.notation_pictures import PAGE, example_diagram, examples, pictures
from tests.draw.geometry.compositions import faults

TEXT = PAGE.read_text(encoding="utf-8")


def elements() -> list[Part]:
    return [each for example in examples(TEXT).values() for each in example_diagram(TEXT, example).elements()]


def test_every_example_has_its_picture() -> None:
    assert len(examples(TEXT)) == TEXT.count("```composition") == TEXT.count("](pictures/")


def test_pictures_are_current() -> None:
    stale = [path.name for path, text in pictures() if path.read_text(encoding="utf-8") != text]
    assert stale == [], "python distribution/notation_pictures.py"


@pytest.mark.parametrize("picture", sorted(examples(TEXT)))
def test_examples_are_drawn_without_faults(picture: str) -> None:
    diagram = example_diagram(TEXT, examples(TEXT)[picture])
    assert faults(draw_composition(diagram)) == []
    assert all(each.kind != "unknown" for each in diagram.elements() if isinstance(each, Activity))


def test_no_construct_is_left_out() -> None:
    found = elements()
    sorts = {
        Activity,
        Chain,
        Condition,
        Guard,
        Guarded,
        Loop,
        Case,
        Choice,
        Handler,
        Watched,
        Replication,
        NamedGroup,
        Inside,
    }
    assert set(get_args(Part)) == sorts == {type(each) for each in found}
    assert {each.form for each in found if isinstance(each, Activity)} == set(get_args(ActivityForm))
    assert {each.form for each in found if isinstance(each, Guard)} == set(get_args(GuardForm))
    assert {each.form for each in found if isinstance(each, Loop)} == {"mu", "while"}
    assert {(each.operator, each.prioritized) for each in found if isinstance(each, Chain)} == set(OPERATORS)
