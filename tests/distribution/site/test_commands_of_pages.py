"""Every command of the README and of the documentation is run, as its reader would, and prints what is shown: those
that take long only if THOROUGH is in the environment. Those of the lectures and models are run when the site is built.
"""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest

from distribution.site.contents import RUN
from distribution.site.shell import Shell
from tests.distribution.site.commands import Command, Saved, differences, steps

ROOT = Path(__file__).parents[3]
PAGES = [ROOT / "README.md", *sorted(page for page in (ROOT / "docs").rglob("*.md") if page.name != "diagnostics.md")]

STAND_INS = {
    "buffer.csp": "models/buffer/buffer.csp",
    "controller.csp": "models/watchdog/watchdog.csp",
    "old.csp": "models/watchdog/watchdog.csp",
    "new.csp": "models/watchdog/watchdog.csp",
    "x.csp": "models/watchdog/watchdog.csp",
}
"""Programs that pages name without showing them."""

NOT_RUN = (
    "cspdiag bench",  # Takes minutes, and needs what it compares with: `make bench`.
    "cspdiag studio",  # Serves until it is stopped: tests/studio/server.
    "cspdiag run models/jiwy/jiwy.csp --real-time --serve",  # Serves until it is stopped: tests/simulate/record.
    "cspdiag check --server-status",  # Depends on whether the server has started by then: tests/cli/server.
    "cspdiag run models/jiwy/jiwy.csp --environment Gamepad",  # Needs a gamepad: tests/devices.
    "cspdiag run twice.csp --real-time",  # Waits for a device: tests/docs/test_devices_page.py.
    "cspdiag run heater.csp --target c --real-time",  # Runs until it is stopped: tests/docs/test_docs.py.
    "cspdiag run heater.csp --real-time --tune",  # Reads until it is stopped: tests/runtime/kernel/test_tuning.py.
    "cspdiag run pair.csp --place",  # Needs a second host: tests/docs/test_hosts_page.py.
    "cspdiag run model.csp --environment Modelled",  # Needs an FMU of pythonfmu: tests/docs/test_tutorial.py.
    "cspdiag verify --timing jiwy.csp --wcet-from times.json",  # Needs times of a microcontroller: tests/cli/verbs.
    "cspdiag sweep ...",  # Is the command above it.
    "cspdiag sweep models/jiwy/jiwy.csp --set panGains.kp=1:4:1000",  # Needs a cluster: tests/sweep.
    "git clone",  # Needs a network.
)
"""How commands begin that are not run."""
FINDS = (
    "cspdiag margins models/jiwy/jiwy.csp --loop motionControl --set Tsh=10ms",
    "cspdiag run models/dining/deadlock.csp --draw-deadlock",
    "cspdiag verify crossing.csp",
    "cspdiag verify models/dining/deadlock.csp",
    "cspdiag verify models/jiwy/stolen_button.csp",
)
"""How commands begin that end with exit code 1, as what they are shown for is wrong."""
KEEPS_PACE = "cspdiag run models/jiwy/jiwy.csp --real-time --target c --trace"
"""How a command begins that ends with exit code 1 if samples are missed, as on a machine that is busy with tests."""
QUICK = (
    "cspdiag check",
    "cspdiag diff",
    "cspdiag e",
    "cspdiag fmt",
    "cspdiag lsp",
    "cspdiag mcp",
    "cspdiag new",
    "cspdiag verify",
    "git ",
)
"""How commands begin that the suite runs; `make hunt` runs all of them, which takes minutes."""
THOROUGH = "THOROUGH" in os.environ


def name_of(page: Path) -> str:
    return page.relative_to(ROOT).as_posix()


def runs(page: Path) -> bool:
    return not name_of(page).startswith(RUN) and any(
        isinstance(step, Command) for step in steps(page.read_text(encoding="utf-8"))
    )


