"""Sweeps on a Dask cluster of real processes, one of which is killed on the way."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from importlib.util import find_spec
from pathlib import Path

import pytest

import cspdiag
from tests.sweep.programs import HEATER

pytestmark = [
    pytest.mark.skipif(find_spec("distributed") is None, reason="needs pip install 'cspdiag[dask]'"),
    pytest.mark.skipif(
        not any(map(shutil.which, ("cc", "gcc", "clang"))), reason="no C compiler: install gcc or clang"
    ),
]

PATIENCE = 60.0


def wait_until(is_so: Callable[[], bool]) -> None:
    deadline = time.monotonic() + PATIENCE
    while not is_so():
        assert time.monotonic() < deadline
        time.sleep(0.02)


class Cluster:
    """A scheduler and two workers, each a process."""

    def __init__(self, folder: Path) -> None:
        self.file = folder / "scheduler.json"
        self.processes: list[subprocess.Popen[bytes]] = []
        self.start("distributed.cli.dask_scheduler", "--port", "0", "--no-dashboard", "--host", "127.0.0.1")
        wait_until(self.file.exists)
        for _ in range(2):
            self.start("distributed.cli.dask_worker", "--no-nanny", "--nthreads", "1", "--no-dashboard")

    def start(self, module: str, *options: str) -> None:
        command = [sys.executable, "-m", module, "--scheduler-file", str(self.file), *options]
        self.processes.append(
            subprocess.Popen(command, cwd=self.file.parent, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        )

    @property
    def address(self) -> str:
        return str(json.loads(self.file.read_text())["address"])


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[Cluster]:
    found = Cluster(tmp_path)
    yield found
    for process in reversed(found.processes):
        process.kill()
        process.wait()


def test_the_table_is_whole_when_a_machine_is_lost(cluster: Cluster, tmp_path: Path) -> None:
    (tmp_path / "heater.csp").write_text(HEATER)
    options = ["heater.csp", "--for", "800s", "--set", "gain=0.1:1:150", "--set", "room.volume=1,2"]
    options += ["--measure", "mean(power)", "--measure", "rms(room.t)"]
    sweep = [sys.executable, "-m", "cspdiag", "sweep", *options]
    subprocess.run([*sweep, "-o", "here.csv"], cwd=tmp_path, check=True, capture_output=True, timeout=PATIENCE)
    partial = tmp_path / "there.csv.partial"

    def has_results() -> bool:
        with suppress(FileNotFoundError):
            return partial.read_text().count("\n") > 12
        return running.poll() is not None

    with subprocess.Popen([*sweep, "-o", "there.csv", "--dask", cluster.address], cwd=tmp_path) as running:
        wait_until(has_results)
        assert running.poll() is None
        cluster.processes[1].kill()
        assert running.wait(timeout=PATIENCE) == 0
    assert (tmp_path / "there.csv").read_bytes() == (tmp_path / "here.csv").read_bytes()
    assert (tmp_path / "here.csv").read_text().count("\n") == 301


def test_a_cluster_that_does_not_answer(tmp_path: Path) -> None:
    (tmp_path / "heater.csp").write_text(HEATER)
    script = (
        "import sys, cspdiag.sweep.cluster as cluster; from cspdiag.cli.main import main; cluster._PATIENCE = 1;"
        "sys.exit(main(['sweep', 'heater.csp', '--for', '1s', '--set', 'gain=1', '--dask', 'tcp://127.0.0.1:9']))"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], cwd=tmp_path, capture_output=True, text=True, check=False, timeout=PATIENCE
    )
    assert done.returncode == 1
    assert "cspdiag: no scheduler of Dask answers at tcp://127.0.0.1:9: " in done.stderr
    assert "Traceback" not in done.stderr


def test_an_address_is_a_text() -> None:
    with pytest.raises(TypeError, match="dask is a str"):
        cspdiag.parse(HEATER).sweep({"gain": 1}, until=1, dask=9)  # type: ignore[arg-type]


def test_a_scheduler_that_goes_away_is_named_with_what_is_not_lost(cluster: Cluster, tmp_path: Path) -> None:
    (tmp_path / "heater.csp").write_text(HEATER)
    options = ["heater.csp", "--for", "800s", "--set", "gain=0.1:1:3000", "--measure", "mean(power)", "--quiet"]
    running = subprocess.Popen(
        [sys.executable, "-m", "cspdiag", "sweep", *options, "-o", "there.csv", "--dask", cluster.address],
        cwd=tmp_path, stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    partial = tmp_path / "there.csv.partial"
    wait_until(lambda: running.poll() is not None or (partial.exists() and partial.read_text().count("\n") > 12))
    cluster.processes[0].kill()
    said = running.communicate(timeout=2 * PATIENCE)[1]
    assert running.returncode == 1
    assert f"cspdiag: the scheduler at {cluster.address} has gone away\n" in said
    assert " of 3000 runs are in there.csv.partial: --resume makes the others" in said
    assert "Traceback" not in said
