"""``cspdiag verify`` and ``cspdiag run --replay``: the output, its stream and the exit code."""

from __future__ import annotations

import json
import re
from pathlib import Path
from xml.etree import ElementTree

import pytest

from cspdiag.base.manual import manual_page
from cspdiag.proofs.diagnostics.answers import CanDeadlock, NotProved
from tests.cli.conftest import BAD, Command

PAGE = manual_page(CanDeadlock.code)


@pytest.fixture(autouse=True)
def own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A cache of answers that is not shared with other tests."""
    cache = tmp_path / "cache"
    monkeypatch.setenv("XDG_CACHE_HOME", str(cache))
    return cache


@pytest.fixture
def refuted(tmp_path: Path) -> Path:
    path = tmp_path / "both.csp"
    path.write_text(PAGE.refused)
    return path


@pytest.fixture
def proved(tmp_path: Path) -> Path:
    path = tmp_path / "fixed.csp"
    path.write_text(PAGE.fixed)
    return path


def test_a_proof_ends_with_0_and_says_how_it_was_made(cspdiag: Command, proved: Path) -> None:
    result = cspdiag("verify", proved)
    assert (result.code, result.out) == (0, "")
    assert result.err.startswith("PROVED   Both deadlock free  (")
    assert "no deadlock and no knot" in result.err
    assert "1 assertion: 1 proved in " in result.err
    assert cspdiag("verify", proved, "--quiet") == (0, "", "")


def test_a_refutation_ends_with_1_and_shows_the_waiting_processes(cspdiag: Command, refuted: Path) -> None:
    result = cspdiag("verify", refuted)
    assert (result.code, result.out) == (1, "")
    assert "REFUTED  Both deadlock free" in result.err
    assert "error[E1101]: `Both` can deadlock" in result.err
    assert f"`first` waits to read second.reply ({refuted}:7), for `second`" in result.err
    assert "The program itself was stepped through this." in result.err


def test_an_unknown_answer_ends_with_1_too(cspdiag: Command, tmp_path: Path) -> None:
    path = tmp_path / "open.csp"
    path.write_text(manual_page(NotProved.code).refused)
    result = cspdiag("verify", path)
    assert result.code == 1
    assert "UNKNOWN  Waits deadlock free" in result.err
    assert "`count < 0` in `Waits` may hold or not" in result.err


@pytest.mark.parametrize("limit", [("--time-limit", "0.000001"), ("--memory-limit", "0.000001")])
def test_a_limit_that_is_reached_leaves_the_answer_unknown(
    cspdiag: Command, refuted: Path, limit: tuple[str, str]
) -> None:
    result = cspdiag("verify", refuted, "--method", "breadth-first", *limit)
    assert result.code == 1
    assert "UNKNOWN" in result.err
    assert "limit of" in result.err


def test_programs_with_errors_are_not_proved(cspdiag: Command, tmp_path: Path) -> None:
    path = tmp_path / "bad.csp"
    path.write_text(BAD)
    result = cspdiag("verify", path)
    assert (result.code, result.out) == (1, "")
    assert "error[E" in result.err


def test_of_a_process_without_the_value_of_a_parameter_nothing_is_known(cspdiag: Command, tmp_path: Path) -> None:
    path = tmp_path / "blink.csp"
    path.write_text(
        f"{manual_page('E1108').refused}\nprocess Idle {{ composition {{ skip }} }}\nassert Idle terminates\n"
    )
    result = cspdiag("verify", str(path))
    assert (result.code, result.out) == (1, "")
    assert "error[E1108]: `Blink` has no value for its parameter `times`, so nothing can be proved of it" in result.err
    assert f"{path}:11:1" in result.err
    assert "cspdiag verify --set times=..." in result.err
    assert "2 assertions: 1 proved, 1 unknown" in result.err
    assert cspdiag("verify", "--set", "times=2", str(path)).code == 0


@pytest.mark.parametrize("format_", ["concise", "json", "sarif", "github", "junit"])
@pytest.mark.parametrize("options", [[], ["--timing"]])
def test_errors_are_reported_in_the_requested_format(
    cspdiag: Command, tmp_path: Path, format_: str, options: list[str]
) -> None:
    path = tmp_path / "bad.csp"
    path.write_text(BAD)
    reported = cspdiag("verify", *options, path, "--format", format_)
    assert reported == cspdiag("check", path, "--format", format_)
    assert "error" in reported.out + reported.err


def test_warnings_are_printed_with_what_is_not_proved(cspdiag: Command, refuted: Path) -> None:
    refuted.write_text(PAGE.refused.replace("communication {", "communication { var idle : int = 0", 1))
    (run,) = json.loads(cspdiag("verify", refuted, "--format", "sarif").out)["runs"]
    assert [result["ruleId"] for result in run["results"]] == ["W0511", "E1101"]
    junit = cspdiag("verify", refuted, "--format", "junit")
    assert "W0511" in junit.err
    assert ElementTree.fromstring(junit.out)[0].get("failures") == "1"


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        (["--process", "Nobody"], "there is no process `Nobody`"),
        (["--time-limit", "-1"], "expected a positive number, not '-1'"),
        (["--engine", "spin", "--method", "rules"], "--method is for the prover of cspdiag"),
        (["--time-limit", "nan"], "expected a positive number, not 'nan'"),
        (["--time-limit", "1_0"], "expected a positive number, not '1_0'"),
        (["--time-limit", "1e300"], "expected 1e-06 to 1e+06 seconds, not '1e300'"),
        (["--memory-limit", "1e400"], "expected a positive number, not '1e400'"),
        (["--memory-limit", "1e300"], "expected 1e-06 to 1e+09 megabytes, not '1e300'"),
        (["--memory-limit", "1e-9"], "expected 1e-06 to 1e+09 megabytes, not '1e-9'"),
        (["--time-limit", "soon"], "expected a positive number, not 'soon'"),
        (["--set", "seats"], "a setting is NAME=VALUE"),
        (["--trace-out", "nowhere/trace.json"], "there is no folder nowhere"),
        (["--method", "luck"], "invalid choice"),
    ],
)
def test_wrong_usage_ends_with_2(cspdiag: Command, refuted: Path, options: list[str], reason: str) -> None:
    result = cspdiag("verify", refuted, *options)
    assert (result.code, result.out) == (2, "")
    assert reason in result.err
    assert result.err.count("\n") == 1


LIBRARIES = {
    "has no process": "submodel Twice {\n  in u : double\n  out y : double\n\n  y = 2 * u\n}\n",
    "no value for its parameter `n`": "process Sends(n: int) {\n  out y : int\n\n  composition { y ! n }\n}\n",
}


@pytest.mark.parametrize("reason", LIBRARIES)
def test_there_is_nothing_to_verify_in_a_library(cspdiag: Command, tmp_path: Path, reason: str) -> None:
    path = tmp_path / "library.csp"
    path.write_text(LIBRARIES[reason])
    first, again = cspdiag("verify", path), cspdiag("verify", path)
    assert (first.code, first.out) == (0, "")
    assert re.fullmatch(f"cspdiag: nothing to verify: .*{reason}.*\n", first.err)
    assert again == first
    assert cspdiag("verify", "--quiet", path) == (0, "", "")
    for format_ in ("concise", "json", "sarif", "github", "junit"):
        done = cspdiag("verify", "--format", format_, path)
        assert (done.code, done.err) == (0, first.err)
    assert json.loads(cspdiag("verify", "--format", "json", path).out) == []
    assert ElementTree.fromstring(cspdiag("verify", "--format", "junit", path).out)[0].get("tests") == "0"
    assert cspdiag("verify", "--set", "m=1", path).code == 2
    assert cspdiag("verify", "--process", "Sends", path).code == 2


def test_without_assertions_freedom_from_deadlock_and_livelock_is_checked(cspdiag: Command, tmp_path: Path) -> None:
    path = tmp_path / "ticks.csp"
    path.write_text("process Ticks {\n  out tick : bool\n\n  composition { mu (tick ! true ; wait 1 s) }\n}\n")
    result = cspdiag("verify", path)
    assert result.code == 0
    assert "PROVED   Ticks deadlock free" in result.err
    assert "PROVED   Ticks livelock free" in result.err
    assert "2 properties: 2 proved" in result.err
    assert "(breadth-first, 2 states, " in cspdiag("verify", "--method", "breadth-first", path).err
    path.write_text("process Waits { composition { mu wait 1 s } }\nassert Waits deadlock free\n")
    assert "(breadth-first, 1 state, " in cspdiag("verify", "--method", "breadth-first", path).err


@pytest.mark.parametrize(
    ("body", "code", "reason"),
    [
        (None, 2, "body.py: no such file"),
        ("", 1, "body.py has no class `Own`"),
        ("class Own:\n    pass\n\n\nraise LookupError('broken')\n", 1, "body.py:5: LookupError: broken"),
    ],
)
def test_missing_hand_written_bodies(
    cspdiag: Command, tmp_path: Path, body: str | None, code: int, reason: str
) -> None:
    path = tmp_path / "whole.csp"
    path.write_text(
        'process Own python "body.py:Own" {\n  in a : int\n}\n\n'
        "process Whole {\n  communication {\n    own : Own\n    channel c : int\n\n    c -> own.a\n  }\n\n"
        "  composition { own || (c ! 1 ; c ! 2) }\n}\n\nassert Whole deadlock free\n"
    )
    if body is not None:
        (tmp_path / "body.py").write_text(body)
    result = cspdiag("verify", path)
    assert result.code == code, result.err
    assert reason in result.err
    assert result.err.count("\n") == 1


def test_only_what_is_asserted_of_a_process(cspdiag: Command, proved: Path) -> None:
    result = cspdiag("verify", proved, "--process", "First")
    assert "First deadlock free" in result.err
    assert "Both" not in result.err


def test_json_has_everything(cspdiag: Command, refuted: Path) -> None:
    result = cspdiag("verify", refuted, "--format", "json")
    assert result.err == ""
    (answer,) = json.loads(result.out)
    assert (answer["verdict"], answer["code"], answer["assertion"]) == ("refuted", "E1101", "Both deadlock free")
    assert (answer["line"], answer["replayed"]) == (31, True)
    assert answer["counterexample"]["ring"] == ["first", "second"]
    assert [entry["line"] for entry in answer["counterexample"]["waiting"]] == [7, 16]
    assert answer["suggestions"][0]["replacement"] == "ask ! 1 ; reply ? value"


def test_json_is_also_written_to_a_file(cspdiag: Command, refuted: Path, tmp_path: Path) -> None:
    written = tmp_path / "answers.json"
    first = cspdiag("verify", refuted, "--json", written)
    assert "REFUTED  Both deadlock free" in first.err
    assert f"wrote {written}" in first.err
    assert json.loads(written.read_text())[0]["verdict"] == "refuted"
    text = written.read_text()
    written.unlink()
    assert cspdiag("verify", refuted, "--json", written) == first
    assert written.read_text() == text
    again = json.loads(cspdiag("verify", refuted, "--format", "json").out)
    assert [each["counterexample"] for each in again] == [each["counterexample"] for each in json.loads(text)]


def test_errors_are_written_to_that_file_too(cspdiag: Command, tmp_path: Path) -> None:
    path, written = tmp_path / "bad.csp", tmp_path / "answers.json"
    path.write_text(BAD)
    assert cspdiag("verify", path, "--json", written).code == 1
    assert written.read_text() == cspdiag("check", path, "--format", "json").out


def test_junit_has_a_test_for_each_assertion(cspdiag: Command, refuted: Path, proved: Path) -> None:
    suite = ElementTree.fromstring(cspdiag("verify", refuted, "--format", "junit").out)[0]
    assert (suite.get("tests"), suite.get("failures"), suite.get("errors")) == ("1", "1", "0")
    assert suite[0].get("name") == "assert Both deadlock free"
    failure = suite[0].find("failure")
    assert failure is not None
    assert "`first` waits to read second.reply" in str(failure.text)
    suite = ElementTree.fromstring(cspdiag("verify", proved, "--format", "junit").out)[0]
    assert (suite.get("tests"), suite.get("failures")) == ("1", "0")


@pytest.mark.parametrize(
    ("format_", "for_people"),
    [("text", True), ("concise", True), ("json", False), ("sarif", False), ("github", False), ("junit", False)],
)
def test_what_is_for_people_goes_to_standard_error_and_the_rest_to_standard_output(
    cspdiag: Command, refuted: Path, format_: str, for_people: bool
) -> None:
    result = cspdiag("verify", refuted, "--format", format_)
    reported, silent = (result.err, result.out) if for_people else (result.out, result.err)
    assert "Both" in reported
    assert silent == ""


def test_sarif_github_and_concise_tell_what_is_not_proved(cspdiag: Command, refuted: Path, proved: Path) -> None:
    (run,) = json.loads(cspdiag("verify", refuted, "--format", "sarif").out)["runs"]
    assert [result["ruleId"] for result in run["results"]] == ["E1101"]
    assert cspdiag("verify", refuted, "--format", "github").out.startswith(f"::error file={refuted},line=31")
    assert cspdiag("verify", refuted, "--format", "concise").err.startswith(f"{refuted}:31:1: error[E1101] `Both` can")
    (run,) = json.loads(cspdiag("verify", proved, "--format", "sarif").out)["runs"]
    assert run["results"] == []


def test_an_unchanged_program_is_not_proved_again(
    cspdiag: Command, refuted: Path, own_cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    first = cspdiag("verify", refuted)
    assert len(list(own_cache.rglob("*.json"))) == 1
    monkeypatch.setattr("cspdiag.verify.confirm.Verifier.answer", _never)
    assert cspdiag("verify", refuted) == first
    refuted.write_text(PAGE.refused.replace("ask ! 1", "ask ! 7"))
    assert cspdiag("verify", refuted).code == 3
    refuted.write_text(PAGE.refused)
    assert cspdiag("verify", refuted, "--no-cache").code == 3


def test_a_program_is_proved_again_when_a_body_has_changed(
    cspdiag: Command, refuted: Path, own_cache: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    refuted.write_text(f'{PAGE.refused}submodel Law python "law.py:Law" {{ in a : double out b : double }}\n')
    first = cspdiag("verify", refuted)
    monkeypatch.setattr("cspdiag.verify.confirm.Verifier.answer", _never)
    assert cspdiag("verify", refuted) == first
    (refuted.parent / "law.py").write_text("class Law: pass")
    assert cspdiag("verify", refuted).code == 3


def _never(*_: object) -> None:
    raise AssertionError("asked again")


def test_a_damaged_cache_is_ignored(cspdiag: Command, refuted: Path, own_cache: Path) -> None:
    first = cspdiag("verify", refuted)
    (kept,) = own_cache.rglob("*.json")
    kept.write_text('{"files": [')
    assert cspdiag("verify", refuted).code == first.code
    kept.unlink()
    kept.mkdir()
    assert cspdiag("verify", refuted).code == first.code


def test_an_unwritable_cache_is_ignored(
    cspdiag: Command, refuted: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    no_folder = tmp_path / "file"
    no_folder.write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(no_folder))
    result = cspdiag("verify", refuted)
    assert result.code == 1
    assert result.err.startswith("REFUTED")


def test_the_trace_is_replayed_by_run(cspdiag: Command, refuted: Path, proved: Path, tmp_path: Path) -> None:
    trace = tmp_path / "trace.json"
    reported = cspdiag("verify", refuted, "--trace-out", trace)
    assert reported.code == 1
    assert reported.err.endswith(f"\nwrote {trace}\n")
    replay = cspdiag("run", refuted, "--replay", trace)
    assert replay.code == 0
    assert "deadlock at 0 s: 2 processes wait for each other" in replay.err
    assert ":7), for `second`" in replay.err, "the line at which it waits"
    assert replay.err.endswith("replayed: the program did what the trace says\n")
    other = cspdiag("run", proved, "--replay", trace)
    assert other.code == 1
    assert "\nnot replayed: " in other.err
    assert cspdiag("run", proved, "--replay", trace, "--quiet") == (1, "", "")


ONE_MORE = """
process Main {
  out y : bool

  communication {
    var x : double = 16777216
  }

  composition {
    mu (if x + 1 > x then y ! true else stop)
  }
}

