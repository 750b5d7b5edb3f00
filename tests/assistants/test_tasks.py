"""Solutions pass, and what is wrong fails for the reason that the task gives."""

from __future__ import annotations

from pathlib import Path

import pytest

import cspdiag
from tests.assistants.checks import judge
from tests.assistants.judge import main, verdict_on
from tests.assistants.tasks import Task, all_tasks, definitions

TASKS = all_tasks()
by_name = pytest.mark.parametrize("task", TASKS, ids=lambda task: task.name)


@by_name
def test_the_solution_passes(task: Task) -> None:
    failure = judge(task, task.solution)
    assert failure is None, failure
    assert cspdiag.parse(task.solution).check() == []


@by_name
def test_what_is_wrong_fails_where_it_should(task: Task) -> None:
    assert task.wrong
    for attempt in task.wrong:
        failure = judge(task, attempt.text)
        assert failure is not None, attempt.title
        assert failure.check == attempt.fails, failure


@by_name
def test_the_program_to_start_from_does_not_pass(task: Task) -> None:
    assert judge(task, task.start) is not None


def test_there_are_thirty_tasks() -> None:
    assert [task.number for task in TASKS] == [f"{number:02}" for number in range(1, 31)]


def test_nothing_is_exported_but_requests_and_programs(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--export", str(tmp_path / "a")]) == 0
    assert len(list((tmp_path / "a").iterdir())) == 60
    exported = "\n".join(path.read_text() for path in (tmp_path / "a").iterdir())
    assert "Judge" not in exported
    assert "Wrong:" not in exported
    assert capsys.readouterr().out == ""
    (tmp_path / "a" / "01.csp").write_text("changed")
    assert main(["--export", str(tmp_path / "a")]) == 2
    assert (tmp_path / "a" / "01.csp").read_text() == "changed"


def test_attempts_in_a_folder_are_judged(tmp_path: Path) -> None:
    (tmp_path / "right.csp").write_text(TASKS[0].solution)
    (tmp_path / "broken.csp").write_text("process {")
    assert verdict_on(TASKS[0], tmp_path / "right.csp") == "passed"
    assert verdict_on(TASKS[0], tmp_path / "broken.csp").startswith("failed `no errors: E0101`: line 1: ")
    assert verdict_on(TASKS[0], tmp_path / "missing.csp").startswith("not attempted")


def test_a_definition_is_replaced_with_its_comment() -> None:
    text = "/// One.\nconst a = 1\n\n/// Two.\nprocess P {\n  composition { skip }\n}\n"
    assert list(definitions(text)) == ["const a", "process P"]
    assert definitions(text)["process P"].startswith("/// Two.\n")
