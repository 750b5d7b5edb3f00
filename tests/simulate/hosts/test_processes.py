"""Places in processes of their own, which meet at an address of the loopback."""

from __future__ import annotations

import re
import signal
import socket
import threading
import time
from argparse import Namespace
from ipaddress import IPv6Address
from pathlib import Path
from typing import NoReturn

import pytest

import cspdiag
from cspdiag.cli.main import main
from cspdiag.cli.support.runs.placed import shown_groups
from cspdiag.simulate.hosts.links import PlaceError
from cspdiag.simulate.hosts.network import ZenohTransport
from tests.simulate.hosts.conftest import Start, ended, free_port, pair
from tests.simulate.hosts.places import eventually
from tests.simulate.hosts.proxy import Proxy

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


def _began(file: Path) -> bool:
    """Whether a recording has values already."""
    part = file.with_name(file.stem + ".part" + file.suffix)
    return part.exists() and part.stat().st_size > 500


def test_a_killed_place_raises_a_time_out_in_the_other_and_outputs_are_released(start: Start, tmp_path: Path) -> None:
    file, port, record = tmp_path / "pair.csp", free_port(), tmp_path / "right.csv"
    file.write_text(pair(100_000))
    left = start(file, "left", port, "--real-time")
    right = start(file, "right", port, "--real-time", "--record", record)
    assert eventually(lambda: _began(record), 60)
    left.kill()
    code, output = ended(right)
    assert code == 1
    assert re.search(r" Timeout: the place `left` has been silent for 1 s, in Pair\.sink", output)
    assert record.read_text().splitlines()[-1].endswith(",7")


def _reaches(transport: ZenohTransport, place: str, arrived: threading.Event) -> bool:
    transport.send(place, b"hello")
    return arrived.wait(0.1)


def test_a_place_connects_over_a_slow_link() -> None:
    pytest.importorskip("zenoh")
    port, arrived = free_port(), threading.Event()
    proxy = Proxy(port, 0.25)
    first = ZenohTransport(f"127.0.0.1:{port}", "room", listens=True, patience=30)
    other = ZenohTransport(f"127.0.0.1:{proxy.port}", "room", listens=False, patience=30)
    try:
        first.open("first", lambda data: arrived.set())
        other.open("other", lambda data: None)
        assert eventually(lambda: _reaches(other, "first", arrived))
    finally:
        other.close()
        first.close()
        proxy.close()