assert Main deadlock free
"""


def test_a_trace_is_replayed_in_the_precision_that_it_was_made_with(cspdiag: Command, tmp_path: Path) -> None:
    program, trace = tmp_path / "one_more.csp", tmp_path / "trace.json"
    program.write_text(ONE_MORE)
    assert cspdiag("verify", program).code == 0
    assert cspdiag("verify", program, "--real", "float32", "--trace-out", trace).code == 1
    assert cspdiag("run", program, "--replay", trace).code == 0
    other = cspdiag("run", program, "--replay", trace, "--real", "double")
    assert other.code == 1
    assert other.err.endswith("  --real is double; the trace was made with float32\n")
    trace.write_text(trace.read_text().replace('"real": "float32"', '"real": "float16"'))
    refused = cspdiag("run", program, "--replay", trace)
    assert refused.code == 2
    assert "an incomplete trace (TypeError: `real` is double or float32, not 'float16')" in refused.err


TABLE = """
const table : int[2] = [1, 1]
process A(n: int = 0) {
  out c : int
  communication { var i : int = 0 }
  composition { (mu (i := i + 1 ; c ! i) until i >= table[0] + n) ; c ! 0 }
}
process B { in c : int communication { var v : int } composition { (c ? v ; c ? v ; c ? v) } }
process Main { communication { a : A b : B a.c -> b.c } composition { a || b } }
assert Main deadlock free
"""


@pytest.mark.parametrize(
    ("made", "replayed", "reason"),
    [
        ("table[0]=1", "table[0]=1", "\nreplayed: the program did"),
        ("table=[1, 5]", None, "\nreplayed: the program did"),
        ("table[0]=1", "table[0]=2", "not replayed: "),
        ("a.n=0", "a.n=1", "not replayed: "),
        ("table[0]=1", "table[1]=7", "\nreplayed: the program did"),
        ("table=[1, 5]", "table[0]=2", "table[0] is set twice: by itself and as a part of table"),
        ("table[0]=1", "table=[2, 2]", "table[0] is set twice: by itself and as a part of table"),
        ("a.n=0", "Main.a.n=1", "a.n is set twice: as a.n and as Main.a.n"),
    ],
)
def test_settings_of_a_replay_replace_those_of_the_trace(
    cspdiag: Command, tmp_path: Path, made: str, replayed: str | None, reason: str
) -> None:
    path, trace = tmp_path / "table.csp", tmp_path / "trace.json"
    path.write_text(TABLE)
    assert cspdiag("verify", path, "--set", made, "--trace-out", trace).code == 1
    result = cspdiag("run", path, "--replay", trace, *(() if replayed is None else ("--set", replayed)))
    assert reason in result.err
    if "set twice" in reason:
        assert result.code == 2
        assert result.err.endswith(f" ({trace} has the settings {made})\n")


def test_nothing_is_written_where_nothing_was_refuted(cspdiag: Command, proved: Path, tmp_path: Path) -> None:
    result = cspdiag("verify", proved, "--trace-out", tmp_path / "trace.json")
    assert result.code == 0
    assert "nothing was refuted" in result.err
    assert not (tmp_path / "trace.json").exists()


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("[", "not JSON"),
        ("[" * 5000 + "]" * 5000, "not JSON: nested too deeply"),
        ("[]", "not a trace written by `cspdiag verify --trace-out`"),
        ('{"format": "cspdiag trace 1"}', "an incomplete trace (KeyError: 'process')"),
    ],
)
def test_a_file_that_is_not_a_trace(cspdiag: Command, refuted: Path, tmp_path: Path, text: str, reason: str) -> None:
    trace = tmp_path / "trace.json"
    trace.write_text(text)
    result = cspdiag("run", refuted, "--replay", trace)
    assert result.code == 2
    assert reason in result.err


def test_a_replay_goes_without_what_a_trace_decides(cspdiag: Command, refuted: Path, tmp_path: Path) -> None:
    result = cspdiag("run", refuted, "--replay", tmp_path / "trace.json", "--for", "1s", "--plot", "a.svg")
    assert result.code == 2
    assert "--replay cannot be combined with --for, --plot" in result.err


@pytest.mark.parametrize(("target", "ending"), [("promela", ".pml"), ("cspm", ".csp")])
def test_models_for_other_tools_are_written(
    cspdiag: Command, refuted: Path, tmp_path: Path, target: str, ending: str
) -> None:
    assert cspdiag("compile", refuted, "--target", target, "-o", tmp_path / "out").code == 0
    assert (tmp_path / "out" / "both" / f"both{ending}").read_text()


CHECKED = """enum Part { good, bad }

