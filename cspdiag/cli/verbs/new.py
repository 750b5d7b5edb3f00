"""``cspdiag new``: start a project."""

from __future__ import annotations

import keyword
import os
import re
import sys
from argparse import ArgumentParser, Namespace

from cspdiag.base.files.examples import main_program
from cspdiag.base.files.resources import template_folder
from cspdiag.base.render.snippet import on_one_line
from cspdiag.cli.support.failure import FINE, UsageError
from cspdiag.cli.support.files.examples import files_of
from cspdiag.cli.support.files.output import write_new_folder
from cspdiag.cli.support.terminal import say

EXAMPLE = "cspdiag new gimbal && cd gimbal && cspdiag run gimbal.csp --for 3s\ncspdiag new gimbal --from jiwy"

_FILES = {
    "controller.csp": "FILE_NAME.csp",
    "test_controller.py.txt": "tests/test_FILE_NAME.py",
    "README.md": "README.md",
    "check.yml": ".github/workflows/check.yml",
    "gitignore.txt": ".gitignore",
}
"""The templates in ``templates/project`` and where they go."""

_FILES_FROM_EXAMPLE = {
    "test_from_example.py.txt": "tests/test_FILE_NAME.py",
    "README_from_example.md": "README.md",
    "check.yml": ".github/workflows/check.yml",
    "gitignore.txt": ".gitignore",
}
"""Those for a project that begins with the files of an example."""


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("name", metavar="NAME", help="name of the project and of its folder")
    parser.add_argument(
        "--from", dest="example", metavar="EXAMPLE", help="begin with the files of an example (cspdiag examples)"
    )


def run(arguments: Namespace) -> int:
    """Write the project into a new folder of its name."""
    folder = arguments.name.rstrip(os.sep)
    name = os.path.basename(folder)
    if arguments.example is not None:
        write_new_folder(folder, project_from(arguments.example, name))
        say(f"wrote {on_one_line(folder)}: the example {arguments.example}, a test; README.md explains the next steps")
        return FINE
    write_new_folder(folder, project(name))
    say(f"wrote {on_one_line(folder)}: a controller, its environment, a test; README.md explains the next steps")
    return FINE


def project_from(example: str, name: str) -> dict[str, str | bytes]:
    """The files of a new project that begins with those of an example. Raises UsageError for a name that cannot become
    a package, for an unknown example, and for one that consists of several folders.
    """
    _require_name(name)
    found = files_of(example)
    others = {path.partition("/")[0] for path in found} - {example}
    if others:
        raise UsageError(
            f"the example {example!r} imports {', '.join(sorted(others))}, which is a folder of its own: "
            f"copy both with cspdiag examples {example}"
        )
    stem = main_program(example).removesuffix(".csp")
    files: dict[str, str | bytes] = {path.partition("/")[2]: content for path, content in found.items()}
    files["EXAMPLE.md"] = files.pop("README.md")
    words = {"FILE_NAME": stem, "EXAMPLE_NAME": example, "PROJECT_NAME": name}
    return {**files, **_filled(_FILES_FROM_EXAMPLE, words)}


def project(name: str) -> dict[str, str]:
    """The files of a new project by path. Raises UsageError for a name that cannot become a package."""
    _require_name(name)
    words = (word for word in re.split(r"[-_]+", name) if word)
    process_name = "".join(f"{word[0].upper()}{word[1:]}" for word in words) + "Control"
    file_name = name.replace("-", "_").lower()
    return _filled(_FILES, {"FILE_NAME": file_name, "PROCESS_NAME": process_name, "PROJECT_NAME": name})


def _require_name(name: str) -> None:
    """Raise UsageError for a name that cannot become a package."""
    if keyword.iskeyword(name) or name.lower() in sys.stdlib_module_names:
        kind = "keyword of Python" if keyword.iskeyword(name) else "module of Python's library"
        raise UsageError(f"{name!r} cannot name a project: it is a {kind}, and the generated package has its name")
    if not re.fullmatch(r"[A-Za-z][A-Za-z0-9_-]*", name):
        raise UsageError(f"{name!r} cannot name a project (letters, digits, - and _, beginning with a letter)")


def _filled(templates: dict[str, str], words: dict[str, str]) -> dict[str, str]:
    """The texts of templates by their paths, with words replaced in both."""

    def filled(text: str) -> str:
        for word, value in words.items():
            text = text.replace(word, value)
        return text

    folder = template_folder("project")
    return {filled(path): filled((folder / name).read_text(encoding="utf-8")) for name, path in templates.items()}
