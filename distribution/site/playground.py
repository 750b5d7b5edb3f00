"""Links that open a program in the playground."""

from __future__ import annotations

import base64
import json
import os
import re
import zlib
from collections.abc import Mapping
from pathlib import Path

_IMPORT = re.compile(r'^\s*import\s+"([^"]+)"', re.MULTILINE)


def fragment(files: Mapping[str, str], main: str) -> str:
    """The fragment of a link that holds a program: ``#code=`` and the raw-deflated JSON of its files in base64url,
    without padding. ``docs/design/studio.md`` has the format, and ``studio/src/program/link.ts`` reads it.
    """
    program = json.dumps({"files": dict(files), "main": main}, ensure_ascii=False, separators=(",", ":"))
    packer = zlib.compressobj(9, zlib.DEFLATED, -zlib.MAX_WBITS)
    packed = packer.compress(program.encode()) + packer.flush()
    return "#code=" + base64.urlsafe_b64encode(packed).decode().rstrip("=")


def program_in(fragment: str) -> tuple[dict[str, str], str]:
    """The files and the name of the main file in such a fragment. Raises ValueError for another text."""
    prefix, _, code = fragment.partition("=")
    if prefix != "#code":
        raise ValueError(f"this is not a program: {fragment[:60]!r}")
    try:
        packed = base64.b64decode(code + "=" * (-len(code) % 4), altchars="-_", validate=True)
        program = json.loads(zlib.decompress(packed, -zlib.MAX_WBITS))
    except (ValueError, zlib.error) as problem:
        raise ValueError(f"this is not a program: {fragment[:60]!r}") from problem
    return program["files"], program["main"]


def program_of(path: Path) -> tuple[dict[str, str], str]:
    """The files of a program and the name of its main file: everything that it imports by path, by names relative to
    the folder that contains all of them.
    """
    found: dict[Path, str] = {}
    waiting = [path.resolve()]
    while waiting:
        file = waiting.pop()
        if file not in found and file.exists():
            found[file] = file.read_text(encoding="utf-8")
            waiting += [(file.parent / imported).resolve() for imported in _IMPORT.findall(found[file])]
    folder = Path(os.path.commonpath([file.parent for file in found]))
    files = {file.relative_to(folder).as_posix(): text for file, text in found.items()}
    return files, path.resolve().relative_to(folder).as_posix()
