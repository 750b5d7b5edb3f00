"""Words with a plainer English word stay out of code, messages and pages; docs/glossary.md says what to write."""

from __future__ import annotations

import importlib.util
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
GLOSSARY = ROOT / "docs" / "glossary.md"
CODE = ("cspdiag", "tests", "models", "benchmarks", "distribution")
SUFFIXES = (".py", ".csp", ".c", ".h", ".md", ".txt")

REFUSED = {
    "told": r"told",
    "so many": r"so[ _]many",
    "not come": r"not[ _]come(?! back)",
    "for ever": r"for[ _]ever",
    "whoever": r"whoever",
    "somebody": r"(?:some|every)body",
    "who waits for whom": r"who[ _]waits[ _]for[ _]whom",
    "goes on": r"(?:go(?:es|ing)?|went)[ _]on",
    "held against": r"(?:hold|holds|held)[ _](?:\w+[ _]){0,3}against",
    "leave it away": r"(?:leave|left) (?:[\w`'\"]+ ){0,4}away",
    "is said of": r"(?:is|be|was|nothing) said of",
    "stands for": r"stands? for",
    "come to be": r"comes? to be",
    "on every way": r"on every way",
    "is no number": r"(?:is|are) no numbers?",
    "books": r"books",
    "to tell apart": r"tell(?:s|ing)?[ _](?:\w+[ _]){0,3}apart",
    "is had by": r"is[ _]had[ _]by",
    "the sample before": r"the[ _]sample[ _]before(?! it)",
    "a delay of no time": r"delay of no time",
    "is no more": r"(?:is|are)[ _]no[ _]more(?! than)",
    "no sooner": r"no[ _]sooner",
    "is looked at": r"(?:is|are|was)[ _]looked[ _](?:at|for|inside|whether)",
    "has had a look": r"ha[sd][ _](?:had|taken)[ _]a[ _]look",
    "is called after": r"(?:is|are)[ _]called[ _]after",
    "the one style": r"the[ _]one[ _]style",
    "the house": r"the[ _]house",
    "for what is no text": r"(?:for|of|from) what is no(?! longer)",
    "a path that there is not": r"that there (?:is|are) not",
    "no environment can be had": r"(?:can|cannot) be had",
    "mend": r"mend(?:s|ed|ing)?",
    "one a line": r"(?:one|dots|row) a (?:line|pixel|process|page|code|state|file)",
}
"""The pattern of each refused word, as the glossary lists them; ``_`` does not count as a letter, so names are
searched, too.
"""


def refused_in(text: str) -> list[str]:
    """The refused words in a text, each with its line."""
    lower = text.lower()
    if not any(re.search(pattern, lower) for pattern in REFUSED.values()):
        return []  # Found in a fraction of the time, since these patterns begin with letters.
    found = []
    for number, line in enumerate(text.splitlines(), start=1):
        for word, pattern in REFUSED.items():
            if re.search(rf"(?<![A-Za-z]){pattern}(?![A-Za-z])", line, re.IGNORECASE):
                found.append(f"{number}: {word}")
    return found


def files() -> Iterator[str]:
    pages = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *ROOT.glob("docs/**/*.md"), *ROOT.glob("manual/**/*.md")]
    templates = [path for path in ROOT.glob("templates/**/*") if path.is_file()]
    code = [path for folder in CODE for path in ROOT.glob(f"{folder}/**/*") if path.suffix in SUFFIXES]
    for path in [*code, *templates, *pages]:
        name = path.relative_to(ROOT).as_posix()
        if not name.startswith("tests/golden/") and path not in (GLOSSARY, Path(__file__)):
            yield name


def rows(heading: str) -> list[list[str]]:
    """The cells of the table below a heading of the glossary."""
    section = GLOSSARY.read_text(encoding="utf-8").partition(f"\n## {heading}\n")[2].partition("\n## ")[0]
    lines = [line for line in section.splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines[2:]]


def test_refused_words_are_nowhere() -> None:
    found = {name: words for name in files() if (words := refused_in((ROOT / name).read_text(encoding="utf-8")))}
    assert not found, f"docs/glossary.md has plainer words for these: {found}"


def test_names_of_tests_have_no_refused_words() -> None:
    found = [
        f"{path.relative_to(ROOT)}: {name}"
        for path in ROOT.glob("tests/**/test_*.py")
        for name in (path.stem, *re.findall(r"def (test_\w+)", path.read_text(encoding="utf-8")))
        if refused_in(name.replace("_", " "))
    ]
    assert not found, f"docs/glossary.md has plainer words for these: {found}"


@pytest.mark.parametrize(
    "line",
    [
        "The user is told why.",
        "def told_apart() -> None: ...",
        "Whoever reads it waits for ever.",
        "Somebody reads it.",
        "The run goes on.",
        "It shows who waits for whom.",
        "the figures are held against a run",
        "Up to so many states.",
        "leave the branch away",
        "nothing is said of it",
        "a process keeps books",
        "Keys tell two of them apart.",
        "that is had by lowering",
        "one later than the sample before",
        "a delay of no time",
        "a channel that is no more",
        "It ends no sooner than that.",
        "the clock is looked at",
        "it is looked inside whether it was written",
        "The checker has had a look at it.",
        "what its functions are called after",
        "a file in the one style",
        "rules of the house",
        "Raises TypeError for what is no text.",
        "ArgumentError for a path that there is not",
        "if no environment can be had",
        "in dots a pixel",
        "a mended program",
        "senders_not_come = 0",
        "What the name stands for.",
        "The order in which they come to be.",
        "released on every way",
        "it is no number",
    ],
)
def test_a_refused_word_is_found(line: str) -> None:
    assert refused_in(f"x = 1\n{line}\n")[0].startswith("2: ")


@pytest.mark.parametrize(
    "line",
    [
        "He untold a tale.",
        "forever",
        "has not come back for 2 s",
        "the same manyfold",
        "--book page.html",
        "it is no more than that",
    ],
)
def test_other_words_are_not(line: str) -> None:
    assert refused_in(line) == []


def test_the_glossary_says_what_to_write_instead() -> None:
    starred = {word for cell, _ in rows("Not this, but this") for word in re.findall(r"([\w ]+) \*", cell)}
    assert {word.strip() for word in starred} == set(REFUSED)


@pytest.mark.parametrize(("term", "names"), [(term, names) for term, _, names in rows("Terms")])
def test_the_terms_have_their_names_in_the_code(term: str, names: str) -> None:
    shorthands = {"ast": "cspdiag.syntax.ast", "ir": "cspdiag.network.ir"}
    for dotted in re.findall(r"`([\w.]+\.[\w.]+)`", names):
        first, _, rest = dotted.partition(".")
        whole = f"{shorthands.get(first, f'cspdiag.{first}')}.{rest}"
        assert _exists(whole), f"{term}: {whole}"


def _exists(dotted: str) -> bool:
    """Whether there is a module, a name in a module, or a name in one of the modules of a package, with this dotted
    name.
    """
    if _has_module(dotted):
        return True
    parent, _, name = dotted.rpartition(".")
    module = importlib.import_module(parent)
    folders = [Path(folder) for folder in getattr(module, "__path__", [])]
    inside = [f"{parent}.{path.stem}" for folder in folders for path in folder.glob("*.py") if path.stem != "__init__"]
    return any(hasattr(place, name) for place in (module, *map(importlib.import_module, inside)))


def _has_module(dotted: str) -> bool:
    try:
        return importlib.util.find_spec(dotted) is not None
    except ModuleNotFoundError:
        return False
