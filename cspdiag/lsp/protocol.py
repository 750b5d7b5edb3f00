"""The protocol of the server: what pygls makes of messages, without what it does not do as the protocol has it."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from typing import Any

from cattrs import Converter, transform_error
from lsprotocol import types
from pygls.exceptions import JsonRpcInvalidParams
from pygls.protocol import (
    JsonRPCNotification,
    JsonRPCRequestMessage,
    LanguageServerProtocol,
    default_converter,
    lsp_method,
)

from cspdiag.base.record import record
from cspdiag.lsp.parameters import OWN

_log = logging.getLogger("pygls.protocol.json_rpc")


class _WithoutOrdinary(logging.Filter):
    """Keeps out of the log what pygls takes for failures: answers that refuse a request, such as a rename, and that the
    editor no longer wants an answer that it has been given meanwhile.
    """

    def filter(self, record: logging.LogRecord) -> bool:
        """Whether it is a failure."""
        refuses = record.exc_info is not None and isinstance(record.exc_info[1], JsonRpcInvalidParams)
        return not refuses and not str(record.msg).startswith("Cancel notification for unknown message id")


_log.addFilter(_WithoutOrdinary())


@record
class _Misread:
    """In place of parameters that do not have the form of the protocol: why."""

    reason: str


def converter() -> Converter:
    """What makes messages of objects of JSON. A text is one there, too: pygls would take a missing one for "None"."""
    made: Converter = default_converter()  # type: ignore[no-untyped-call]
    made.register_structure_hook(str, _text)
    return made


def _text(value: object, _: object) -> str:
    if isinstance(value, str):
        return value
    raise TypeError(f"expected a text, got {value!r}")


class Protocol(LanguageServerProtocol):
    """The protocol without the texts that pygls keeps: it takes form feeds and other characters for ends of lines,
    which are none in the protocol. The parameters of the server's own requests stay as they were sent. A request whose
    parameters cannot be read is answered by an error, where pygls only shows a message.
    """

    def structure_message(self, data: dict[str, Any]) -> Any:
        """A message from an object of JSON; what is no message stays as it is."""
        method = data.get("method")
        if "jsonrpc" not in data or not isinstance(method, str):
            return super().structure_message(data)
        is_request = "id" in data
        if is_request and method in OWN:
            return JsonRPCRequestMessage(data["id"], method, data["jsonrpc"], data.get("params"))
        plain = JsonRPCRequestMessage if is_request else JsonRPCNotification
        try:
            return self._converter.structure(data, self.get_message_type(method) or plain)
        # Whatever is raised by the function for some type.
        except Exception as problem:
            misread = _Misread("; ".join(transform_error(problem, "message")))
            if is_request:
                return JsonRPCRequestMessage(data["id"], method, data["jsonrpc"], misread)
            return JsonRPCNotification(method, data["jsonrpc"], misread)

    def _handle_request(self, msg_id: str | int, method_name: str, params: Any) -> None:
        if isinstance(params, _Misread):
            self._send_response(msg_id, None, JsonRpcInvalidParams(params.reason).to_response_error())
        else:
            super()._handle_request(msg_id, method_name, params)

    def _handle_notification(self, method_name: str, params: Any) -> None:
        if isinstance(params, _Misread):
            _log.warning("Ignoring %s: %s", method_name, params.reason)
        else:
            super()._handle_notification(method_name, params)

    @lsp_method(types.TEXT_DOCUMENT_DID_OPEN)
    def lsp_text_document__did_open(self, params: types.DidOpenTextDocumentParams) -> Iterator[object]:
        """A file was opened."""
        yield self.fm.features[types.TEXT_DOCUMENT_DID_OPEN], (params,), None

    @lsp_method(types.TEXT_DOCUMENT_DID_CHANGE)
    def lsp_text_document__did_change(self, params: types.DidChangeTextDocumentParams) -> Iterator[object]:
        """The text of an open file was changed."""
        yield self.fm.features[types.TEXT_DOCUMENT_DID_CHANGE], (params,), None

    @lsp_method(types.TEXT_DOCUMENT_DID_CLOSE)
    def lsp_text_document__did_close(self, params: types.DidCloseTextDocumentParams) -> Iterator[object]:
        """A file was closed."""
        yield self.fm.features[types.TEXT_DOCUMENT_DID_CLOSE], (params,), None