process Belt {
  in  arrived : Part
  out ready   : Part
  out taken   : bool

  communication { var part : Part = Part.good }

  composition { arrived ? part ; ready ! part ; taken ! true ; (if part == Part.bad then stop) }
}

assert Belt deadlock free
assert Belt terminates
"""


def test_values_are_reported_in_the_words_of_the_text(cspdiag: Command, tmp_path: Path) -> None:
    program, trace = tmp_path / "belt.csp", tmp_path / "trace.json"
    program.write_text(CHECKED)
    result = cspdiag("verify", program, "--trace-out", trace)
    assert "arrived Part.bad" in result.err
    reported = cspdiag("run", program, "--replay", trace).err
    assert "arrived  Part.bad" in reported
    assert "ready  Part.bad" in reported
    assert "taken  true" in reported


ENDED = """process P {
  communication { channel c : int
    var v : int = 0 }
  composition { (c ! 1 ; c ! 2) || (c ? v) || (mu wait 1 ms) }
}
assert P deadlock free
"""
INTERRUPTED = """process P {
  in e : int
  communication {
    channel c : int
    channel d : int
    var v : int = 0
    var w : int = 0
    var y : int = 0
  }
  composition {
    (mu (c ! 1 ; d ? w) interrupt e ? y -> (c ! -1))
    || (mu (c ? v ; d ! v) until v < 0)
  }
}
assert P deadlock free
"""
LABELLED = """process A {
  out o : int
  composition { o ! 1 }
}
process P {
  communication {
    channel c : int
    channel d : int
    a : A
    a.o -> c
    var v : int = 0
  }
  composition { (wait 1 ms || wait 2 ms) ; ((a ; d ! 1 ; d ! 2) || (c ? v ; d ? v) || (mu wait 2 ms)) }
}
assert P deadlock free
"""


def waiting_lines(reported: str) -> list[str]:
    """Which process waits for what, and where, without the folder of the file."""
    return [
        f"{waiting}{file}"
        for waiting, file in re.findall(r"^  (`.*` waits to .* \()(?:.*/)?(.*:\d+\))", reported, re.MULTILINE)
    ]


NESTED = ENDED.replace("(c ! 1 ; c ! 2) ||", "(wait 1 ms || wait 2 ms) || (c ! 1 ; c ! 2) ||")


@pytest.mark.parametrize("text", [ENDED, INTERRUPTED, LABELLED, NESTED])
def test_a_replay_names_the_waiting_processes_as_the_proof_does(cspdiag: Command, tmp_path: Path, text: str) -> None:
    program, trace = tmp_path / "case.csp", tmp_path / "trace.json"
    program.write_text(text)
    proof = waiting_lines(cspdiag("verify", program, "--trace-out", trace).err)
    replay = cspdiag("run", program, "--replay", trace)
    assert replay.code == 0
    assert proof
    assert waiting_lines(replay.err) == proof


def test_a_replay_counts_the_steps_that_the_proof_reports(cspdiag: Command, tmp_path: Path) -> None:
    program, trace = tmp_path / "case.csp", tmp_path / "trace.json"
    program.write_text(LABELLED)
    assert "get stuck: after 4 steps, " in cspdiag("verify", program, "--trace-out", trace).err
    assert cspdiag("run", program, "--replay", trace).err.endswith("did all 4 steps\n")


def test_a_replay_reports_the_delays_of_other_processes(cspdiag: Command, tmp_path: Path) -> None:
    program, trace = tmp_path / "case.csp", tmp_path / "trace.json"
    program.write_text(ENDED)
    cspdiag("verify", program, "--trace-out", trace)
    assert re.search(r"  `3` waits until 1 ms \(.*case.csp:4\)\n", cspdiag("run", program, "--replay", trace).err)


ROUNDS = """process Main {
  in go : int

  communication {
    var t : int = 0
    var u : int = 0

    channel c : int sync
    channel d : int sync
  }

  composition { go ? t ; ROUND }
}

