"""Go, if it is installed: built once in a temporary folder."""

from __future__ import annotations

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from timing import requested_benchmark

compiler = shutil.which("go")
if compiler is None:
    sys.exit(0)
with tempfile.TemporaryDirectory() as folder:
    program = Path(folder) / "peer"
    source = Path(__file__).with_name("peer.go")
    subprocess.run([compiler, "build", "-o", str(program), str(source)], check=True)
    sys.exit(subprocess.run([program, requested_benchmark()], check=False).returncode)
