"""Judges attempts at the tasks, or writes the tasks without their solutions.

``python -m tests.assistants.judge --export FOLDER`` writes for each task ``01.md``, the request, and ``01.csp``, the
program to start from. They are solved by changing the programs in place, with docs/language-in-brief.md at hand.
``python -m tests.assistants.judge FOLDER`` judges them and prints the score; the exit code is 0 if
all pass, 1 otherwise.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import NoReturn

from tests.assistants.checks import FailedCheckError, judge
from tests.assistants.tasks import Task, all_tasks
from tests.support.alarm import alarm_after

SECONDS = 120
"""For each attempt; a run whose time stands still would not end."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Returns the exit code."""
    parser = argparse.ArgumentParser(prog="python -m tests.assistants.judge", description=__doc__)
    parser.add_argument("folder", type=Path, help="attempts, as 01.csp, 02.csp, …")
    parser.add_argument("--export", action="store_true", help="write requests and programs to start from into FOLDER")
    options = parser.parse_args(arguments)
    if options.export:
        if options.folder.is_dir() and any(options.folder.iterdir()):
            print(f"{options.folder} is not empty: name a new folder, or delete what is in it", file=sys.stderr)
            return 2
        export(options.folder)
        return 0
    passed = 0
    tasks = all_tasks()
    for task in tasks:
        verdict = verdict_on(task, options.folder / f"{task.number}.csp")
        passed += verdict == "passed"
        print(f"{task.number} {task.title}: {verdict}", flush=True)
    print(f"{passed} of {len(tasks)} passed")
    return int(passed < len(tasks))


def export(folder: Path) -> None:
    """Write what a reader gets: no checks and no solutions."""
    folder.mkdir(parents=True, exist_ok=True)
    for task in all_tasks():
        (folder / f"{task.number}.md").write_text(f"# {task.title}\n\n{task.request}\n", encoding="utf-8")
        (folder / f"{task.number}.csp").write_text(task.start, encoding="utf-8")


def verdict_on(task: Task, path: Path) -> str:
    """``passed``, or why not."""
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as problem:
        return f"not attempted ({problem})"

    def ring() -> NoReturn:
        raise FailedCheckError("in time", f"it was not judged after {SECONDS} s")

    try:
        with alarm_after(SECONDS, ring):
            failure = judge(task, text)
    except FailedCheckError as late:
        failure = late
    return "passed" if failure is None else f"failed `{failure.check}`: {failure.reason}"


if __name__ == "__main__":
    sys.exit(main())
