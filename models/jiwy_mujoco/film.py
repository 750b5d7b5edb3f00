"""A film of a recorded run of the environment ``Contacts``: ``python film.py RUN.npz FILM.gif``.

It needs mujoco, Pillow, and OpenGL without a screen: ``MUJOCO_GL=egl`` (Debian: libegl1) or ``osmesa`` (libosmesa6).
"""

import os
import sys
from pathlib import Path

os.environ.setdefault("MUJOCO_GL", "egl")

import mujoco
import numpy
from PIL import Image

sys.path.insert(0, str(Path(__file__).parent))
from machine import MODEL

FRAMES_PER_SECOND = 10
START = {"feedback_horizontal": 0.3, "feedback_vertical": -0.4}
"""The angles at which the encoders count zero, as ``Contacts`` gives them."""


def frames(recording: str) -> list[Image.Image]:
    """Pictures at equal distances in time of the angles that the encoders reported."""
    model = mujoco.MjModel.from_xml_string(MODEL)
    data = mujoco.MjData(model)
    with numpy.load(recording) as run:
        ends = max(run[f"{name}.time"][-1] for name in START)
        instants = numpy.arange(0, ends, 1 / FRAMES_PER_SECOND)
        angles = [numpy.interp(instants, run[f"{name}.time"], run[name]) + start for name, start in START.items()]
    found = []
    with mujoco.Renderer(model, height=360, width=480) as renderer:
        for both in zip(*angles, strict=True):
            data.qpos[:] = both
            mujoco.mj_forward(model, data)
            renderer.update_scene(data, camera="side")
            found.append(Image.fromarray(renderer.render()))
    return found


def main() -> None:
    """Write the film."""
    if len(sys.argv) != 3:
        sys.exit("usage: python film.py RUN.npz FILM.gif")
    recording, film = sys.argv[1:]
    first, *others = frames(recording)
    first = first.quantize(128)
    others = [frame.quantize(palette=first, dither=Image.Dither.NONE) for frame in others]
    first.save(film, save_all=True, append_images=others, duration=1000 // FRAMES_PER_SECOND, loop=0)
    print(f"wrote {film}: {len(others) + 1} frames")


if __name__ == "__main__":
    main()
