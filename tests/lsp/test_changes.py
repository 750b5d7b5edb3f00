"""After any number of changes everything that is known of a program is what a server knows that has just been started.

``python -m tests.lsp.test_changes SECONDS SEED`` looks for differences for longer.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path
from random import Random

import pytest

from cspdiag.lsp.session import Session
from tests.lsp.everything import ask
from tests.syntax.edits import changed, versions
from tests.syntax.test_incremental import ROOT, shown

PROGRAMS = (
    ("models/dining/dining.csp", "models/dining/table.csp"),
    ("models/watchdog/watchdog.csp",),
    ("models/emergency/emergency.csp",),
    ("models/jiwy/jiwy.csp", "models/jiwy/laws.csp", "models/jiwy/plant.csp"),
)


def opened(folder: Path, names: tuple[str, ...], texts: list[str]) -> Session:
    """A server with all files of a program open."""
    session = Session()
    for name, text in zip(names, texts, strict=True):
        session.documents.open((folder / Path(name).name).as_uri(), text, 0)
    return session


def compare(folder: Path, names: tuple[str, ...], seed: int, count: int) -> None:
    """Change the files of a program in turn; compare the diagnostics always, and everything else at a random place."""
    random = Random(seed)
    texts = [(ROOT / name).read_text(encoding="utf-8") for name in names]
    changing = [versions(random, text, count) for text in texts]
    session = opened(folder, names, texts)
    for _ in range(count):
        number = random.randrange(len(names))
        texts[number] = next(changing[number])
        session.documents.open((folder / Path(names[number]).name).as_uri(), texts[number], 0)
        other = opened(folder, names, texts)
        for mine, fresh in zip(list(session.documents), list(other.documents), strict=True):
            if random.random() < 0.7:
                assert shown(session.diagnostics(mine)) == shown(other.diagnostics(fresh)), (seed, texts)
            if random.random() < 0.2:
                offset = random.randint(0, len(mine.source.text))
                assert repr(ask(session, mine, offset)) == repr(ask(other, fresh, offset)), (seed, offset, texts)


def compare_small(folder: Path, names: tuple[str, ...], seed: int, count: int) -> None:
    """Make one or two changes in a correct program, and compare the diagnostics; then in the correct program again."""
    random = Random(seed)
    correct = [(ROOT / name).read_text(encoding="utf-8") for name in names]
    session = opened(folder, names, correct)
    for _ in range(count):
        texts = list(correct)
        for _ in range(random.choice((0, 1, 1, 1, 2))):
            number = random.randrange(len(names))
            texts[number] = changed(random, texts[number])
        for name, text in zip(names, texts, strict=True):
            session.documents.open((folder / Path(name).name).as_uri(), text, 0)
        other = opened(folder, names, texts)
        for mine, fresh in zip(list(session.documents), list(other.documents), strict=True):
            assert shown(session.diagnostics(mine)) == shown(other.diagnostics(fresh)), (seed, texts)


@pytest.mark.parametrize("names", PROGRAMS)
def test_small_changes(names: tuple[str, ...], tmp_path: Path) -> None:
    compare_small(tmp_path, names, seed=1, count=20)


@pytest.mark.parametrize("names", PROGRAMS)
def test_random_changes(names: tuple[str, ...], tmp_path: Path) -> None:
    compare(tmp_path, names, seed=1, count=15)


if __name__ == "__main__":
    end, next_seed = time.monotonic() + float(sys.argv[1]), int(sys.argv[2])
    while time.monotonic() < end:
        with tempfile.TemporaryDirectory() as made:
            compare(Path(made), PROGRAMS[next_seed % len(PROGRAMS)], next_seed, 40)
            compare_small(Path(made), PROGRAMS[next_seed % len(PROGRAMS)], next_seed, 80)
        next_seed += 1
    print(f"no difference up to seed {next_seed}")
