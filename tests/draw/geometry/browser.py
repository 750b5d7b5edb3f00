"""Shows pages in headless Chromium and reads the result."""

from __future__ import annotations

import html
import json
import re
import shutil
import subprocess
from pathlib import Path
from typing import Any

BROWSER = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")

_OPTIONS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-extensions",
    "--hide-scrollbars",
)


def chromium(folder: Path, *options: str, page: Path) -> str:
    """The output of Chromium for a local page, with a profile of its own in ``folder``."""
    assert BROWSER is not None
    command = [BROWSER, *_OPTIONS, f"--user-data-dir={folder / 'profile'}", *options, page.as_uri()]
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    return done.stdout


def answer(folder: Path, page: str) -> Any:
    """What the script of a page has written as JSON into the element ``answer``."""
    path = folder / "page.html"
    path.write_text(page)
    shown = chromium(folder, "--dump-dom", page=path)
    found = re.search(r'<pre id="answer">(.*?)</pre>', shown, re.DOTALL)
    assert found is not None, shown[-2000:]
    return json.loads(html.unescape(found[1]))
