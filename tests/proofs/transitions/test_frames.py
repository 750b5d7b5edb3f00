"""Frames and labels are tuples, and instances of different classes are never equal."""

from __future__ import annotations

from types import ModuleType
from typing import get_args

import pytest

from cspdiag.proofs.transitions.systems import labels, references
from cspdiag.proofs.transitions.threads import frames


@pytest.mark.parametrize(("module", "union"), [(frames, frames.Frame), (labels, labels.Label)])
def test_a_kind_is_that_of_one_class(module: ModuleType, union: object) -> None:
    classes = get_args(union)
    kinds = {one._field_defaults["kind"] for one in classes}
    assert len(kinds) == len(classes)
    named = {one for one in vars(module).values() if isinstance(one, type) and hasattr(one, "_fields")}
    assert {one for one in named if "kind" in one._fields} == set(classes)


def test_an_interrupt_is_not_taken_for_what_is_left_of_it() -> None:
    node, context = object(), object()
    assert frames.Interrupt(node, context, 1) != frames.GuardOnly(node, context, 1)  # type: ignore[arg-type]
    assert labels.Fork(((), node)) != labels.Join(((), node))  # type: ignore[arg-type]


def test_references_of_different_classes_differ() -> None:
    different = [
        references.OwnPort("x", None),
        references.InnerChannel((), "x"),
        references.InnerChannel(("x",), "x"),
        references.Constant("x"),
        references.Discard(),
    ]
    assert len(set(different)) == len(different)
