"""What a server remembers, by content."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from cspdiag.base.sources import SourceFile
from cspdiag.cli.server.memory import Memory, Use
from cspdiag.pipeline import check
from tests.cli.conftest import BAD, GOOD


def reader(files: dict[str, str]) -> Callable[[str], SourceFile]:
    def read(name: str) -> SourceFile:
        if name not in files:
            raise FileNotFoundError(2, "no such file", name)
        return SourceFile(name=name, text=files[name])

    return read


MAIN = SourceFile(name="main.csp", text='import "part.csp"\nimport std.control\n')


def findings(memory: Memory, files: dict[str, str]) -> list[object]:
    return [(found.code, found.message, str(found.span)) for found in memory.findings(MAIN, reader(files))]


def learned(files: dict[str, str]) -> Memory:
    memory = Memory()
    memory.findings(MAIN, reader(files))
    for use in memory.uses:
        memory.learn(use)
    return memory


def test_it_finds_what_a_check_finds() -> None:
    for text in (GOOD, BAD, "process {", GOOD + GOOD):
        files = {"part.csp": text}
        plain = [
            (found.code, found.message, str(found.span)) for found in check(MAIN, reader(files)).report.diagnostics
        ]
        memory = learned(files)
        assert findings(Memory(), files) == plain
        assert findings(memory, files) == plain
        assert findings(memory, {"part.csp": f"{text}\n"}) == [
            (found.code, found.message, str(found.span))
            for found in check(MAIN, reader({"part.csp": f"{text}\n"})).report.diagnostics
        ]


def test_a_known_program_is_not_checked_again() -> None:
    memory = learned({"part.csp": BAD})
    first, second = (memory.findings(MAIN, reader({"part.csp": BAD})) for _ in range(2))
    assert first is second
    assert memory.findings(MAIN, reader({"part.csp": GOOD})) is not first


def test_a_program_with_a_file_that_cannot_be_read_is_not_learned() -> None:
    memory = Memory()
    memory.findings(MAIN, reader({}))
    assert memory.uses == []
    known = learned({"part.csp": GOOD})
    assert [found.code for found in known.findings(MAIN, reader({}))] == ["E0120"]


@pytest.mark.parametrize("file", ["main.csp", "part.csp"])
def test_a_program_with_an_fmu_is_not_learned(file: str) -> None:
    submodel = 'submodel Plant fmu "plant.fmu" { in u : double  out y : double }\n'
    texts = {"main.csp": MAIN.text, "part.csp": GOOD}
    texts[file] += submodel
    memory = Memory()
    memory.findings(SourceFile(name="main.csp", text=texts["main.csp"]), reader(texts))
    assert memory.uses == [], "it depends on a file that is no text"


def test_what_was_used_last_is_kept() -> None:
    text = GOOD + "// " + "x" * 500
    memory = Memory(5 * len(text))
    programs = [SourceFile(name=f"{number}.csp", text=text) for number in range(8)]
    for program in programs:
        memory.learn(Use((program.name, text), ()))
        kept = memory.findings(programs[0], reader({}))
        assert memory.findings(programs[0], reader({})) is kept, "it is used all the time"
    assert memory.findings(programs[1], reader({})) is not memory.findings(programs[1], reader({}))
    assert memory.findings(programs[7], reader({})) is memory.findings(programs[7], reader({}))


def test_a_program_that_is_too_large_is_not_learned() -> None:
    memory = Memory(len(GOOD))
    main = SourceFile(name="main.csp", text=f"{GOOD}\n")
    memory.learn(Use((main.name, main.text), ()))
    assert memory.findings(main, reader({})) is not memory.findings(main, reader({}))
