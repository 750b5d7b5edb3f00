"""Processes that never continue: the greatest set of processes of which every possible partner is in the set or has
ended, in a state that a run has really reached.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from cspdiag.cli.main import main
from tests.support.verifying import answer_to

PLANT = """process Device {
  in command : int

  communication { var x : int = 0 }

  composition { DEVICE }
}

process Panel {
  out command : int

  composition { PANEL }
}

process Heart {
  composition { mu wait 1 ms }
}

process Plant {
  communication {
    device : Device
    panel  : Panel
    heart  : Heart

    panel.command -> device.command
  }

  composition { device || panel || heart }
}

assert Plant deadlock free
"""


def plant(device: str, panel: str) -> str:
    return PLANT.replace("DEVICE", device).replace("PANEL", panel)


LATE = plant(
    "command ? x ; wait 3 ms ; command ? x",
    "(command ! 1 -> skip [] after 2 ms -> (command ! 0 ; command ! 1)) ; command ! 2",
)
"""The device reads again after 3 ms."""
GONE = plant("command ? x ; wait 3 ms", "command ! 1 ; command ! 2")
"""The device does not read again."""


@pytest.mark.parametrize(
    ("text", "outcome"),
    [
        (LATE, "unknown"),
        (GONE, "refuted"),
        (plant("command ? x ; wait 3 ms ; command ? x", "command ! 1 ; command ! 2"), "proved"),
        (plant("command ? x ; stop", "command ! 1 ; command ! 2"), "refuted"),
        (plant("(command ? x) || mu wait 1 ms", "command ! 1 ; command ! 2"), "refuted"),
        (plant("(command ? x ; wait 1 ms) || mu wait 1 ms", "command ! 1 ; command ! 2"), "refuted"),
        (plant("mu (wait 1 ms ; command ? x) until x == 1 ; mu wait 1 ms", "command ! 1 ; command ! 2"), "proved"),
    ],
)
def test_a_partner_that_may_still_arrive_is_waited_for(text: str, outcome: str) -> None:
    """A process that runs on but never communicates is not in a knot: see the page on proofs."""
    answer = answer_to(text)
    assert (answer.outcome, answer.replayed) == (outcome, outcome == "refuted"), answer.reason
    assert not answer.suggestions or outcome == "refuted"


WAITS_THEN_READS = """process Main {
  communication {
    var x : int = 0
    channel c : int sync
  }
  composition { WRITER || (wait 1 ms ; READER) || (mu (wait 1 ms)) }
}
assert Main deadlock free
"""


@pytest.mark.parametrize("writer", ["(skip -> c ! 3 []> skip -> c ! 3)", "c ! 3"])
@pytest.mark.parametrize(
    "reader",
    [
        "((c ? x) interrupt after 2 ms -> skip)",
        "((wait 5 ms) interrupt after 2 ms -> c ? x)",
        "((raise Timeout) catch Timeout -> c ? x)",
        "(c ? x || skip)",
        "(skip -> c ? x [] after 1 ms -> c ? x)",
    ],
)
def test_a_partner_arrives_in_any_part_that_follows_its_wait(writer: str, reader: str) -> None:
    """In a branch, a body that may be interrupted, a handler."""
    answer = answer_to(WAITS_THEN_READS.replace("WRITER", writer).replace("READER", reader))
    assert answer.outcome != "refuted", answer.reason


def test_a_replay_reports_which_processes_are_stuck_and_when(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    program, trace = tmp_path / "plant.csp", tmp_path / "trace.json"
    program.write_text(GONE)
    main(["verify", str(program), "--no-cache", "--quiet", "--trace-out", str(trace)])
    capsys.readouterr()
    assert main(["run", str(program), "--replay", str(trace)]) == 0
    reported = capsys.readouterr().err
    assert "deadlock at" not in reported
    assert "stuck at 0 s" in reported
    assert (
        reported.index("`panel` waits to write panel.command")
        < reported.index("while others continue:")
        < reported.index("`heart` waits until")
    )


def test_a_process_abandoned_at_once_does_not_arrive() -> None:
    """The writer stops before it has written, so its reader waits forever."""
    text = """process Main {
      communication {
        var x : int = 0

        channel c : int sync
      }

      composition { ((c ! 1) interrupt skip -> stop) || c ? x || mu wait 1 ms }
    }

    assert Main deadlock free
    """
    answer = answer_to(text)
    assert (answer.outcome, answer.replayed) == ("refuted", True), answer.reason
