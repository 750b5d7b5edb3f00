"""What a test leaves behind fails it."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]

TESTS = {
    "a process": 'import subprocess\n\ndef test_it():\n    subprocess.Popen(["sleep", "20"])\n',
    "an orphan": 'import subprocess\n\ndef test_it():\n    subprocess.run(["sh", "-c", "sleep 20 &"])\n',
    "a coroutine": "async def nothing():\n    pass\n\ndef test_it():\n    nothing()\n",
    "a thread": "import threading\n\ndef test_it():\n    threading.Thread(target=lambda: 1 / 0).start()\n",
}
WORDS = {
    "a process": "processes were left behind: sleep 20",
    "an orphan": "processes were left behind: sleep 20",
    "a coroutine": "was never awaited",
    "a thread": "ZeroDivisionError",
}


@pytest.mark.parametrize("what", TESTS)
def test_it_fails(what: str, tmp_path: Path) -> None:
    (tmp_path / "conftest.py").write_text((ROOT / "tests/conftest.py").read_text())
    (tmp_path / "test_it.py").write_text(TESTS[what])
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-n", "0", "-c", str(ROOT / "pyproject.toml"), "--rootdir", str(tmp_path), "test_it.py"],
        cwd=tmp_path,
        env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1"},
        capture_output=True,
        text=True,
    )  # fmt: skip
    assert done.returncode == 1, done.stdout
    assert WORDS[what] in done.stdout + done.stderr


def test_a_session_that_was_started_to_ignore_ctrl_c_takes_it_back(tmp_path: Path) -> None:
    (tmp_path / "conftest.py").write_text((ROOT / "tests/conftest.py").read_text())
    (tmp_path / "test_it.py").write_text(
        "import signal, subprocess, sys\n\n"
        "def test_it():\n"
        '    code = "import os, signal; os.kill(os.getpid(), signal.SIGINT)"\n'
        '    assert subprocess.run([sys.executable, "-c", code], capture_output=True).returncode == -signal.SIGINT\n'
    )
    done = subprocess.run(
        [sys.executable, "-m", "pytest", "-n", "0", "-c", str(ROOT / "pyproject.toml"), "--rootdir", ".", "test_it.py"],
        cwd=tmp_path,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_IGN),
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout
