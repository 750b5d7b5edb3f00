"""How long a check of JIWY takes, each in a new process, with compiled bytecode.

With ``server`` a resident server carries it out; with ``changed`` the main file changes before each check.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import time
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory

from timing import report

MODEL = Path(__file__).parents[2] / "models/jiwy"
MAIN = "jiwy.csp"
CHECK = (sys.executable, "-m", "cspdiag", "check")
TIMES = 5


# Without it the first check would leave no bytecode, and each later one would compile all modules again.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)


def milliseconds(*arguments: str) -> float:
    began = time.perf_counter()
    subprocess.run([*CHECK, *arguments], check=True, capture_output=True)
    return (time.perf_counter() - began) * 1e3


def cold() -> None:
    milliseconds(str(MODEL / MAIN))
    report(median(milliseconds(str(MODEL / MAIN)) for _ in range(TIMES)))


def with_server(folder: Path, *, changes: bool) -> None:
    """With a server of its own, which is given time to learn after each command."""
    os.environ["XDG_RUNTIME_DIR"] = str(folder)
    for file in MODEL.glob("*.csp"):
        shutil.copy(file, folder)
    main = folder / MAIN
    samples = []
    try:
        milliseconds("--server", str(main))
        while subprocess.run([*CHECK, "--server-status"], capture_output=True, check=False).returncode:
            time.sleep(0.1)
        for number in range(TIMES + 1):
            if changes:
                main.write_text(f"{main.read_text()}\n// {number}\n")
            samples.append(milliseconds("--server", str(main)))
            time.sleep(0.5)
    finally:
        milliseconds("--server-stop")
    report(median(samples[1:]))


if "server" in sys.argv:
    if not hasattr(os, "O_PATH"):
        sys.exit(0)
    with TemporaryDirectory() as temporary:
        with_server(Path(temporary), changes="changed" in sys.argv)
else:
    cold()
