"""How much longer a check takes than a bare interpreter, each in a new process, with compiled bytecode."""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path
from statistics import median

from timing import report

MODEL = str(Path(__file__).parents[2] / "models/jiwy/jiwy.csp")


def milliseconds(*arguments: str) -> float:
    began = time.perf_counter()
    subprocess.run([sys.executable, *arguments], check=True, capture_output=True)
    return (time.perf_counter() - began) * 1e3


milliseconds("-m", "cspdiag", "check", MODEL)
report(median(milliseconds("-m", "cspdiag", "check", MODEL) for _ in range(5)))
