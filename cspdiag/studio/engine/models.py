"""The example programs and the manual pages, for the page."""

from __future__ import annotations

import re
from collections.abc import Iterator

from cspdiag.base.files.examples import files_of, main_program, summaries
from cspdiag.base.manual import manual_page as read_page
from cspdiag.studio.engine.data import Data
from cspdiag.studio.engine.failure import RequestError

_TEXTS = (".csp", ".py", ".svg")
"""What a program consists of: its text, hand-written bodies, and drawings that move with the run."""
_IMPORT = re.compile(r'^import\s+"([^"]+)"', re.MULTILINE)
_DESCRIBED = re.compile(r"^((?:///[^\n]*\n)+)process\b", re.MULTILINE)
_FIRST = "jiwy"
"""The case study."""


def models() -> list[Data]:
    """The example programs, the case study first."""
    names = sorted(summaries().items(), key=lambda entry: (entry[0] != _FIRST, entry[0]))
    return [model for name, title in names for model in _models(name, title)]


def _models(example: str, title: str) -> Iterator[Data]:
    """The programs of an example: the main one, and others, which no file imports."""
    found = files_of(example)
    texts = {path: data.decode() for path, data in found.items() if path.endswith(_TEXTS)}
    main = f"{example}/{main_program(example)}"
    own = [path for path in texts if path.startswith(f"{example}/") and path.endswith(".csp")]
    if all(path.startswith(f"{example}/") for path in texts):
        texts = {path.partition("/")[2]: text for path, text in texts.items()}
        main, own = main.partition("/")[2], [path.partition("/")[2] for path in own]
    yield {"name": example, "title": title, "files": texts, "main": main}
    imported = {name for text in texts.values() for name in _IMPORT.findall(text)}
    for path in own:
        name = path.rpartition("/")[2]
        if path != main and name not in imported:
            known = {"name": f"{example}/{name.removesuffix('.csp')}", "title": _about(texts[path]) or title}
            yield {**known, "files": texts, "main": path}


def _about(text: str) -> str:
    """The first sentence of what is said about the last process of a text."""
    found = _DESCRIBED.findall(text)
    words = " ".join(line.removeprefix("///").strip() for line in found[-1].splitlines()) if found else ""
    return re.split(r"(?<=[.:]) ", words, maxsplit=1)[0].rstrip(":.")


def manual_page(code: str) -> Data:
    """The manual page of a diagnostic as Markdown. Raises RequestError for an unknown code."""
    try:
        page = read_page(code)
    except KeyError:
        raise RequestError(f"there is no diagnostic {code!r}") from None
    return {"code": page.code, "title": page.title, "markdown": page.markdown}
