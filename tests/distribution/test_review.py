"""Programs in review: the action for GitHub, GitLab's template, hooks for pre-commit, and git's own differences."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from ruamel.yaml import YAML

from cspdiag.draw.layout.elk import engine_available

ROOT = Path(__file__).parents[2]
REVIEW = ROOT / "distribution" / "review"
PROGRAM = """\
process Relay {
  in  given : int
  out taken : int

  communication {
    var held : int = 0
  }

  composition {
    mu (given ? held ; taken ! held)
  }
}
"""


LIBRARY = """submodel Twice {
  in  u : double
  out y : double

  y = 2 * u
}
"""


def git(folder: Path, *arguments: str) -> str:
    identity = ("-c", "user.name=A", "-c", "user.email=a@example.org", "-c", "commit.gpgsign=false")
    done = subprocess.run(["git", *identity, *arguments], cwd=folder, check=True, capture_output=True, text=True)
    return done.stdout.strip()


@pytest.fixture
def repository(tmp_path: Path) -> Path:
    """A repository with a remote one, and a program in a folder."""
    subprocess.run(["git", "init", "--quiet", "--bare", tmp_path / "remote.git"], check=True)
    folder = tmp_path / "my programs"
    (folder / "the models").mkdir(parents=True)
    git(folder, "init", "--quiet", "--initial-branch=main")
    git(folder, "remote", "add", "origin", str(tmp_path / "remote.git"))
    (folder / "the models" / "relay.csp").write_text(PROGRAM)
    git(folder, "add", "--all")
    git(folder, "commit", "--quiet", "--message", "first")
    return folder


def run(folder: Path, script: str, *arguments: str, **settings: str) -> subprocess.CompletedProcess[str]:
    """Run a script of the action with a ``gh`` that writes down what it is called with."""
    tools = folder.parent / "tools"
    tools.mkdir(exist_ok=True)
    gh = tools / "gh"
    gh.write_text(
        '#!/bin/sh\nprintf "%s\\n" "$*" >> "$CALLS"\n'
        'case "$2" in --paginate) printf "%s" "$EARLIER" ;; esac\n'
        'exit "${GH_STATUS:-0}"\n'
    )
    gh.chmod(0o755)
    environment = {
        **os.environ,
        "PATH": f"{tools}:{Path(sys.executable).parent}:{os.environ['PATH']}",
        "RUNNER_TEMP": str(folder.parent / "temporary files"),
        "GITHUB_STEP_SUMMARY": str(folder.parent / "summary.md"),
        "GITHUB_SERVER_URL": "https://git.example",
        "GITHUB_REPOSITORY": "owner/programs",
        "CALLS": str(folder.parent / "calls"),
        "EARLIER": "",
        "NUMBER": "7",
        "COMMENT": "true",
        "PICTURES_BRANCH": "",
        "BASE": git(folder, "rev-parse", "main"),
        **settings,
    }
    return subprocess.run(
        ["bash", str(REVIEW / script), *arguments],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.mark.skipif(not engine_available(), reason="the layout engine is not there: make setup fetches it")
def test_a_pull_request_gets_its_changes_with_pictures(repository: Path) -> None:
    base = git(repository, "rev-parse", "main")
    program = repository / "the models" / "relay.csp"
    program.write_text(PROGRAM.replace("out taken : int", "out taken : int @ 2 ms"))
    git(repository, "commit", "--quiet", "--all", "--message", "second")
    done = run(repository, "changes.sh", BASE=base, PICTURES_BRANCH="pictures")
    assert done.returncode == 0, done.stderr
    summary = (repository.parent / "summary.md").read_text()
    assert "! port taken: period none → 2 ms\n" in summary
    (address,) = re.findall(r"\(https://git.example/owner/programs/raw/(\w+)/the%20models/relay.png\)", summary)
    assert git(repository, "ls-remote", "origin", "refs/heads/pictures/7").split()[0] == address
    assert (
        git(repository, "show", "--name-only", "--format=%s", address)
        == "Pictures of pull request 7\n\nthe models/relay.png"
    )
    assert git(repository, "status", "--short") == ""
    assert (repository.parent / "calls").read_text().splitlines()[1].startswith("pr comment 7 --repo owner/programs")
    again = run(repository, "changes.sh", BASE=base, EARLIER="1234")
    assert again.returncode == 0
    assert "--method PATCH repos/owner/programs/issues/comments/1234" in (repository.parent / "calls").read_text()


@pytest.mark.skipif(not engine_available(), reason="the layout engine is not there: make setup fetches it")
def test_without_permissions_the_changes_are_in_the_summary(repository: Path) -> None:
    base = git(repository, "rev-parse", "main")
    (repository / "the models" / "relay.csp").write_text(PROGRAM.replace("held", "kept"))
    git(repository, "remote", "set-url", "origin", str(repository.parent / "nowhere"))
    done = run(repository, "changes.sh", BASE=base, PICTURES_BRANCH="pictures", GH_STATUS="1")
    assert done.returncode == 0, done.stderr
    assert "::warning::the pictures could not be pushed" in done.stderr
    assert "::warning::no comment" in done.stdout
    assert "is now called kept" in (repository.parent / "summary.md").read_text()
    nothing = run(repository, "changes.sh", BASE="nowhere")
    assert nothing.returncode != 0


def test_the_comment_of_an_earlier_run_says_that_nothing_differs_any_more(repository: Path) -> None:
    calls = repository.parent / "calls"
    assert run(repository, "changes.sh", EARLIER="1234").returncode == 0
    assert "--method PATCH repos/owner/programs/issues/comments/1234 -F body=@" in calls.read_text()
    (commented,) = (repository.parent / "temporary files").rglob("comment.md")
    assert commented.read_text().endswith("\n\nNo diagram differs any more.\n")
    calls.unlink()
    assert run(repository, "changes.sh").returncode == 0
    assert "pr comment" not in calls.read_text()
    calls.unlink()
    assert run(repository, "changes.sh", EARLIER="1234", COMMENT="false").returncode == 0
    assert not calls.exists()


def test_a_program_that_cannot_be_read_is_a_change(repository: Path) -> None:
    base = git(repository, "rev-parse", "main")
    (repository / "the models" / "relay.csp").write_bytes(b"\xff")
    done = run(repository, "changes.sh", BASE=base)
    assert done.returncode == 0, done.stderr
    assert "no program has changed" not in done.stdout
    assert "not UTF-8 text" in (repository.parent / "summary.md").read_text()


def test_all_programs_are_checked_and_verified(repository: Path) -> None:
    (repository / "laws.csp").write_text(LIBRARY)
    git(repository, "add", "--all")
    assert run(repository, "check.sh", "check").returncode == 0
    assert run(repository, "check.sh", "verify").returncode == 0
    (repository / "wrong.csp").write_text(PROGRAM.replace("? held", "? hold"))
    git(repository, "add", "--all")
    done = run(repository, "check.sh", "check")
    assert (done.returncode, "::error file=wrong.csp,line=10" in done.stdout) == (1, True)
    assert run(repository, "check.sh", "verify").returncode != 0
    assert run(repository, "check.sh", "check", FILES="*.dsp").returncode == 1


def test_the_hooks_call_commands_that_exist(repository: Path) -> None:
    hooks = YAML(typ="safe").load((ROOT / ".pre-commit-hooks.yaml").read_text())
    program = repository / "the models" / "relay.csp"
    laws = repository / "laws.csp"
    laws.write_text(LIBRARY)
    wrong = repository / "wrong.csp"
    wrong.write_text(PROGRAM.replace("? held", "? hold"))
    path = f"{Path(sys.executable).parent}:{os.environ['PATH']}"
    assert [hook["id"] for hook in hooks] == ["cspdiag-fmt", "cspdiag-check", "cspdiag-verify"]
    for hook in hooks:
        for files, works in (([program, laws], True), ([program, wrong], hook["id"] == "cspdiag-fmt")):
            command = f'{hook["entry"]} "$@"' if "bash" not in hook["entry"] else hook["entry"] + ' "$@"'
            done = subprocess.run(
                ["bash", "-c", command, "hook", *files],
                env={**os.environ, "PATH": path},
                capture_output=True,
                text=True,
                check=False,
            )
            assert (done.returncode == 0) == works, (hook["id"], done.stderr)
    subprocess.run(
        [shutil.which("cspdiag", path=path) or "", "check", "--server-stop"], check=False, capture_output=True
    )


def gitlab_jobs() -> dict[str, dict[str, Any]]:
    """The jobs of GitLab's template, with what they have from those that they extend."""
    given = YAML(typ="safe").load((REVIEW / "gitlab.yml").read_text())
    return {
        name: given[job["extends"]] | job
        for name, job in given.items()
        if name.startswith("cspdiag-") and isinstance(job, dict)
    }


