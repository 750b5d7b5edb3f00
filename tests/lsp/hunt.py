"""Deletes every token of every model in turn, and asks for everything there: python -m tests.lsp.hunt [MODEL ...]."""

from __future__ import annotations

import sys
import traceback
from pathlib import Path

from cspdiag.lsp.session import Session
from tests.lsp.everything import ask, without_each_token

ROOT = Path(__file__).parents[2]


def failures(path: Path, every: int = 1) -> list[str]:
    """What goes wrong when every ``every``-th token of a file is deleted."""
    session, found = Session(), []
    document = session.documents.open(path.as_uri(), path.read_text(encoding="utf-8"), 0)
    whole = document.source
    for number, (text, offset) in enumerate(without_each_token(whole)):
        if number % every:
            continue
        document = session.documents.open(path.as_uri(), text, number)
        for place in {offset, max(0, offset - 1)}:
            try:
                answers = ask(session, document, place)
                found += [f"{path.name}:{offset}: {problem}" for problem in stale(text, answers)]
            except Exception:
                line = whole.position(offset)
                found.append(
                    f"{path.name}:{line}, without {whole.text[offset : offset + 12]!r}: {traceback.format_exc()}"
                )
    return found


def stale(text: str, answers: dict[str, object]) -> list[str]:
    """The answers that are about another text: with places that it does not have, or names that are not there."""
    lines = text.split("\n")
    found = []
    for symbol in answers["outline"]:  # type: ignore[attr-defined]
        place = symbol.selection_range
        if lines[place.start.line][place.start.character : place.end.character] != symbol.name:
            found.append(f"the outline has {symbol.name} where there is something else")
    hover = answers["hover"]
    if hover is not None:
        place = hover.range  # type: ignore[attr-defined]
        word = lines[place.start.line][place.start.character : place.end.character]
        if not word.isidentifier():
            found.append(f"hover is about {word!r}")
    return found


def main() -> int:
    names = [Path(name) for name in sys.argv[1:]] or sorted(
        [*ROOT.glob("models/*/*.csp"), *ROOT.glob("cspdiag/std/*.csp")]
    )
    found = [problem for path in names for problem in failures(path.resolve())]
    print("\n".join(found) or f"nothing found in {len(names)} files")
    return bool(found)


if __name__ == "__main__":
    sys.exit(main())
