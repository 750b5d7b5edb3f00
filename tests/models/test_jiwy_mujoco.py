"""JIWY's controller on a machine in MuJoCo."""

import subprocess
import sys
from pathlib import Path

import pytest

import cspdiag
from cspdiag.simulate.result import Run
from tests.models.programs import MODELS

pytest.importorskip("mujoco", reason="needs mujoco: pip install mujoco")

FOLDER = MODELS / "jiwy_mujoco"


@pytest.fixture(scope="module")
def run() -> Run:
    return cspdiag.load(FOLDER / "contacts.csp").run("Contacts")


def test_both_joints_meet_their_posts_and_follow_the_joystick(run: Run) -> None:
    assert run.outcome.ended == "terminated"
    # The encoders count from where the machine was switched on.
    for port, start, least, greatest in (("horizontal", 0.3, -1.62, 1.5), ("vertical", -0.4, -2.05, 1.85)):
        angles = run[f"feedback_{port}"] + start
        assert angles.min() == pytest.approx(least, abs=0.01), port
        assert angles.max() == pytest.approx(greatest, abs=0.01), port
    # The joints end at the centre between their stops.
    assert run["feedback_horizontal"][-1] + 0.3 == pytest.approx((1.5 - 1.62) / 2, abs=0.02)
    assert run["feedback_vertical"][-1] - 0.4 == pytest.approx((1.85 - 2.05) / 2, abs=0.02)


def test_the_film_of_a_recording_has_ten_frames_in_a_second(run: Run, tmp_path: Path) -> None:
    image = pytest.importorskip("PIL.Image", reason="needs Pillow")
    recording = tmp_path / "run.npz"
    command = [sys.executable, "-m", "cspdiag", "run", str(FOLDER / "contacts.csp"), "--environment", "Contacts"]
    subprocess.run([*command, "--for", "500ms", "--record", str(recording)], check=True, capture_output=True)
    film = tmp_path / "film.gif"
    done = subprocess.run(
        [sys.executable, str(FOLDER / "film.py"), str(recording), str(film)],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    if done.returncode != 0 and "GL" in done.stderr:
        pytest.skip("no OpenGL without a screen: install libegl1")
    assert done.returncode == 0, done.stderr
    with image.open(film) as pictures:
        assert pictures.n_frames == 5
        pictures.seek(4)
        assert len(pictures.convert("RGB").getcolors(1 << 20)) > 20
