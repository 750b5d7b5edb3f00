"""Only who has the link reaches the engines, and no page of another origin does."""

from __future__ import annotations

import http.client
import json
import random
from pathlib import Path
from typing import Any
from urllib.parse import quote

import pytest

from tests.studio.server.running_studio import Studio

client = pytest.importorskip("websockets.sync.client")
from websockets.exceptions import ConnectionClosed, InvalidStatus  # noqa: E402


def _fetch(port: int, path: str, **headers: str) -> http.client.HTTPResponse:
    connection = http.client.HTTPConnection("127.0.0.1", port)
    connection.request("GET", path, headers=headers)
    return connection.getresponse()


def test_the_page_is_served_with_headers_that_keep_others_away(tmp_path: Path) -> None:
    with Studio(tmp_path) as studio:
        answer = _fetch(studio.access.port, f"/?token={quote(studio.access.token)}")
        assert answer.status == 200
        assert b"the page" in answer.read()
        assert answer.headers["Referrer-Policy"] == "no-referrer"
        assert answer.headers["X-Frame-Options"] == "DENY"


@pytest.mark.parametrize("path", ["/../a.csp", "/%2e%2e/a.csp", "/page/../../a.csp", "/nothing", "//etc/passwd"])
def test_nothing_outside_the_folder_of_the_page_is_served(tmp_path: Path, path: str) -> None:
    with Studio(tmp_path) as studio:
        assert _fetch(studio.access.port, path).status == 404


def test_the_code_on_the_command_line_of_the_browser_can_be_used_once(tmp_path: Path) -> None:
    with Studio(tmp_path) as studio:
        port = studio.access.port
        assert _fetch(port, "/open?once=wrong").status == 403
        answer = _fetch(port, f"/open?once={studio.first.code}")
        assert (answer.status, answer.headers["Location"]) == (303, "/?token=the%20token")
        assert _fetch(port, f"/open?once={studio.first.code}").status == 403


def test_another_host_is_not_answered(tmp_path: Path) -> None:
    with Studio(tmp_path) as studio:
        assert _fetch(studio.access.port, "/", Host="attacker.example").status == 421
        assert _fetch(studio.access.port, "/", Host=f"attacker.example:{studio.access.port}").status == 421
        link = f"/?token={quote(studio.access.token)}"
        assert _fetch(studio.access.port, link, Host=f"localhost:{studio.access.port}").status == 200


@pytest.mark.parametrize("token", ["", "?token=", "?token=wrong", "?token=the%20token2", "?token=%ff", "?token=ü"])
def test_a_wrong_token_is_refused(tmp_path: Path, token: str) -> None:
    with Studio(tmp_path) as studio:
        with pytest.raises(InvalidStatus) as caught:
            client.connect(studio.link.partition("?")[0] + token)
        assert caught.value.response.status_code == 403


@pytest.mark.parametrize("place", ["/", "/?token=wrong", "/index.html?token=%ff"])
def test_an_old_link_says_where_the_present_one_is(tmp_path: Path, place: str) -> None:
    with Studio(tmp_path) as studio:
        answer = _fetch(studio.access.port, place)
        assert answer.status == 403
        assert b"Open the link that is in the terminal" in answer.read()


@pytest.mark.parametrize(
    "headers",
    [
        {"origin": "http://attacker.example"},
        {"origin": "null"},
        {"origin": "https://127.0.0.1"},
        {"additional_headers": {"Origin": "http://127.0.0.1:1"}},
    ],
)
def test_a_page_of_another_origin_is_refused(tmp_path: Path, headers: dict[str, Any]) -> None:
    with Studio(tmp_path) as studio:
        with pytest.raises(InvalidStatus) as caught:
            client.connect(studio.link, **headers)
        assert caught.value.response.status_code == 403


def test_the_page_of_the_server_is_answered(tmp_path: Path) -> None:
    with Studio(tmp_path) as studio:
        page = studio.open(origin=f"http://127.0.0.1:{studio.access.port}")
        assert page.ask("check", text="x")["params"] == {"text": "x"}


def test_a_ping_of_a_page_is_answered(tmp_path: Path) -> None:
    with Studio(tmp_path) as studio:
        page = studio.open()
        page.socket.send('{"method": "ping"}')
        page.wait_for("pong")


def test_malformed_messages_are_answered_and_harm_nothing(tmp_path: Path) -> None:
    with Studio(tmp_path) as studio:
        page = studio.open()
        chance = random.Random(1)
        samples = [
            *("", "{", "[]", "1", "null", "[" * 100_000, "\0", "\ud7ff"),
            *('{"id": 1}', '{"id": {}, "method": "check"}', '{"id": 1, "method": 5}', '{"id": NaN, "method": "check"}'),
            *('{"id": 1, "method": "check", "params": []}', '{"id": 1, "method": "nothing", "params": {}}'),
            *('{"id": 1, "method": "__class__"}', '{"id": 1, "method": "save"}'),
        ]
        count = 2_000
        for number in range(count):
            sample = chance.choice(samples)
            damaged = sample if chance.random() < 0.5 else sample[: chance.randrange(len(sample) + 1)]
            page.socket.send(damaged if number % 7 else damaged.encode())
            while "id" not in page.receive():
                pass
        assert page.ask("check")["method"] == "check"


def test_a_message_that_is_too_long_ends_its_connection_only(tmp_path: Path) -> None:
    with Studio(tmp_path) as studio:
        page, other = studio.open(), studio.open()
        page.wait_for("hand")
        page.socket.send(json.dumps({"id": 1, "method": "check", "params": {"text": "x" * 5_000_000}}))
        with pytest.raises(ConnectionClosed):
            page.wait_for("nothing")
        assert other.ask("check")["method"] == "check"
