"""A test that leaves something behind fails."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from xml.etree import ElementTree

import pytest

ROOT = Path(__file__).parents[1]

TESTS = {
    "a process": 'import subprocess\n\ndef test_it():\n    subprocess.Popen(["sleep", "20"])\n',
    "an orphan": 'import subprocess\n\ndef test_it():\n    subprocess.run(["sh", "-c", "sleep 20 &"])\n',
    "a coroutine": "async def nothing():\n    pass\n\ndef test_it():\n    nothing()\n",
    "a thread that raises": "import threading\n\ndef test_it():\n    threading.Thread(target=lambda: 1 / 0).start()\n",
    "a thread that raises when the test is over": (
        "import threading\n\ndef test_it():\n    threading.Timer(0.2, lambda: 1 / 0).start()\n"
    ),
    "a thread that continues": (
        "import threading, time\n\n"
        "def test_it():\n"
        "    threading.Thread(target=time.sleep, args=(60,), daemon=True, name='sleeper').start()\n"
    ),
}
WORDS = {
    "a process": "processes were left behind: sleep 20",
    "an orphan": "processes were left behind: sleep 20",
    "a coroutine": "was never awaited",
    "a thread that raises": "ZeroDivisionError",
    "a thread that raises when the test is over": "ZeroDivisionError",
    "a thread that continues": "threads were left behind: sleeper",
}


@pytest.fixture(scope="module")
def complaints(tmp_path_factory: pytest.TempPathFactory) -> Mapping[str, str]:
    """The report of pytest for each of the tests, which run in one session."""
    folder = tmp_path_factory.mktemp("session")
    (folder / "conftest.py").write_text((ROOT / "tests/conftest.py").read_text())
    files = {f"test_{what.replace(' ', '_')}.py": what for what in TESTS}
    for file, what in files.items():
        (folder / file).write_text(TESTS[what])
    command = [sys.executable, "-m", "pytest", "-n", "0", "-c", str(ROOT / "pyproject.toml"), "--rootdir", str(folder)]
    done = subprocess.run(
        [*command, "--junitxml", "results.xml", *files],
        cwd=folder,
        env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1"},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 1, done.stdout
    found = dict.fromkeys(TESTS, "")
    for test in ElementTree.parse(folder / "results.xml").iter("testcase"):
        complaints = [complaint for kind in ("failure", "error") for complaint in test.iter(kind)]
        found[files[f"{test.attrib['classname']}.py"]] += "".join(complaint.text or "" for complaint in complaints)
    return found


@pytest.mark.parametrize("what", TESTS)
def test_it_fails(complaints: Mapping[str, str], what: str) -> None:
    assert WORDS[what] in complaints[what]


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
