"""FMUs that end the process in which they run."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from tests.simulate.native.fmu.test_import_faults import REFUSED, REFUSING, packed

pytest.importorskip("fmpy")

VALVE = """
class Valve:
    def write(self, port, value):
        with open("written", "a") as file:
            file.write(f"{value}\\n")
"""

FOLLOW = """
process Follow {
  in  y : double @ 10 ms
  out u : double @ 10 ms safe -7

  communication { var v : double }

  composition { mu (y ? v ; u ! v) }
}

submodel Plant fmu "ending.fmu" { out y : double }

driver Valve python "valve.py:Valve" { in u : double }

environment Bench for Follow {
  plant : Plant
  valve : Valve

  plant.y -> y
  u       -> valve.u
}
"""

NATIVE = REFUSED.replace("refusing", "ending")


def ended(folder: Path, how: str, *options: str) -> tuple[int, str]:
    """The exit code of a run with an FMU that does ``how`` in the step from 0.05 s, and what is said."""
    packed(folder, "ending", REFUSING.replace("refusing", "ending"), f"-DHOW={how}")
    (folder / "valve.py").write_text(VALVE)
    text = NATIVE if "c" in options else FOLLOW
    (folder / "follow.csp").write_text(text)
    command = [sys.executable, "-m", "cspdiag", "run", "follow.csp", "--for", "1 s", "--record", "kept.csv", *options]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    return done.returncode, done.stdout + done.stderr


@pytest.mark.parametrize("options", [["-O0"], ["-O1"], ["--target", "c"]], ids=" ".join)
def test_one_that_calls_exit_is_not_a_success(options: list[str], tmp_path: Path) -> None:
    code, said = ended(tmp_path, "exit(0)", *options)
    assert code == 1
    if options == ["--target", "c"]:
        assert "exit code 0 before the end of the run, as if a body in C or an FMU had called exit" in said
    else:
        assert "ending.fmu has called exit, which ends the process, in the step from 0.05 s to 0.06 s" in said
        assert (tmp_path / "written").read_text().splitlines()[-1] == "-7.0"
    assert (tmp_path / "kept.part.csv").exists()


@pytest.mark.parametrize(("how", "signal"), [("abort()", "SIGABRT"), ("*(volatile int *)0 = 1", "SIGSEGV")])
def test_one_that_crashes_is_named(how: str, signal: str, tmp_path: Path) -> None:
    code, said = ended(tmp_path, how)
    assert code not in (0, 2)
    assert f"ending.fmu has crashed ({signal}), in the step from 0.05 s to 0.06 s" in said
    assert "Traceback" not in said
    assert (tmp_path / "written").read_text().splitlines()[-1] == "-7.0"


@pytest.mark.parametrize(("how", "signal"), [("abort()", "SIGABRT"), ("*(volatile int *)0 = 1", "SIGSEGV")])
def test_a_native_run_that_crashes_may_have_an_fmu_that_does(how: str, signal: str, tmp_path: Path) -> None:
    code, said = ended(tmp_path, how, "--target", "c")
    assert code not in (0, 2)
    assert f"ended by {signal}, a crash such as that of a body in C or an FMU" in said
