"""What devices make of messages."""

from __future__ import annotations

from cspdiag.devices.messages import decoded


def test_a_message_that_is_no_json_is_a_text_which_its_port_refuses() -> None:
    assert decoded(b"high") == "high"
    assert decoded(3000 * b"[") == 3000 * "["