def run_in_gitlab(folder: Path, job: str) -> subprocess.CompletedProcess[str]:
    script = "\n".join(gitlab_jobs()[job]["script"])
    path = f"{Path(sys.executable).parent}:{os.environ['PATH']}"
    return subprocess.run(
        ["bash", "-e", "-o", "pipefail", "-c", script],
        cwd=folder,
        env={**os.environ, "PATH": path},
        capture_output=True,
        text=True,
        check=False,
    )


def test_all_jobs_of_gitlab_are_in_the_pipeline_of_a_merge_request() -> None:
    """A job without rules is in none of these, and the merge request shows no other pipeline."""
    jobs = gitlab_jobs()
    assert set(jobs) == {"cspdiag-check", "cspdiag-verify", "cspdiag-changes"}
    for name, job in jobs.items():
        assert job["rules"][0] == {"if": '$CI_PIPELINE_SOURCE == "merge_request_event"'}, name
    for name in ("cspdiag-check", "cspdiag-verify"):
        # Not twice for one commit.
        assert jobs[name]["rules"][1] == {"if": "$CI_COMMIT_BRANCH && $CI_OPEN_MERGE_REQUESTS", "when": "never"}


def test_gitlab_checks_all_programs(repository: Path) -> None:
    assert run_in_gitlab(repository, "cspdiag-check").returncode == 0
    (repository / "-wrong.csp").write_text(PROGRAM.replace("? held", "? hold"))
    git(repository, "add", "--all")
    assert run_in_gitlab(repository, "cspdiag-check").returncode == 1
    report = (repository / "check.xml").read_text()
    assert "-wrong.csp" in report
    assert "the models/relay.csp" in report
    git(repository, "rm", "--quiet", "-r", "--force", ".")
    done = run_in_gitlab(repository, "cspdiag-check")
    assert (done.returncode, done.stderr) == (1, "no file of this project matches *.csp\n")


