"""``run(tune=…)`` and ``Tuning``: parameters that change while a program runs."""

from __future__ import annotations

import threading

import pytest

import cspdiag

TEXT = """enum Mode { slow, fast }
parameter k : double = 1
parameter mode : Mode = Mode.slow
parameter row : int[2] = [1, 2]

process Main {
  out y : double
  out n : int
  composition { mu (y ! k ; n ! (if mode == Mode.fast then row[0] else row[1]) ; wait 10 ms) }
}

environment World for Main { y -> _  n -> _ }
"""
TUNE: dict[str | float, dict[str, str | int | float]] = {
    "20 ms": {"k": 2.5, "row[1]": 7},
    0.03: {"mode": "fast", "row[0]": 9},
}


@pytest.fixture(scope="module")
def program() -> cspdiag.LoadedProgram:
    return cspdiag.parse(TEXT)


@pytest.mark.parametrize("how", [{"level": 0}, {"level": 1}, {"level": "reference"}, {"target": "c"}], ids=str)
def test_changes_by_their_times(program: cspdiag.LoadedProgram, how: dict[str, object]) -> None:
    run = program.run(until="45 ms", tune=TUNE, **how)  # type: ignore[arg-type]
    assert run["y"].tolist()[:5] == [1, 1, 2.5, 2.5, 2.5]
    assert run["n"].tolist()[:5] == [2, 2, 7, 9, 9]
    assert [change[:3] for change in run.changes] == [
        (20_000_000, "k", ()),
        (20_000_000, "row", (1,)),
        (30_000_000, "mode", ()),
        (30_000_000, "row", (0,)),
    ]


@pytest.mark.parametrize("target", ["python", "c"])
def test_a_thread_changes_a_program_in_another(program: cspdiag.LoadedProgram, target: str) -> None:
    tuning = cspdiag.Tuning()
    with pytest.raises(cspdiag.SettingError, match="nothing runs yet"):
        tuning.set("k", 3)
    runs: list[cspdiag.Run] = []
    thread = threading.Thread(
        target=lambda: runs.append(program.run(until=0.6, real_time=True, target=target, tune=tuning))
    )
    thread.start()
    while thread.is_alive():
        try:
            tuning.set("k", 3)
            break
        except cspdiag.SettingError:
            thread.join(0.01)
    thread.join()
    assert runs[0]["y"][-2] == 3


def test_wrong_arguments(program: cspdiag.LoadedProgram) -> None:
    with pytest.raises(cspdiag.SettingError, match=r"there is no parameter 'q' of the program \(the parameters are k"):
        program.run(until=0.1, tune={0: {"q": 1}})
    with pytest.raises(TypeError, match="tune is a mapping from times to settings, or a Tuning, not list"):
        program.run(until=0.1, tune=[])  # type: ignore[arg-type]
    with pytest.raises(cspdiag.SettingError, match="a run cannot last -1 s"):
        program.run(until=0.1, tune={"-1 s": {"k": 1}})
    with pytest.raises(cspdiag.ArgumentError, match="`Tuning`"):
        program.run(until=0.1, tune=cspdiag.Tuning(), level="reference")
