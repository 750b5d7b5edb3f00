"""Arrays of which the elements share their names."""

from __future__ import annotations

from collections.abc import Sequence

import pytest

from cspdiag.runtime import Numbered, Rendezvous, numbered


def named(names: Sequence[str]) -> list[Rendezvous[int]]:
    return numbered(Rendezvous[int](name) for name in names)


@pytest.mark.parametrize("count", [0, 1, 2, 3, 12, 1001])
@pytest.mark.parametrize("after", ["", ".output", ".x[1]"])
def test_each_element_has_the_name_with_which_it_was_made(count: int, after: str) -> None:
    names = [f"Top.cell[{number}]{after}" for number in range(count)]
    assert [channel.name for channel in named(names)] == names


def test_elements_share_an_object_in_place_of_their_names() -> None:
    channels = named([f"c[{number}]" for number in range(20)])
    assert len({id(channel.label) for channel in channels}) == 1
    assert not isinstance(channels[0].label, str)


@pytest.mark.parametrize(
    "names",
    [
        ["a", "b", "c"],
        ["c", "c", "c"],
        ["c[1]", "c[2]", "c[3]"],
        ["c[0]", "c[2]", "c[4]"],
        ["c[0].d[0]", "c[1].d[1]", "c[2].d[2]"],
        ["c[10]", "c[11]", "c[12]"],
        ["c[0]", "c[1]", "c[2]", "other", "c[4]", "c[05]"],
        ["long", "longer"],
    ],
)
def test_elements_that_are_not_numbered_in_order_keep_their_names(names: list[str]) -> None:
    assert [channel.name for channel in named(names)] == names


def test_processes_of_an_array_have_their_names_before_and_after_they_are_in_it() -> None:
    seen = list[str]()

    class Cell(Numbered):
        def __init__(self, name: str) -> None:
            super().__init__(name)
            seen.append(self.name)

    names = [f"Top.cell[{number}]" for number in range(12)]
    assert [cell.name for cell in numbered(Cell(name) for name in names)] == seen == names
    assert Cell("Top.single").name == "Top.single"