@pytest.mark.parametrize("reachable", [True, False])
def test_places_that_are_not_the_first_reach_each_other(reachable: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("zenoh")
    if not reachable:
        monkeypatch.setattr(ZenohTransport, "_directly_connected", lambda _: None)
    address, arrived = f"127.0.0.1:{free_port()}", threading.Event()
    first, second, third = (ZenohTransport(address, "room", listens=at == 0, patience=30) for at in range(3))
    try:
        first.open("first", lambda data: None)
        second.open("second", lambda data: None)
        third.open("third", lambda data: arrived.set())
        assert eventually(lambda: _reaches(second, "third", arrived))
        first.close()
        time.sleep(0.2)
        arrived.clear()
        assert eventually(lambda: _reaches(second, "third", arrived), 2) == reachable
    finally:
        for transport in (first, second, third):
            transport.close()


def _meet(first: str, second: str) -> None:
    """Two places find each other, although each has an address of its own for the first one."""
    port, arrived = free_port(), threading.Event()
    listening, connecting = (
        ZenohTransport(f"{host}:{port}", "room", listens=host is first, patience=5) for host in (first, second)
    )
    try:
        listening.open("first", lambda data: arrived.set())
        connecting.open("second", lambda data: None)
        assert eventually(lambda: _reaches(connecting, "first", arrived))
    finally:
        connecting.close()
        listening.close()


@pytest.mark.parametrize(
    ("first", "second"),
    [("localhost", "[::1]"), ("[::1]", "localhost"), ("127.0.0.1", "[::1]"), ("[::1]", "127.0.0.1")],
)
def test_places_of_one_machine_find_each_other_under_all_its_names(first: str, second: str) -> None:
    pytest.importorskip("zenoh")
    if not _has_address("::1"):
        pytest.skip("this machine has no IPv6")
    _meet(first, second)


def _has_address(host: str) -> bool:
    try:
        ((*_, place), *_) = socket.getaddrinfo(host, 0, socket.AF_INET6, socket.SOCK_STREAM)
        socket.create_server(place, family=socket.AF_INET6).close()
    except OSError:
        return False
    return True


def _address_of_one_link() -> tuple[str, str]:
    """A link-local address of this machine, and its network interface."""
    table = Path("/proc/net/if_inet6")
    for line in table.read_text().splitlines() if table.exists() else ():
        digits, *_, interface = line.split()
        address = IPv6Address(int(digits, 16))
        if address.is_link_local and _has_address(f"{address}%{interface}"):
            return str(address), interface
    pytest.skip("this machine has no link-local address")


def test_an_address_of_one_link_names_the_interface() -> None:
    pytest.importorskip("zenoh")
    address, interface = _address_of_one_link()
    _meet(f"[{address}%{interface}]", f"[{address}%{socket.if_nametoindex(interface)}]")


@pytest.mark.parametrize("listens", [True, False])
def test_an_interface_that_the_machine_does_not_have(listens: bool) -> None:
    pytest.importorskip("zenoh")
    transport = ZenohTransport("[fe80::7%absent7]:7447", "room", listens=listens, patience=0.5)
    why = r"no network interface `absent7`, which \[fe80::7%absent7\]:7447 names"
    with pytest.raises(PlaceError, match=why):
        transport.open("first", lambda data: None)


@pytest.mark.parametrize(("listens", "why"), [(True, "does not answer as the first place"), (False, "nobody listens")])
def test_a_place_that_cannot_connect_says_why(listens: bool, why: str) -> None:
    pytest.importorskip("zenoh")
    with socket.create_server(("127.0.0.1", 0)) as stranger:
        address = f"127.0.0.1:{stranger.getsockname()[1]}"
        if not listens:
            stranger.close()
        with pytest.raises(PlaceError, match=why):
            ZenohTransport(address, "room", listens=False, patience=0.5).open("other", lambda data: None)


def test_a_place_says_at_once_that_a_host_is_unknown(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("zenoh")

    def nobody_knows(*_: object, **__: object) -> NoReturn:
        raise socket.gaierror(socket.EAI_NONAME, "Name or service not known")

    monkeypatch.setattr(socket, "getaddrinfo", nobody_knows)
    why = r"the host of no\.such\.host:7447 is unknown here \(Name or service not known\)"
    began = time.monotonic()
    with pytest.raises(PlaceError, match=why):
        ZenohTransport("no.such.host:7447", "room", listens=False, patience=30).open("other", lambda data: None)
    assert time.monotonic() - began < 10


def test_a_link_that_was_cut_comes_back(start: Start, tmp_path: Path) -> None:
    file, port, record = tmp_path / "pair.csp", free_port(), tmp_path / "right.csv"
    caught = "catch Timeout -> (timeouts := timeouts + 1 ; value ! -timeouts)"
    file.write_text(pair(100_000, caught))
    proxy = Proxy(port, 0.002)
    try:
        left = start(file, "left", port, "--real-time", "--for", "15s")
        right = start(file, "right", proxy.port, "--real-time", "--for", "15s", "--record", record)
        assert eventually(lambda: _began(record), 60)
        proxy.cut()
        assert not eventually(lambda: left.poll() is not None or right.poll() is not None, 1.5)
        proxy.reopen()
        results = [ended(left), ended(right)]
    finally:
        proxy.close()
    assert [code for code, _ in results] == [0, 0], results
    for _, output in results:
        assert re.search(r"round trip to (left|right): mean [0-9.]+ ms,.* lost [0-9]+ time", output), output
    values = [float(row.rpartition(",")[2]) for row in record.read_text().splitlines()[1:-1]]
    back = values[values.index(-1) :]
    assert max(back) > max(values[: values.index(-1)])


def test_a_pulled_cable_ends_both_places_with_their_outputs_released(start: Start, tmp_path: Path) -> None:
    file, port, record = tmp_path / "pair.csp", free_port(), tmp_path / "right.csv"
    file.write_text(pair(100_000).replace(" catch Timeout -> wait 1 ms", ""))
    proxy = Proxy(port, 0)
    try:
        left = start(file, "left", port, "--real-time")
        right = start(file, "right", proxy.port, "--real-time", "--record", record)
        assert eventually(lambda: _began(record), 60)
        proxy.fall_silent()
        results = [ended(left), ended(right)]
    finally:
        proxy.close()
    assert [code for code, _ in results] == [1, 1], results
    assert re.search(r" Timeout: the place `right` has been silent for 1 s, in Pair\.source", results[0][1])
    assert re.search(r" Timeout: the place `left` has been silent for 1 s, in Pair\.sink", results[1][1])
    assert record.read_text().splitlines()[-1].endswith(",7")


def test_ctrl_c_ends_all_places_with_their_outputs_released(start: Start, tmp_path: Path) -> None:
    file, port, record = tmp_path / "pair.csp", free_port(), tmp_path / "right.csv"
    file.write_text(pair(100_000))
    left = start(file, "left", port, "--real-time")
    right = start(file, "right", port, "--real-time", "--record", record)
    assert eventually(lambda: _began(record), 60)
    left.send_signal(signal.SIGINT)
    assert ended(left)[0] == 130
    code, output = ended(right)
    assert code == 1
    assert "the place `left` has ended: it was stopped" in output
    assert record.read_text().splitlines()[-1].endswith(",7")


def test_an_address_that_is_not_free(start: Start, tmp_path: Path) -> None:
    file, port = tmp_path / "pair.csp", free_port()
    file.write_text(pair(5))
    proxy = Proxy(port, 0)
    try:
        code, output = ended(start(file, "left", proxy.port))
    finally:
        proxy.close()
    assert code == 1
    assert f"but 127.0.0.1:{proxy.port} is not free or not of this machine" in output


def test_options_that_places_do_not_have(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    file = tmp_path / "pair.csp"
    file.write_text(pair(5))
    for options, message in (
        (["--place", "left"], "--place left: write NAME@HOST:PORT, such as pan@192.168.1.7:7447 or pan@[fd00::7]:7447"),
        (["--place", "left@h:99999"], "--place left@h:99999: write NAME@HOST:PORT"),
        (["--place", "left@[fd00::7::]:1"], "--place left@[fd00::7::]:1: write NAME@HOST:PORT"),
        (
            ["--place", "left@[fe80::7]:1"],
            "name this machine's interface to the one that is meant, such as [fe80::7%eth0]",
        ),
        (["--place", "up@h:1"], "the environment `Bench` has no place `up`; it has `left`, `right`"),
        (["--place", "left@h:1", "--target", "c"], "--target is not for --place: places run in Python"),
    ):
        assert main(["run", str(file), *options]) == 2
        assert message in capsys.readouterr().err


DRIVERS = """
driver Meter(name: text) python "meter.py:Meter" { out level : double }

process Follow {
  in  x    : double @ 10 ms
  out sent : double
  communication { var p : double = 0 }
  composition { mu (x ? p ; sent ! p) until p > 3 }
}

process Take {
  in  received : double
  in  y : double @ 10 ms
  out u : double @ 10 ms safe 0
  communication { var p : double = 0  var q : double = 0 }
  composition { mu (received ? p ; y ? q ; u ! p + q) until p > 3 }
}

process Both {
  in  x, y : double @ 10 ms
  out u : double @ 10 ms safe 0
  communication { a : Follow  b : Take  x -> a.x  y -> b.y  a.sent -> b.received  b.u -> u }
  composition { a || b }
}

environment Bench for Both on miss count place left : a place right : b {
  m : Meter(name = "of the left")
  n : Meter(name = "of the right")
  m.level -> x
  n.level -> y
  u       -> _
}
"""
METER = """
class Meter:
    def __init__(self, name):
        self.name, self.level = name, 0.0
    def open(self):
        print("opened", self.name)
    def read(self, port):
        self.level += 0.5
        return self.level
"""


def test_each_place_opens_the_drivers_of_its_own_processes(start: Start, tmp_path: Path) -> None:
    (tmp_path / "meter.py").write_text(METER)
    file, port = tmp_path / "both.csp", free_port()
    file.write_text(DRIVERS)
    places = {place: start(file, place, port) for place in ("left", "right")}
    results = {place: ended(process) for place, process in places.items()}
    assert [code for code, _ in results.values()] == [0, 0], results
    for place, (_, output) in results.items():
        assert re.findall("opened of the (left|right)", output) == [place]


def test_the_progress_of_a_place_is_about_its_own_processes(tmp_path: Path) -> None:
    (tmp_path / "pair.csp").write_text(pair(5))
    network = cspdiag.load(tmp_path / "pair.csp").network
    for place, names in (("left", ["source"]), ("right", ["sink"]), (None, ["source", "sink"])):
        arguments = Namespace(place=None if place is None else f"{place}@127.0.0.1:1", environment=None)
        groups = shown_groups(arguments, network)
        assert [name for group in groups for name in group.modes.values()] == names
