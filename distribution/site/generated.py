"""Pages that are written by nobody: those of the diagnostics, of the commands, and of the Python interface."""

from __future__ import annotations

import inspect
import io
import os
import tempfile
from collections.abc import Callable, Iterator
from contextlib import chdir, redirect_stderr, redirect_stdout
from pathlib import Path
from unittest.mock import patch

import cspdiag
from cspdiag.base.manual import FAMILIES, ManualPage, manual_pages
from cspdiag.cli.main import VERBS, main, verb_parser
from distribution.site.markdown import Page, fenced, play_link

DIAGNOSTICS = "reference/diagnostics"
_ATTEMPTS = (("check",), ("check", "--real", "float32"), ("verify",))
"""The commands that find what is wrong: most at once, some only in single precision, some by a proof."""


def diagnostics(page_at: Callable[[str], Page], linked: Callable[[Page, str], str]) -> Iterator[tuple[Page, str]]:
    """The index of all diagnostics, a page for each family, and a page for each of them."""
    pages = manual_pages()
    family = {
        title: [page for code, page in pages.items() if code[1:3] == name[:2]] for name, title in FAMILIES.items()
    }
    names = {title: name[3:] for name, title in FAMILIES.items()}
    rows = "\n".join(names.values())
    lists = "\n\n".join(
        f"## {title}\n\n" + "\n".join(f"- [{each.code}]({each.code}.md): {each.title}" for each in members)
        for title, members in family.items()
    )
    yield (
        page_at(f"{DIAGNOSTICS}/index"),
        f"# Diagnostics\n\nEvery mistake that cspdiag finds has a code and a page: what it means, why the program is "
        f"refused, a program with that mistake, what the compiler says about it, and the corrected program. "
        f"`cspdiag explain CODE` shows the page at the terminal.\n\n"
        f"Where only one correction can be meant, `cspdiag check --fix` applies it.\n\n"
        f"```{{toctree}}\n:hidden:\n{rows}\n```\n\n{lists}\n",
    )
    for title, members in family.items():
        listed = "\n".join(f"- [{each.code}]({each.code}.md): {each.title}. {each.meaning}" for each in members)
        tree = "\n".join(each.code for each in members)
        yield (
            page_at(f"{DIAGNOSTICS}/{names[title]}"),
            f"# {title}\n\n{listed}\n\n```{{toctree}}\n:hidden:\n{tree}\n```\n",
        )
    for manual in pages.values():
        page = page_at(f"{DIAGNOSTICS}/{manual.code}")
        yield page, _diagnostic(page, manual, linked)


def _diagnostic(page: Page, manual: ManualPage, linked: Callable[[Page, str], str]) -> str:
    refused, fixed = ({"program.csp": text} for text in (manual.refused, manual.fixed))
    command, printed = said_about(manual.refused)
    return "\n".join(
        (
            f"# {manual.code}: {manual.title}\n\n{linked(page, manual.meaning)}\n\n{linked(page, manual.reason)}\n",
            f"## {manual.refused_heading}\n\n{fenced(manual.refused, 'csp')}{play_link(page, refused, 'program.csp')}",
            f"## What the compiler says\n\n{fenced(f'$ {command}{chr(10)}{printed}', 'text')}",
            f"## Fixed\n\n{fenced(manual.fixed, 'csp')}{play_link(page, fixed, 'program.csp')}",
        )
    )


def said_about(program: str) -> tuple[str, str]:
    """The command that finds what is wrong with a program, and what it prints."""
    with tempfile.TemporaryDirectory() as folder, chdir(folder):
        Path("program.csp").write_text(program, encoding="utf-8")
        for attempt in _ATTEMPTS:
            command = [*attempt, "program.csp"]
            printed = io.StringIO()
            with redirect_stdout(printed), redirect_stderr(printed):
                main(command)
            if any(f"{severity}[" in printed.getvalue() for severity in ("error", "warning")):
                break
    return f"cspdiag {' '.join(command)}", printed.getvalue()


def commands() -> str:
    """The page with the options of every verb."""
    parts = ["# Commands\n\nWhat `cspdiag VERB --help` shows. Exit code 0 says that all is well, 1 that something was "
             "found, 2 that the command line was wrong.\n"]  # fmt: skip
    with patch.dict(os.environ, {"COLUMNS": "100"}):
        for verb, summary in VERBS.items():
            text = verb_parser(verb).format_help()
            parts.append(f"## {verb}\n\n{summary[0].upper()}{summary[1:]}.\n\n{fenced(text, 'text')}")
    return "\n".join(parts)


def python_api() -> str:
    """The page with every public name of the package."""
    functions, classes, exceptions = [], [], []
    for name in cspdiag.__all__:
        given = getattr(cspdiag, name)
        if inspect.isfunction(given):
            functions.append(f".. autofunction:: cspdiag.{name}\n")
        elif inspect.isclass(given) and issubclass(given, BaseException):
            exceptions.append(f".. autoexception:: cspdiag.{name}\n   :show-inheritance:\n")
        elif inspect.isclass(given):
            classes.append(f".. autoclass:: cspdiag.{name}()\n   :members:\n   :inherited-members: object, tuple\n")
    sections = (("Functions", functions), ("Classes", classes), ("Exceptions", exceptions))
    return (
        "# Python API\n\nEvery public name of `import cspdiag`, from the docstrings. "
        "[From Python](../guides/python.md) shows them in use.\n\n"
        + "\n".join(
            f"## {title}\n\n```{{eval-rst}}\n{chr(10).join(entries)}```\n" for title, entries in sections if entries
        )
    )
