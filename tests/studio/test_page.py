"""The page of the studio: its own tests, and what it has to know of the language and of diagrams."""

from __future__ import annotations

import gzip
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from cspdiag.draw.scene.palette import Scheme, colours

ROOT = Path(__file__).parents[2]
FOLDER = ROOT / "studio"
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
LARGEST = 300_000
"""Bytes of the page as servers send it, compressed, without the engine."""

has_packages = pytest.mark.skipif(
    shutil.which("npm") is None or not (FOLDER / "node_modules").is_dir(),
    reason="studio/node_modules is not there: `make studio` installs it with npm",
)


def npm(*arguments: str, **environment: str) -> None:
    done = subprocess.run(
        ["npm", "run", "--silent", *arguments], cwd=FOLDER, capture_output=True, text=True, env=os.environ | environment
    )
    assert done.returncode == 0, done.stdout + done.stderr


@has_packages
def test_its_unit_tests_pass() -> None:
    npm("test:unit")


@has_packages
@pytest.mark.slow
@pytest.mark.skipif(CHROMIUM is None, reason="chromium is not there")
def test_it_works_in_a_browser() -> None:
    npm("build")
    npm("test:e2e", PYTHON=sys.executable, CHROMIUM=str(CHROMIUM))


@has_packages
def test_it_is_small() -> None:
    npm("build")
    parts = [FOLDER / "build" / name for name in ("index.html", "main.js", "main.css")]
    assert sum(len(gzip.compress(part.read_bytes())) for part in parts) <= LARGEST


@has_packages
def test_it_fetches_nothing_from_elsewhere() -> None:
    npm("build")
    page = (FOLDER / "build" / "index.html").read_text()
    assert "default-src 'none'" in page
    assert re.findall(r"""(?:src|href)="(?!data:,|main\.)[^"]*""", page) == []
    assert not re.search(r"url\(\s*['\"]?(?:https?:)?//", (FOLDER / "build" / "main.css").read_text())


def test_it_has_the_colours_of_diagrams() -> None:
    style = (FOLDER / "src" / "style" / "colours.css").read_text()
    dark = colours(Scheme.DARK)
    for ink, light in colours(Scheme.LIGHT).items():
        assert f"\n  --{ink.value}: light-dark({light}, {dark[ink]});" in style
