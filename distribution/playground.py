"""Puts the engine that runs in browsers into ``studio/build/engine``: Python as WebAssembly, cspdiag and what it needs
in one archive, and the layout engine. Nothing is fetched when the page is used.

python distribution/playground.py
"""

from __future__ import annotations

import subprocess
import sys
import zipfile
from collections.abc import Iterator
from importlib.metadata import distribution
from pathlib import Path
from shutil import copyfile

ROOT = Path(__file__).parent.parent
STUDIO = ROOT / "studio"
PYODIDE = ("pyodide.mjs", "pyodide.asm.mjs", "pyodide.asm.wasm", "python_stdlib.zip", "pyodide-lock.json")
"""Its scripts become ``.js``: browsers refuse a module that a server does not name JavaScript, and many do not know
``.mjs``.
"""
PACKAGES = {"jinja2": "Jinja2", "lark": "lark", "markupsafe": "MarkupSafe"}
"""Packages in Python alone, by the folder in which they are, as installed from PyPI."""
RESOURCES = ("grammars", "manual", "models", "templates")
LICENCES = """\
Pyodide: Mozilla Public License 2.0, https://github.com/pyodide/pyodide
CPython, which it contains: PSF License Agreement, https://docs.python.org/3/license.html
elkjs (elk.js): Eclipse Public License 2.0, LICENSE-elkjs.md
cspdiag.zip: MIT; jinja2, lark and markupsafe have their licences in it.
"""
_LEFT_OUT = {"__pycache__", "third-party"}
_TEXTS = {".py", ".csp", ".lark", ".md", ".txt", ".svg", ".jinja", ".typed"}
_DATE = (2020, 1, 1, 0, 0, 0)
"""The same archive of the same files."""


def archive(path: Path) -> int:
    """Write the archive that is unpacked in the browser, without what ``bytecode.mjs`` adds, who compresses it, too;
    returns the number of its files.
    """
    count = 0
    with zipfile.ZipFile(path, "w") as made:
        for name, file in sorted(_files()):
            made.writestr(zipfile.ZipInfo(name, _DATE), file.read_bytes())
            count += 1
    return count


def _files() -> Iterator[tuple[str, Path]]:
    for file in _below(ROOT / "cspdiag"):
        if "studio/server" not in file.as_posix() and file.suffix in (".py", ".csp", ".typed"):
            yield f"cspdiag/{file.relative_to(ROOT / 'cspdiag').as_posix()}", file
    for folder in RESOURCES:
        for file in _below(ROOT / folder):
            if folder != "models" or file.suffix in (".csp", ".py", ".svg", ".md"):
                yield f"cspdiag/_resources/{folder}/{file.relative_to(ROOT / folder).as_posix()}", file
    yield "cspdiag/_resources/docs/language-in-brief.md", ROOT / "docs" / "language-in-brief.md"
    for folder, name in PACKAGES.items():
        found = distribution(name)
        for entry in found.files or ():
            parts = entry.parts
            is_licence = "licenses" in parts or entry.name.upper().startswith("LICENSE")
            is_own = parts[0] == folder and entry.suffix in (".py", ".lark")
            if (is_own and not _LEFT_OUT & set(parts)) or is_licence:
                yield entry.as_posix(), Path(str(entry.locate()))


def _below(folder: Path) -> Iterator[Path]:
    for file in folder.rglob("*"):
        if file.is_file() and not _LEFT_OUT & set(file.relative_to(folder).parts):
            yield file


def wrapped(script: str) -> str:
    """The layout engine as a function that is given what it takes for its surroundings."""
    names = "module, exports, self, window, global, document, console, "
    names += "setTimeout, setInterval, clearTimeout, clearInterval"
    return f"globalThis.layoutEngine = function ({names}) {{\n{script}\n}};\n"


def main() -> int:
    """Write all files; says what is missing."""
    source, target = STUDIO / "node_modules" / "pyodide", STUDIO / "build" / "engine"
    script = ROOT / "third-party" / "elkjs" / "elk-worker.min.js"
    for needed, how in ((source, "make studio"), (script, "make setup")):
        if not needed.exists():
            print(f"{needed.relative_to(ROOT)} is missing: {how}", file=sys.stderr)
            return 1
    target.mkdir(parents=True, exist_ok=True)
    for old in target.glob("*.mjs"):
        old.unlink()
    for name in PYODIDE:
        if name.endswith(".mjs"):
            text = (source / name).read_text(encoding="utf-8").replace("pyodide.asm.mjs", "pyodide.asm.js")
            (target / name).with_suffix(".js").write_text(text, encoding="utf-8")
        else:
            copyfile(source / name, target / name)
    copyfile(script.parent / "LICENSE.md", target / "LICENSE-elkjs.md")
    (target / "LICENCES.txt").write_text(LICENCES, encoding="utf-8")
    (target / "elk.js").write_text(wrapped(script.read_text(encoding="utf-8")), encoding="utf-8")
    count = archive(target / "cspdiag.zip")
    subprocess.run(["node", str(ROOT / "distribution" / "bytecode.mjs"), str(target)], check=True)
    size = sum(file.stat().st_size for file in target.iterdir())
    print(f"wrote {target.relative_to(ROOT)}: {count} files of Python and texts, {size / 1e6:.1f} MB in all")
    return 0


if __name__ == "__main__":
    sys.exit(main())
