"""Draws the pictures of the models and of docs/drawing.md; ``--check`` only reports which are out of date.

python distribution/model_pictures.py [--check]
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from cspdiag.base import SourceFile
from cspdiag.base.sources import read_source
from cspdiag.draw.communication.legend import legend
from cspdiag.draw.deadlock.ring import draw_deadlock
from cspdiag.draw.differences.picture import pictures_of
from cspdiag.draw.differences.programs import differences
from cspdiag.draw.elements.diagram import Arrow, Box, BoxKind, FlowKind, Sink, Store, Vertex
from cspdiag.draw.output.svg import render_svg
from cspdiag.draw.pictures import PictureOptions, Pictures, Which
from cspdiag.draw.scene.scene_geometry import fitted
from cspdiag.draw.scene.shapes import Scene
from cspdiag.pipeline import Checked, build, check, generate
from cspdiag.simulate.run.execute import simulate
from cspdiag.verify.deadlock_picture import deadlock_of

ROOT = Path(__file__).parent.parent
FOLDER = ROOT / "docs" / "pictures"

MISTAKE = ("joystick_buttons    -> broadcast ->", "joystick_buttons    ->")
"""The subject of the picture of a review: a press of the button that one joint can take from the other."""

CHANGES = (
    ("alignR        : Align(T, speed = alignSpeed,", "alignR        : Align(T, speed = 2 * alignSpeed,"),
    ("-> motionControl.rightmax, homing.rightmax", "-> motionControl.rightmax"),
    ("    homing        : Homing(T, gains = gains)\n", "    parking       : Homing(T, gains = panGains)\n"),
    ("homing.leftmax", "parking.leftmax, parking.rightmax"),
    ("motionControl.feedback, homing.feedback", "motionControl.feedback, parking.feedback"),
    ("motionControl.control, homing.control", "motionControl.control, parking.control"),
    ("alignL ; alignR ; motionControl ; homing", "alignL ; alignR ; motionControl ; parking"),
)
"""The subject of the picture of a difference."""


@dataclass(frozen=True)
class Picture:
    """A process or environment of a model, and how it is drawn."""

    model: str
    process: str
    which: Which = "both"
    depth: int = 1

    def scene(self) -> Scene:
        """The drawing."""
        checked = _checked(self.model)
        assert checked.program is not None
        pictures = Pictures(checked.program)
        definition = pictures.named(self.process)
        assert definition is not None
        return pictures.scene(definition, PictureOptions(self.which, depth=self.depth))


@cache
def _checked(model: str, *changes: tuple[str, str]) -> Checked:
    """A model with its text changed."""
    path = f"models/{model}.csp"
    text = (ROOT / path).read_text(encoding="utf-8")
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new)
    return check(SourceFile(name=path, text=text), _read)


def _read(path: str) -> SourceFile:
    return SourceFile(name=path, text=read_source(str(ROOT / path)).text)


def _review() -> Scene:
    checked = _checked("jiwy/jiwy", MISTAKE)
    assert checked.readable is not None
    pictures = Pictures(checked.readable, checked.report.diagnostics)
    definition = pictures.named("Jiwy")
    assert definition is not None
    return pictures.scene(definition)


def _difference() -> Scene:
    before, after = _checked("jiwy/jiwy").program, _checked("jiwy/jiwy", *CHANGES).program
    assert before is not None
    assert after is not None
    return pictures_of(differences(before, after))[0]


def _symbols() -> Scene:
    """Everything that a legend can explain."""
    kinds: tuple[FlowKind, ...] = ("sync", "var", "broadcast", "any", "buffer", "overwrite", "sampled", "event")
    arrows = [Arrow(key=kind, sources=(), sinks=(), kinds=(kind,)) for kind in kinds]
    arrows.append(Arrow(key="several", sources=(), sinks=(), kinds=("sync", "var")))
    arrows.append(Arrow(key="itself", sources=(), sinks=(), by_composition=True))
    boxes: tuple[BoxKind, ...] = ("process", "submodel", "driver", "unknown")
    vertices: list[Vertex] = [Box(key=kind, kind=kind, definition="") for kind in boxes]
    vertices += [
        Box(key="hand-written", kind="process", definition="", language="c"),
        Store(key="variable", form="variable", type=""),
        Store(key="channel", form="channel", type=""),
        Sink(key="sink"),
    ]
    explained = legend(vertices, arrows, 640)
    assert explained is not None
    return fitted([explained], title="symbols", name="symbols")


def _deadlock() -> Scene:
    path = "models/dining/deadlock.csp"
    built = build(SourceFile(name=path, text=(ROOT / path).read_text(encoding="utf-8")), _read)
    assert built.network is not None
    run = simulate(built.network, generate(built.network, _read))
    assert run.outcome.deadlock is not None
    return draw_deadlock(deadlock_of(run.outcome.deadlock, built.network), built.checked.program)


PICTURES: dict[str, Callable[[], Scene]] = {
    "jiwy/figure-3a": Picture("jiwy/jiwy", "JointControl", "communication").scene,
    "jiwy/figure-3b": Picture("jiwy/jiwy", "Jiwy", "composition", depth=2).scene,
    "jiwy/figure-4": Picture("jiwy/jiwy", "MotionControl").scene,
    "jiwy/figure-7": Picture("jiwy/jiwy", "Align").scene,
    "jiwy/figure-10": Picture("jiwy/jiwy", "Homing").scene,
    "jiwy/jiwy": Picture("jiwy/jiwy", "Jiwy").scene,
    "jiwy/inside": Picture("jiwy/jiwy", "Jiwy", "communication", depth=2).scene,
    "jiwy/bench": Picture("jiwy/jiwy", "Bench").scene,
    "buffer": Picture("buffer/buffer", "Line").scene,
    "cascade": Picture("cascade/cascade", "Cascade").scene,
    "commstime": Picture("commstime/commstime", "Commstime").scene,
    "dining": Picture("dining/dining", "Table").scene,
    "emergency": Picture("emergency/emergency", "Spindle").scene,
    "ring": Picture("ring/ring", "Ring").scene,
    "watchdog": Picture("watchdog/watchdog", "Oven").scene,
    "symbols": _symbols,
    "check": _review,
    "diff": _difference,
    "deadlock": _deadlock,
}


def pictures() -> Iterator[tuple[Path, str]]:
    """The path and the text of each picture."""
    for name, scene in PICTURES.items():
        yield FOLDER / f"{name}.svg", render_svg(scene())


def main(arguments: list[str]) -> int:
    """Write the pictures, or check them; returns 1 if one is out of date."""
    stale = [(path, text) for path, text in pictures() if not path.exists() or path.read_text(encoding="utf-8") != text]
    for path, text in stale:
        if "--check" in arguments:
            print(f"{path.relative_to(ROOT)} is out of date: make pictures")
        else:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8")
            print(f"wrote {path.relative_to(ROOT)}")
    return 1 if stale and "--check" in arguments else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
