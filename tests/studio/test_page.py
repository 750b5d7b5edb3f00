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
has_page = pytest.mark.skipif(
    shutil.which("npm") is None or not (FOLDER / "build" / "index.html").exists(),
    reason="the page is not built: `make studio` builds it with npm",
)
has_browser = pytest.mark.skipif(CHROMIUM is None, reason="chromium is not there")


def run(*command: str) -> None:
    environment = {**os.environ, "PYTHON": sys.executable, "CHROMIUM": str(CHROMIUM)}
    done = subprocess.run(command, cwd=FOLDER, capture_output=True, text=True, env=environment)
    assert done.returncode == 0, done.stdout + done.stderr


@has_packages
def test_its_unit_tests_pass() -> None:
    run("npm", "run", "--silent", "test:unit")


@has_page
@has_browser
@pytest.mark.slow
@pytest.mark.parametrize("part", ["page", "server", "playground", "engine"])
def test_it_works_in_a_browser(part: str) -> None:
    if part == "engine" and "WITH_ALL_MODELS" not in os.environ:
        pytest.skip("the tour through all models takes minutes: `make test-studio`")
    if part == "playground" and not (FOLDER / "build" / "engine" / "cspdiag.zip").exists():
        pytest.skip("the engine for browsers is not built: `make playground`")
    run("node", "--test", "--test-timeout=300000", f"test/e2e/{part}.test.mjs")


@has_page
def test_it_is_small() -> None:
    parts = [FOLDER / "build" / name for name in ("index.html", "main.js", "main.css")]
    assert sum(len(gzip.compress(part.read_bytes())) for part in parts) <= LARGEST


@has_page
def test_it_fetches_nothing_from_elsewhere() -> None:
    page = (FOLDER / "build" / "index.html").read_text()
    assert "default-src 'none'" in page
    assert re.findall(r"""(?:src|href)="(?!data:,|main\.)[^"]*""", page) == []
    assert not re.search(r"url\(\s*['\"]?(?:https?:)?//", (FOLDER / "build" / "main.css").read_text())


def test_it_has_the_colours_of_diagrams() -> None:
    style = (FOLDER / "src" / "style" / "colours.css").read_text()
    dark = colours(Scheme.DARK)
    for ink, light in colours(Scheme.LIGHT).items():
        assert f"\n  --{ink.value}: light-dark({light}, {dark[ink]});" in style
