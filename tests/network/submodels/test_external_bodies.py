"""Bodies in other languages are listed with their places."""

from __future__ import annotations

from cspdiag.network.lower.external_bodies import external_bodies
from tests.network.submodels.compiled import program

TEXT = """
submodel Plant python "models/plant.py:Plant" { in u : double  out y : double }
driver Stick python "devices.joystick:Stick" { out x : double }
process Filter c "filter.c" { in u : double  out y : double }
submodel Law { in u : double  out y : double  y = u }
"""


def test_external_bodies_are_listed_with_file_and_class() -> None:
    found = external_bodies(program(TEXT))
    assert [(b.definition, b.body.language, b.file, b.name) for b in found] == [
        ("Plant", "python", "models/plant.py", "Plant"),
        ("Stick", "python", "devices.joystick", "Stick"),
        ("Filter", "c", "filter.c", None),
    ]
    assert [b.body.span.text for b in found] == [
        '"models/plant.py:Plant"',
        '"devices.joystick:Stick"',
        '"filter.c"',
    ]
