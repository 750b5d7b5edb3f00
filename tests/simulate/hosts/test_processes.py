"""Places in processes of their own, which meet at an address of the loopback."""

from __future__ import annotations

from pathlib import Path

from cspdiag.cli.main import main
from tests.simulate.hosts.conftest import Start, ended, free_port

MODELS = Path(__file__).parents[3] / "models"


def test_jiwy_has_a_place_for_each_joint(start: Start, tmp_path: Path) -> None:
    jiwy, port = MODELS / "jiwy" / "jiwy.csp", free_port()
    traces = {place: tmp_path / f"{place}.jsonl" for place in ("pan", "tilt")}
    places = [start(jiwy, place, port, "--for", "300ms", "--trace", trace) for place, trace in traces.items()]
    results = [ended(place) for place in places]
    assert [code for code, _ in results] == [0, 0], results
    assert all("round trip to" in output for _, output in results)
    whole = tmp_path / "whole.jsonl"
    assert main(["run", str(jiwy), "-O0", "--quiet", "--for", "300ms", "--trace", str(whole)]) == 0
    parts = [line for trace in traces.values() for line in trace.read_text().splitlines()]
    assert sorted(parts) == sorted(whole.read_text().splitlines())
