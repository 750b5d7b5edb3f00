"""Values that a native program reports are what the same program passes in Python, however they are read."""

from __future__ import annotations

import io
import shutil
import subprocess
from array import array
from pathlib import Path
from random import Random

import numpy
import pytest

import cspdiag
from cspdiag.base.sources import read_source
from cspdiag.network.ir.network import CoreNetwork
from cspdiag.simulate.native import run as native
from cspdiag.simulate.native.rows import SIZE, PassedRows
from cspdiag.simulate.native.stream import StreamReader
from cspdiag.simulate.record.files import csv_parts, write_npz
from cspdiag.simulate.record.recorder import Recorder
from cspdiag.simulate.result import Run

pytestmark = pytest.mark.skipif(not any(map(shutil.which, ("cc", "gcc", "clang"))), reason="there is no C compiler")

TYPES = """
enum Mode { idle, busy, done }
struct Inner {
  mode : Mode
  on   : bool
  n    : int8
}
struct Pose {
  x     : double
  at    : double[2]
  inner : Inner[3]
  f     : float
}

process Main {
  in  pose   : Pose      @ 3 ms
  in  volts  : float<V>  @ 2 ms
  in  count  : uint8     @ 2 ms
  in  length : time      @ 4 ms
  in  mode   : Mode
  in  on     : bool      @ 5 ms
  out copied : Pose
  out flags  : bool[3]   @ 2 ms
  out words  : uint32    @ 2 ms
  out shown  : Mode      @ 7 ms
  out many   : int16[40]

  communication {
    var p : Pose
    var v : float<V> = 0
    var c : uint8 = 0
    var l : time = 0 s
    var m : Mode = Mode.idle
    var b : bool = false
  }

  composition {
    seq i < 20 : (
      pose ? p ; copied ! p ; (volts ? v || count ? c) ; flags ! [b, not b, v > 1<V>] ; words ! uint32(c) ;
      (mode ? m -> skip [] after 1 ms -> skip) ; shown ! m ; on ? b ; length ? l ;
      many ! [MANY]
    )
  }
}

submodel Plant {
  out pose   : Pose
  out volts  : float<V>
  out count  : uint8
  out length : time
  out mode   : Mode
  out on     : bool
  in copied  : Pose
  in flags   : bool[3]
  in words   : uint32
  in shown   : Mode
  in many    : int16[40]

  state n : int = 0
  next n = n + 1
  pose = Pose(
    x = double(n) / 3, at = [double(n), -0.0], f = float(double(n) / 7),
    inner = [
      Inner(mode = if n % 2 == 0 then Mode.busy else Mode.done, on = n % 3 == 0, n = int8(n % 100)),
      Inner(mode = Mode.idle, on = flags[0], n = 1), Inner(mode = Mode.busy, on = true, n = -3)
    ]
  )
  volts = float(double(n) / 11 * 1<V>)
  count = uint8(n % 256)
  length = n * 1 us
  mode = if n % 50 > 20 then Mode.done else Mode.idle
  on = n % 7 > 3
}

environment Bench for Main on miss count step 1 ms {
  plant : Plant
  plant.pose -> pose plant.volts -> volts plant.count -> count plant.length -> length plant.mode -> mode
  plant.on -> on
  copied -> plant.copied flags -> plant.flags words -> plant.words shown -> plant.shown many -> plant.many
}
""".replace("MANY", ", ".join(["int16(c)"] * 40))


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> cspdiag.LoadedProgram:
    path = tmp_path_factory.mktemp("rows") / "types.csp"
    path.write_text(TYPES)
    return cspdiag.load(str(path))


@pytest.fixture(scope="module")
def in_python(program: cspdiag.LoadedProgram) -> Run:
    return program.run(level=0)


@pytest.fixture(scope="module")
def reported(program: cspdiag.LoadedProgram) -> bytes:
    """The records of a run of the native program."""
    built = native.build_program(program.network, read_source, options=("-O0",))
    return subprocess.run([built.path, "--observe", "all"], stdout=subprocess.PIPE, check=True).stdout


def arrays(run: Run) -> dict[str, tuple[str, list[object]]]:
    file = io.BytesIO()
    write_npz(run, file)
    file.seek(0)
    with numpy.load(file, allow_pickle=False) as archive:
        return {name: (str(value.dtype), value.tolist()) for name, value in archive.items()}


@pytest.mark.parametrize("observed", ["signals", "ports", "all"])
def test_a_recording_is_the_same_whatever_else_is_reported(
    program: cspdiag.LoadedProgram, in_python: Run, observed: native.Observed
) -> None:
    run = native.simulate(program.network, read_source, observed=observed, options=("-O0",))
    assert "".join(csv_parts(run)) == "".join(csv_parts(in_python))
    assert str(arrays(run)) == str(arrays(in_python))
    assert run.releases == [
        (time, channel, run.releases[position][2]) for position, (time, channel, _) in enumerate(in_python.releases)
    ]
    if observed == "signals":
        assert list(run.communications) == []
    else:
        assert [passed.writer for passed in run.communications] == [
            passed.writer for passed in in_python.communications
        ]
        assert run.unread("pose") == in_python.unread("pose")