def test_each_program_has_a_report_of_its_own_in_gitlab(repository: Path) -> None:
    (repository / "the-models").mkdir()
    for name in ("the-models/relay.csp", "the models-relay.csp", "the models/laws.csp"):
        (repository / name).write_text(LIBRARY if "laws" in name else PROGRAM)
    git(repository, "add", "--all")
    assert run_in_gitlab(repository, "cspdiag-verify").returncode == 0
    reports = [report.read_text() for report in (repository / "proofs").glob("*.xml")]
    assert len(reports) == 4
    assert sum('tests="0"' in report for report in reports) == 1


def test_differences_of_git_name_the_definition_and_leave_layout_out(
    repository: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With the lines of docs/review.md."""
    monkeypatch.setenv("PATH", f"{Path(sys.executable).parent}:{os.environ['PATH']}")
    lines = re.findall(r"^    (echo .*|git config .*)$", (ROOT / "docs" / "review.md").read_text(), re.MULTILINE)
    assert len(lines) == 3
    for line in lines:
        subprocess.run(["sh", "-c", line], cwd=repository, check=True)
    program = repository / "the models" / "relay.csp"
    program.write_text(PROGRAM.replace("mu (given", "mu (skip ; given"))
    assert re.search(r"^@@ .* @@ process Relay \{$", git(repository, "diff"), re.MULTILINE)
    program.write_text(PROGRAM.replace("  ", "      "))
    assert git(repository, "diff", "--", "*.csp").count("\n@@") == 0
    program.write_text("process {")
    assert "\n+process {" in git(repository, "diff")


@pytest.mark.parametrize(
    ("file", "schema"),
    [
        ("action.yml", ["vendor.github-actions"]),
        ("distribution/review/gitlab.yml", ["vendor.gitlab-ci", "--data-transform", "gitlab-ci"]),
    ],
)
def test_files_follow_their_schemas(file: str, schema: list[str]) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "check_jsonschema", "--builtin-schema", *schema, ROOT / file],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout
