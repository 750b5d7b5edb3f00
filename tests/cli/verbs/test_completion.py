"""Completion of command lines: what a shell is offered at the end of a line."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from tests.cli.conftest import Command

pytest.importorskip("argcomplete", reason="needs argcomplete: pip install 'cspdiag[completion]'")

ROOT = Path(__file__).parents[3]


def offered(line: str, tmp_path: Path, folder: Path = ROOT) -> list[str]:
    answer = tmp_path / "answer"
    answer.touch()
    environment = {
        **os.environ,
        "_ARGCOMPLETE": "1",
        "_ARGCOMPLETE_IFS": "\n",
        "_ARGCOMPLETE_SHELL": "bash",
        "_ARGCOMPLETE_SUPPRESS_SPACE": "1",
        "_ARGCOMPLETE_STDOUT_FILENAME": str(answer),
        "COMP_LINE": line,
        "COMP_POINT": str(len(line.encode())),
        "COMP_TYPE": "9",
        "PYTHONPATH": str(ROOT),
    }
    done = subprocess.run(
        [sys.executable, "-m", "cspdiag"], env=environment, cwd=folder, capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    return answer.read_text().split("\n")


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("cspdiag mar", ["margins"]),
        ("cspdiag run --env", ["--environment"]),
        ("cspdiag run models/jiwy/pl", ["models/jiwy/plant.csp"]),
        ("cspdiag run models/jiwy/jiwy.csp --environment W", ["Worn"]),
        ("cspdiag draw models/jiwy/jiwy.csp --process Joint", ["JointControl"]),
        ("cspdiag compile models/dining/dining.csp --target p", ["python", "promela"]),
        ("cspdiag run models/jiwy/jiwy.csp --set Ts", ["Tsh=", "Tsv="]),
        ("cspdiag run models/jiwy/jiwy.csp --set pan.in", ["pan.inertia="]),
        ("cspdiag check --format s", ["sarif"]),
        ("cspdiag explain E0523", ["E0523"]),
        ("cspdiag devices u", ["udp"]),
        ("cspdiag examples jiwy_", ["jiwy_mujoco"]),
        ("cspdiag new mine --from jiwy_", ["jiwy_mujoco"]),
        ("cspdiag diff --from HEA", ["HEAD"]),
        ("cspdiag run missing.csp --environment ", [""]),
    ],
)
def test_a_line_is_completed(line: str, expected: list[str], tmp_path: Path) -> None:
    assert sorted(offered(line, tmp_path)) == sorted(expected)


def test_names_come_from_a_program_with_errors_in_a_folder_with_spaces(tmp_path: Path) -> None:
    folder = tmp_path / "a b"
    folder.mkdir()
    text = "process P { in x : int  composition { y } }\nenvironment Rig for P { 1 -> x }\nprocess {"
    (folder / "half typed.csp").write_text(text)
    assert offered("cspdiag compile 'half typed.csp' --top ", tmp_path, folder) == ["P"]


def test_bash_completes_with_the_printed_script(cspdiag: Command, tmp_path: Path) -> None:
    if shutil.which("bash") is None:
        pytest.skip("no bash")
    printed = cspdiag("completion", "bash")
    assert printed.code == 0
    command = tmp_path / "cspdiag"
    command.write_text(f'#!/bin/sh\nPYTHONPATH="{ROOT}" exec "{sys.executable}" -m cspdiag "$@"\n')
    command.chmod(0o755)
    script = tmp_path / "try.bash"
    script.write_text(
        f"{printed.out}\n"
        'COMP_LINE="cspdiag run models/jiwy/jiwy.csp --environment Be" COMP_TYPE=9\n'
        "COMP_POINT=${#COMP_LINE} COMP_WORDS=($COMP_LINE) COMP_CWORD=4\n"
        '_python_argcomplete cspdiag\nprintf "%s\\n" "${COMPREPLY[@]}"\n'
    )
    environment = {**os.environ, "PATH": f"{tmp_path}:{os.environ['PATH']}"}
    done = subprocess.run(["bash", script], env=environment, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.stdout.split() == ["Bench"], done.stderr


@pytest.mark.parametrize("shell", ["zsh", "fish"])
def test_there_is_a_script_for_each_shell(cspdiag: Command, shell: str) -> None:
    printed = cspdiag("completion", shell)
    assert printed.code == 0
    assert "_ARGCOMPLETE" in printed.out


def test_an_unknown_shell_is_refused(cspdiag: Command) -> None:
    result = cspdiag("completion", "tcsh")
    assert result.code == 2
    assert "tcsh" in result.err