assert Main livelock free
"""


@pytest.mark.parametrize(
    ("composition", "lines"),
    [
        (
            "((c ! 1 ; mu (d ? t ; c ! t)) || mu (c ? u ; d ! u))",
            [
                "    1  go  0",
                "    2  c  1",
                "then again and again:",
                "    3  d  1",
                "    4  c  1",
                "replayed: the program did all 4 steps, and can repeat this forever",
            ],
        ),
        (
            "mu wait u * 1 ms",
            [
                "    1  go  0",
                "then again and again, without a communication: `wait u * 1 ms` of `Main`",
                "replayed: the program did all 2 steps, and can repeat this forever",
            ],
        ),
        (
            "mu (skip -> skip [] skip -> u := 1) until u == 1",
            [
                "    1  go  0",
                "then again and again, without a communication or a delay: `Main`",
                "replayed: the program did the one step, and can repeat this forever",
            ],
        ),
    ],
)
def test_a_replay_says_what_is_repeated(cspdiag: Command, tmp_path: Path, composition: str, lines: list[str]) -> None:
    file, trace = tmp_path / "rounds.csp", tmp_path / "trace.json"
    file.write_text(ROUNDS.replace("ROUND", composition))
    reported = cspdiag("verify", file, "--trace-out", trace)
    assert "then again and again" in reported.err
    replay = cspdiag("run", file, "--replay", trace)
    assert replay.code == 0
    assert replay.err.splitlines()[-len(lines) :] == lines


@pytest.mark.parametrize(
    ("ports", "composition", "lines"),
    [
        (
            "",
            "wait 1 ms ; (mu (c ! 1 ; wait 2 ms) || mu (c ? t ; wait 2 ms))",
            [
                "then again and again, every 2 ms:",
                "    1  1 ms  c  1",
                "replayed: the program did all 4 steps, and can repeat this forever",
            ],
        ),
        (
            "",
            "mu (c ! 1 ; wait 2 ms) || mu (c ? t ; wait 2 ms)",
            [
                "then again and again, every 2 ms:",
                "    1  0 s  c  1",
                "replayed: the program did all 3 steps, and can repeat this forever",
            ],
        ),
        (
            "out o : int",
            "mu (c ! 1 -> skip []> after 2 ms -> o ! 2) || (c ? t ; c ? t)",
            [
                "    1   0 s  c  1",
                "    2   0 s  c  1",
                "then again and again, every 2 ms:",
                "    3  2 ms  o  2",
                "replayed: the program did all 4 steps, and can repeat this forever",
            ],
        ),
        (
            "in i : int @ 2 ms  in j : int @ 3 ms",
            "(mu i ? t) || (mu j ? u)",
            [
                "then again and again, 3 rounds in 6 ms:",
                "    1  2 ms  i  0",
                "replayed: the program did the one step, and can repeat this forever",
            ],
        ),
    ],
)
def test_a_replay_reports_the_instants_of_repeated_steps(
    cspdiag: Command, tmp_path: Path, ports: str, composition: str, lines: list[str]
) -> None:
    file, trace = tmp_path / "rounds.csp", tmp_path / "trace.json"
    file.write_text(
        f"process Main {{ {ports} communication {{ var t : int = 0  var u : int = 0  channel c : int sync }}\n"
        f"  composition {{ {composition} }} }}\nassert Main terminates\n"
    )
    assert cspdiag("verify", file, "--trace-out", trace).code == 1
    replay = cspdiag("run", file, "--replay", trace)
    assert replay.code == 0
    assert replay.err.splitlines()[-len(lines) :] == lines


def test_a_loop_that_no_diagram_shows_is_found_in_the_text(cspdiag: Command, tmp_path: Path) -> None:
    file = tmp_path / "rounds.csp"
    file.write_text(ROUNDS.replace("ROUND", "mu (skip -> skip [] skip -> u := 1) until u == 1"))
    reported = cspdiag("verify", file).err
    assert f"then again and again, without a communication or a delay: `Main` ({file}:12)" in reported


@pytest.mark.parametrize(
    ("method", "reason"),
    [
        ("breadth-first", "no deadlock (the only reachable state is not deadlocked)"),
        ("stubborn", "no knot (in the only representative state no process is stuck)"),
    ],
)
def test_one_state_is_counted_as_one(cspdiag: Command, tmp_path: Path, method: str, reason: str) -> None:
    path = tmp_path / "one.csp"
    path.write_text(
        "process Q { in e : int communication { var v : int } composition { mu e ? v } }\n"
        "assert Q deadlock free\nassert Q refines Q\n"
    )
    reported = cspdiag("verify", path, "--method", method).err
    assert reason in reported
    assert "every trace in the only reachable state is one of the specification" in reported
    assert not re.search(r"\b1 \w*\s?states\b", reported)


def test_of_many_processes_that_wait_the_first_and_last_are_shown(cspdiag: Command, tmp_path: Path) -> None:
    path = tmp_path / "ring.csp"
    path.write_text(
        "process Node {\n  in left : int\n  out right : int\n  communication {\n    var v : int = 0\n  }\n"
        "  composition {\n    mu (left ? v ; right ! v)\n  }\n}\n"
        "process Top {\n  communication {\n    n[40] : Node\n"
        "    for i < 40 { n[i].right -> n[(i + 1) % 40].left }\n  }\n  composition {\n    par i < 40 : n[i]\n  }\n}\n"
        "assert Top deadlock free\n"
    )
    ran = cspdiag("run", path).err
    assert "40 processes wait for each other" in ran
    assert "... 16 more ..." in ran
    assert ran.count(" waits to read ") == 24
    assert "Top.n[1] waits to read Top.n[0].right (ring.csp:8), for Top.n[0]" in ran
    assert "0 of 40 processes ended" in ran
    verified = cspdiag("verify", path).err
    assert "... 16 more ..." in verified
    assert f"`n[1]` waits to read n[0].right ({path}:8), for `n[0]`" in verified
