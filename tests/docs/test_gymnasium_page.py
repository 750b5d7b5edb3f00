"""The page about policies: its example runs and prints what it says."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "gymnasium.md").read_text(encoding="utf-8")


def test_the_example_runs_and_prints_what_the_page_says() -> None:
    pytest.importorskip("gymnasium", reason="needs gymnasium: pip install 'cspdiag[gym]'")
    script, printed = (
        re.findall(rf"^```{kind}\n(.*?)^```$", PAGE, re.MULTILINE | re.DOTALL)[0] for kind in ("python", "text")
    )
    done = subprocess.run([sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout == printed
