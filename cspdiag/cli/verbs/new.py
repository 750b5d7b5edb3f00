"""``cspdiag new``: start a project."""

from __future__ import annotations

import keyword
import os
import re
import sys
from argparse import ArgumentParser, Namespace

from cspdiag.base.files.resources import template_folder
from cspdiag.base.render.snippet import on_one_line
from cspdiag.cli.support.failure import FINE, UsageError
from cspdiag.cli.support.files.output import write_new_folder
from cspdiag.cli.support.terminal import say

EXAMPLE = "cspdiag new gimbal && cd gimbal && cspdiag run gimbal.csp --for 3s"

_FILES = {
    "controller.csp": "FILE_NAME.csp",
    "test_controller.py.txt": "tests/test_FILE_NAME.py",
    "README.md": "README.md",
    "check.yml": ".github/workflows/check.yml",
    "gitignore.txt": ".gitignore",
}
"""The templates in ``templates/project`` and where they go."""


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("name", metavar="NAME", help="name of the project and of its folder")


def run(arguments: Namespace) -> int:
    """Write the project into a new folder of its name."""
    folder = arguments.name.rstrip(os.sep)
    write_new_folder(folder, project(os.path.basename(folder)))
    say(f"wrote {on_one_line(folder)}: a controller, its environment, a test; README.md explains the next steps")
    return FINE


def project(name: str) -> dict[str, str]:
    """The files of a new project by path. Raises UsageError for a name that cannot become a package."""
    if keyword.iskeyword(name) or name.lower() in sys.stdlib_module_names:
        kind = "keyword of Python" if keyword.iskeyword(name) else "module of Python's library"
        raise UsageError(f"{name!r} cannot name a project: it is a {kind}, and the generated package has its name")
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_-]*", name):
        raise UsageError(f"{name!r} cannot name a project (letters, digits, - and _, beginning with a letter)")
    file_name = name.replace("-", "_").lower()
    words = (word for word in re.split(r"[-_]+", name) if word)
    process_name = "".join(f"{word[0].upper()}{word[1:]}" for word in words) + "Control"

    def filled(text: str) -> str:
        text = text.replace("FILE_NAME", file_name).replace("PROCESS_NAME", process_name)
        return text.replace("PROJECT_NAME", name)

    folder = template_folder("project")
    return {filled(path): filled((folder / template).read_text(encoding="utf-8")) for template, path in _FILES.items()}