class Pieces(io.BufferedIOBase):
    """A stream of which a little is available at a time."""

    def __init__(self, data: bytes, seed: int, longest: int) -> None:
        self._rest = data
        self._random = Random(seed)
        self._longest = longest

    def read1(self, _: int = -1) -> bytes:
        size = self._random.randint(1, self._longest)
        found, self._rest = self._rest[:size], self._rest[size:]
        return found


def read(network: CoreNetwork, stream: io.BufferedIOBase, *, keeps_order: bool = True) -> StreamReader:
    reader = StreamReader(stream, network, Recorder(), PassedRows(network, keeps_order=keeps_order))
    reader.read()
    return reader


def account(reader: StreamReader) -> str:
    passed = reader.passed
    assert passed is not None
    histories = {
        name: (own.time.tolist(), own.value.tolist(), own.read.tolist())  # type: ignore[union-attr]
        for name, own in passed.histories({}).items()
    }
    recorder = reader.recorder
    return repr(
        (list(passed.communications), histories, recorder.activities, recorder.releases, reader.end, reader.now)
    )


@pytest.mark.parametrize("keeps_order", [False, True])
@pytest.mark.parametrize(("seed", "longest"), [(1, 40), (2, 100), (3, 1000), (4, 5000)])
def test_records_may_arrive_in_any_pieces(
    program: cspdiag.LoadedProgram,
    reported: bytes,
    seed: int,
    longest: int,
    keeps_order: bool,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    whole = account(read(program.network, io.BytesIO(reported), keeps_order=keeps_order))
    monkeypatch.setattr("cspdiag.simulate.native.rows._SORTED_AT_ONCE", 700)
    assert account(read(program.network, Pieces(reported, seed, longest), keeps_order=keeps_order)) == whole


def test_a_stream_that_ends_in_the_middle_is_noticed(program: cspdiag.LoadedProgram, reported: bytes) -> None:
    values = next(
        position
        for position in range(0, len(reported), SIZE)
        if reported[position] == 3 and reported[position + SIZE] == 0
    )
    for end in (values + SIZE, len(reported) - SIZE, len(reported) - 1, 3):
        with pytest.raises(EOFError, match="in the middle of a record"):
            read(program.network, io.BytesIO(reported[:end]))


def test_a_program_that_ends_in_the_middle_has_failed(
    program: cspdiag.LoadedProgram, reported: bytes, tmp_path: Path
) -> None:
    (tmp_path / "reported").write_bytes(reported[: len(reported) // 2 // SIZE * SIZE + 5])
    broken = tmp_path / "broken"
    broken.write_text(f"#!/bin/sh\ncat {tmp_path}/reported\nexit 3\n")
    broken.chmod(0o755)
    built = native.NativeProgram(program.network, None, broken, real_time=False, flattened=False)
    with pytest.raises(cspdiag.CompilerError, match="the native program has failed: exit code 3"):
        built.run()


def test_without_order_only_histories_are_kept(program: cspdiag.LoadedProgram, reported: bytes) -> None:
    kept = read(program.network, io.BytesIO(reported)).passed
    sorted_ = read(program.network, io.BytesIO(reported), keeps_order=False).passed
    assert kept is not None
    assert sorted_ is not None
    assert list(sorted_.communications) == []
    assert repr(sorted_.histories({})) == repr(kept.histories({}))


def test_channels_are_in_the_order_of_their_first_communication(program: cspdiag.LoadedProgram, in_python: Run) -> None:
    network = cspdiag.load(str(Path(__file__).parents[3] / "models/jiwy/jiwy.csp")).network
    native_run = native.simulate(network, read_source, until=2_000_000_000, options=("-O0",))
    first = dict.fromkeys(passed.channel for passed in native_run.communications)
    internal = [name for name in native_run.signals if "." in name]
    assert internal == [name for name in first if name in internal]
    assert (
        native_run.signals["feedback_vertical"].time.tolist()
        == (numpy.array(array("q", range(1_000_000, 2_000_000_001, 1_000_000)), dtype=float) / 1e9).tolist()
    )


def test_values_of_more_than_64_kilobytes_are_recorded() -> None:
    text = """process Main { out x : double[8200] composition { x ! [ELEMENTS] } }
submodel World { in x : double[8200] }
environment Bench for Main { world : World x -> world.x }
""".replace("ELEMENTS", ", ".join(map(str, range(8200))))
    run = native.simulate(cspdiag.parse(text, "case.csp").network, read_source, options=("-O0",))
    assert run["x"][0].tolist() == list(range(8200))
