"""The example programs that ship with cspdiag: the folders of ``models/``."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from cspdiag.base.errors import CspdiagError
from cspdiag.base.files.resources import example_folder

_IMPORT_OF_EXAMPLE = re.compile(r'^import\s+"\.\./([^/"]+)/', re.MULTILINE)
_PICTURE_ELSEWHERE = re.compile(r"^!\[[^\]]*\]\(\.\./.*\)\n\n?", re.MULTILINE)


class UnknownExampleError(CspdiagError):
    """There is no example of that name; the message says which there are."""


def summaries() -> dict[str, str]:
    """The first sentence of the page of each example, by its name."""
    return {folder.name: _first_sentence(folder / "README.md") for folder in _folders()}


def files_of(example: str) -> dict[str, bytes]:
    """The files of an example by path, below its name; with those of the examples whose programs it imports.

    Pictures of its page that are elsewhere in the repository are left out. Raises UnknownExampleError.
    """
    folders = {folder.name: folder for folder in _folders()}
    if example not in folders:
        from cspdiag.base.spelling import Speller

        near = Speller().nearest(example, folders)
        help_ = f"did you mean {near}?" if near else f"there are: {', '.join(folders)}"
        raise UnknownExampleError(f"there is no example {example!r} ({help_})")
    found: dict[str, bytes] = {}
    pending = [example]
    while pending:
        name = pending.pop()
        for path in sorted(folders[name].iterdir()):
            if not path.is_file() or f"{name}/{path.name}" in found:
                continue
            content = path.read_bytes()
            if path.suffix == ".csp":
                pending.extend(_IMPORT_OF_EXAMPLE.findall(content.decode()))
            elif path.name == "README.md":
                content = _PICTURE_ELSEWHERE.sub("", content.decode()).encode()
            found[f"{name}/{path.name}"] = content
    return found


def main_program(example: str) -> str:
    """The name of the file of an example that is run."""
    names = [path.name for folder in _folders() if folder.name == example for path in folder.glob("*.csp")]
    return f"{example}.csp" if f"{example}.csp" in names else min(names)


def _folders() -> Iterator[Path]:
    folders = (path for path in example_folder().iterdir() if (path / "README.md").is_file())
    yield from sorted(folders, key=lambda path: path.name)


def _first_sentence(page: Path) -> str:
    text = page.read_text(encoding="utf-8").partition("\n\n")[2].partition("\n\n")[0]
    plain = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", " ".join(text.split()))
    return re.split(r"(?<=[.:]) ", plain, maxsplit=1)[0].rstrip(":.")
