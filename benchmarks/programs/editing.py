"""The time from a keystroke to the diagnostics of the language server in a program of 2,000 lines, in milliseconds; or
how much memory 10,000 keystrokes in a small program leave, in kilobytes.
"""

from __future__ import annotations

import gc
import re
import resource
import time
from collections.abc import Iterator
from pathlib import Path

from lsprotocol import types
from timing import report, requested_benchmark, size_of

from cspdiag.base.files.resources import case_study, example_folder
from cspdiag.lsp.features.diagnostics import diagnostic
from cspdiag.lsp.garbage import Garbage
from cspdiag.lsp.session import Session

DEFINITION = r"^(?:process|submodel|driver|environment|const|parameter|type|enum|struct|exception) (\w+)"
TYPED = "    var extra : double<rad> = 0<rad>\n"
"""A line that is typed into the communication block of a process, character by character, and deleted again."""
BEFORE = ("    alignL        : Align", "    law : SpindleController")


def program(lines: int) -> str:
    """About ``lines`` lines: copies of JIWY, in each of which all definitions have names of their own."""
    text = Path(case_study()).read_text(encoding="utf-8")
    names = re.findall(DEFINITION, text, re.MULTILINE)
    parts = [text]
    while sum(part.count("\n") for part in parts) < lines:
        copy = re.sub(r"^import .*\n", "", text, flags=re.MULTILINE)
        parts.append(re.sub(rf"\b({'|'.join(names)})\b", rf"\g<1>{len(parts)}", copy))
    return "\n".join(parts)


def keystrokes(text: str) -> Iterator[tuple[int, str, int]]:
    """Changes: the offset, the new character, and how many characters it replaces."""
    places = [match.start() for match in re.finditer("|".join(map(re.escape, BEFORE)), text)]
    place = places[len(places) // 2]
    while True:
        yield from ((place + position, character, 0) for position, character in enumerate(TYPED))
        yield from ((place + position, "", 1) for position in reversed(range(len(TYPED))))


Garbage.prepare()
session = Session()
count = size_of(requested_benchmark())
is_memory = "memory" in requested_benchmark()
small = example_folder() / "emergency" / "emergency.csp"
text = small.read_text(encoding="utf-8") if is_memory else program(count)
uri = Path(case_study()).with_name("edited.csp").as_uri()
document = session.documents.open(uri, text, 0)
session.diagnostics(document)
before = 0
"""The largest size after a tenth of the keystrokes, when everything that is loaded has been loaded."""
for version, (offset, character, replaced) in enumerate(keystrokes(text)):
    if version == (count if is_memory else 4 * len(TYPED)):
        break
    if version == count // 10:
        before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    start, end = (session.positions.position(document.source, at) for at in (offset, offset + replaced))
    change = types.TextDocumentContentChangePartial(types.Range(start, end), character)
    began = time.perf_counter()
    document.change([change], version, session.positions)
    for found in session.diagnostics(document):
        diagnostic(found, session.positions, session.documents.uri)
    if not is_memory:
        report((time.perf_counter() - began) * 1e3)
    if version % 10 == 0:
        # The server does it when the editor is quiet.
        gc.collect()
if is_memory:
    report(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before)