def is_run(line: str) -> bool:
    # What is measured in a slow run is not there without it.
    is_quick = line.startswith(QUICK) and "--wcet-from" not in line
    return not line.startswith(NOT_RUN) and (THOROUGH or is_quick)


@pytest.fixture
def reader(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Shell:
    """A folder as pages take for granted: the models, programs, and a past of them in git."""
    for variable in ("GIT_AUTHOR_NAME", "GIT_AUTHOR_EMAIL", "GIT_COMMITTER_NAME", "GIT_COMMITTER_EMAIL"):
        monkeypatch.setenv(variable, "reader")
    shell = Shell(tmp_path / "reader")
    for name, model in STAND_INS.items():
        shutil.copyfile(ROOT / model, shell.folder / name)
    return shell


@pytest.mark.slow
@pytest.mark.parametrize("page", [page for page in PAGES if runs(page)], ids=name_of)
def test_commands_print_what_is_shown(page: Path, reader: Shell) -> None:
    taken = list(steps(page.read_text(encoding="utf-8")))
    for step in reversed(taken):  # Some commands stand before the program that they are for.
        if isinstance(step, Saved):
            reader.write(Path(step.name).name, step.text)
    if any(isinstance(step, Command) and step.line.startswith("cspdiag diff") for step in taken):
        with_history(reader)
    wrong = []
    for step in taken:
        if isinstance(step, Saved):
            reader.write(Path(step.name).name, step.text)
        elif is_run(step.line):
            code, printed = reader.execute(step.line)
            may_be_1 = step.line.startswith(("cspdiag diff", KEEPS_PACE)) and code == 1
            if code != step.line.startswith(FINDS) and not may_be_1:
                wrong.append(f"`{step.line}` ended with exit code {code}:\n{printed}")
            elif step.shown:
                wrong += [f"`{step.line}`: {line}" for line in differences(step.shown, printed)]
    reader.execute("cspdiag check --server-stop")  # One that a command has started would stay for ten minutes.
    assert wrong == []


def test_what_is_not_run_is_on_a_page() -> None:
    lines = [step.line for page in PAGES for step in steps(page.read_text("utf-8")) if isinstance(step, Command)]
    assert [
        begins for begins in (*NOT_RUN, *FINDS, KEEPS_PACE) if not any(line.startswith(begins) for line in lines)
    ] == []


def test_what_a_page_shows_of_a_command_is_compared() -> None:
    page = "Do\n\n    cspdiag check a.csp   # now\n\n```text\none\n...\nfour\n```\n\n"
    page += "```text\n$ cspdiag fmt b.csp\nfive\n```\n"
    first, second = (step for step in steps(page) if isinstance(step, Command))
    assert (first.line, first.shown) == ("cspdiag check a.csp", ["one", "...", "four"])
    assert (second.line, second.shown) == ("cspdiag fmt b.csp", ["five"])
    assert differences(first.shown, "one\ntwo\nthree\nfour\n") == []
    assert differences(first.shown, "one\ntwo\nfour\nfive\n") == ["not shown: five"]
    assert differences(first.shown, "zero\nfour\n") == ["one"]


def with_history(shell: Shell) -> None:
    """Makes the folder a repository: a tag v1.0, the branch main, and three commits after it in another branch."""
    program = shell.folder / "controller.csp"
    text = program.read_text(encoding="utf-8")
    git = ["git", "-C", str(shell.folder)]
    subprocess.run([*git, "init", "--quiet", "--initial-branch", "main"], check=True)
    for change in range(4):
        program.write_text(text.replace("550 ms", f"{551 + change} ms"), encoding="utf-8")
        subprocess.run([*git, "add", "."], check=True)
        subprocess.run([*git, "commit", "--quiet", "--message", f"Change {change}"], check=True)
        if change == 0:
            subprocess.run([*git, "tag", "v1.0"], check=True)
            subprocess.run([*git, "checkout", "--quiet", "-b", "work"], check=True)
