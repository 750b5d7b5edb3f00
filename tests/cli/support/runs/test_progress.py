"""What a run reports about itself while it continues."""

from __future__ import annotations

import time
from pathlib import Path

import pytest

from cspdiag import pipeline
from cspdiag.base.sources import read_source
from cspdiag.base.span import SourceFile
from cspdiag.cli.main import main
from cspdiag.cli.support.runs.endless import EndlessRun
from cspdiag.cli.support.runs.progress import Progress
from cspdiag.network.checks.endless import never_ends
from cspdiag.simulate.record.modes import ModeGroup
from cspdiag.simulate.record.recorder import Recorder


class Somewhere:
    """A program at 1.5 s."""

    now = 1_500_000_000


def test_progress_is_written_in_lines_without_a_terminal(capsys: pytest.CaptureFixture[str]) -> None:
    with Progress(Recorder(communications=False), [], interval=0.02) as progress:
        progress.attach(Somewhere())
        while progress.written < 2:
            time.sleep(0.01)
    shown = capsys.readouterr().err
    assert shown.count("    1.50 s ") == shown.count("\n") >= 2
    assert "\x1b" not in shown


def test_modes_not_begun_are_distinguished_from_ended_ones() -> None:
    recorder = Recorder(communications=False)
    groups = [ModeGroup(name, {f"Main.{name}": name}, ()) for name in ("align", "servo", "home")]
    progress = Progress(recorder, groups)
    recorder.process_started(0, "Main.align", "Align")
    recorder.process_ended(0, "Main.align")
    recorder.process_started(0, "Main.servo", "Servo")
    assert progress.line().endswith("align: ended  servo: servo  home: not begun")
    recorder.process_ended(1, "Main.servo")
    recorder.process_started(1, "Main.home", "Home")
    assert progress.line().endswith("align: ended  servo: ended  home: home")


def test_of_many_groups_the_first_are_shown() -> None:
    groups = [ModeGroup(f"feed[{number}]", {f"Main.feed[{number}]": "feed"}, ()) for number in range(300)]
    line = Progress(Recorder(communications=False), groups).line()
    assert line.endswith("feed[7]: not begun  and 292 more")
    assert len(line) < 300


ENDLESS = "process Main {\n  composition { mu wait 1 ms }\n}\nenvironment E for Main {}\n"
STUCK = "process Main {\n  composition { stop }\n}\nenvironment E for Main {}\n"


@pytest.mark.parametrize(("text", "is_reported"), [(ENDLESS, True), (STUCK, True), (ENDLESS.replace("mu ", ""), False)])
def test_a_run_that_never_ends_says_so_after_a_while(
    text: str, is_reported: bool, capsys: pytest.CaptureFixture[str]
) -> None:
    network = pipeline.build(SourceFile(name="main.csp", text=text), read_source).network
    assert network is not None
    with EndlessRun(network, patience=0) as run:
        run.attach()
        if run.thread.ident is not None:
            run.thread.join()
    assert ("Main never ends by itself: Ctrl-C ends the run" in capsys.readouterr().err) == is_reported


def test_a_run_that_ends_soon_does_not_say_that_it_never_ends(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "main.csp"
    path.write_text(STUCK)
    assert main(["run", str(path)]) == 1
    shown = capsys.readouterr().err
    assert "deadlock at 0 s" in shown
    assert "never ends" not in shown


@pytest.mark.parametrize(
    ("composition", "is_endless"),
    [
        ("mu a ? x", True),
        ("mu a ? x until x > 3", False),
        ("(mu wait 1 ms) || a ? x", True),
        ("a ? x ; stop", True),
        ("inner", True),
        ("mu (skip -> inner [] a ? x -> skip)", True),
        ("skip -> inner [] a ? x -> skip", False),
        ("inner interrupt a ? x -> skip", False),
        ("inner catch Timeout -> skip", False),
        ("inner catch Timeout -> stop", True),
        ("(mu raise Enough) catch Enough -> inner", False),
        ("if x > 3 then inner", False),
        ("while x < 3 do inner", False),
    ],
)
def test_programs_that_never_end_by_themselves(composition: str, is_endless: bool) -> None:
    text = f"""
    exception Enough
    process Inner {{ composition {{ mu wait 1 ms }} }}
    process Main {{
      in a : int
      communication {{
        {"inner : Inner" if "inner" in composition else ""}
        var x : int = 0
      }}
      composition {{ {composition} }}
    }}
    """
    built = pipeline.build(SourceFile(name="main.csp", text=text), read_source)
    if built.network is None:
        pytest.fail("\n".join(str(found) for found in built.checked.report.diagnostics))
    assert never_ends(built.network) == is_endless
