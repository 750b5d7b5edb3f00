"""The lectures do what they say, and their pictures are made by their commands."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import cspdiag
from tests.support.verifying import answers_to

ROOT = Path(__file__).parents[3]
LECTURES = sorted((ROOT / "docs" / "lectures").glob("*.md"))
_PROGRAM = re.compile(r"^<!-- (\S+\.csp) -->\n```csp\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def lecture(name: str) -> dict[str, str]:
    """The programs of a lecture by file name."""
    text = (ROOT / "docs" / "lectures" / f"{name}.md").read_text(encoding="utf-8")
    return dict(_PROGRAM.findall(text))


@pytest.mark.parametrize("page", LECTURES, ids=lambda page: page.stem)
def test_pictures_of_lectures_are_made_by_their_commands(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    run = "".join(re.findall(r"^<!-- run -->\n```sh\n(.*?)^```$", text, re.MULTILINE | re.DOTALL))
    shown = re.findall(r"!\[[^\]]*\]\(([^)]*)\)", text)
    assert shown
    assert [picture for picture in shown if f" {picture}\n" not in run] == []


@pytest.mark.parametrize("page", LECTURES, ids=lambda page: page.stem)
def test_readers_have_every_file_that_a_command_of_a_lecture_reads(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    assert "top folder" in text
    for block in re.finditer(r"^```sh\n(.*?)^```$|`(cspdiag [^`]*)`", text, re.MULTILINE | re.DOTALL):
        commands, before = block[1] or block[2], text[: block.start()]
        for name in re.findall(r"\S+\.csp(?= |$)", commands, re.MULTILINE):
            said = f"Save it as `{name}`" in before
            written = re.search(rf"> {re.escape(name)}$", before + commands, re.MULTILINE)
            assert (ROOT / name).exists() or said or written, f"nobody has {name}"


@pytest.mark.parametrize("page", LECTURES, ids=lambda page: page.stem)
def test_programs_of_lectures_are_saved_under_the_name_that_is_said(page: Path) -> None:
    said = re.findall(r"Save it as `([^`]*)`", page.read_text(encoding="utf-8"))
    assert said == list(lecture(page.stem))


def test_the_repaired_table_is_what_the_tool_suggests() -> None:
    files = {path.name: path.read_text(encoding="utf-8") for path in (ROOT / "models/dining").glob("*.csp")}
    (deadlock, _) = answers_to(files, "deadlock.csp")
    added = [line[1:] for line in deadlock.suggestions[0].difference if line[0] == "+"]
    (repaired,) = lecture("philosophers").values()
    assert added
    assert [line for line in added if line not in repaired.splitlines()] == []
    (answer,) = answers_to({**files, "repaired.csp": repaired}, "repaired.csp")
    assert answer.outcome == "proved"


def test_one_half_takes_the_press_from_the_other() -> None:
    half = lecture("button")["half.csp"]
    assert [each.code for each in cspdiag.parse(half).check()] == ["E0523"]
    ends = {}
    for kind in ("any", "broadcast"):
        program = cspdiag.parse(half.replace("button      -> one", f"button      -> {kind} -> one"))
        run = program.run(until="3 s")
        ends[kind] = (run.outcome.ended, len(run["left"]) > 0, len(run["right"]) > 0)
    assert ends == {"any": ("time limit", True, False), "broadcast": ("terminated", True, True)}


def test_the_loop_is_stable_at_2_ms_and_not_at_10_ms(tmp_path: Path) -> None:
    for name in ("laws.csp", "plant.csp"):
        (tmp_path / name).write_text((ROOT / "models/jiwy" / name).read_text(encoding="utf-8"), encoding="utf-8")
    (text,) = lecture("slow-loop").values()
    (tmp_path / "pan.csp").write_text(text, encoding="utf-8")
    program = cspdiag.load(tmp_path / "pan.csp")

    def swing(period: str) -> float:
        run = program.run(set={"T": period}, until="1200 ms")
        late = run.time("angle") > 0.9
        return float(run["angle"][late].max() - run["angle"][late].min())

    assert swing("2 ms") < 0.005
    assert swing("10 ms") > 0.1


def test_the_loop_that_was_forgotten_is_found() -> None:
    (text,) = lecture("emergency-stop").values()
    (answer,) = answers_to({"case.csp": text})
    assert answer.outcome == "refuted"
    first, _, second = text.partition(" interrupt panel ? button -> control ! 0<V> ;\n    ")
    second, _, rest = second.partition(" ;\n    control ! 0<V>")
    assert rest
    before, _, loop = first.rpartition("\n    ")
    around_both = f"{before}\n    ({loop} ; {second}) interrupt panel ? button -> control ! 0<V>{rest}"
    (answer,) = answers_to({"case.csp": around_both})
    assert answer.outcome == "proved"
