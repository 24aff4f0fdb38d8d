"""The server of a session, for browsers and programs on this machine: the page, the stream, and orders.

It listens on 127.0.0.1 only, and whoever asks must know its token: other users and other pages in the browser do not.
"""

from __future__ import annotations

import errno
import hmac
import json
import os
import secrets
import threading
from base64 import b64encode
from collections.abc import Mapping
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any, Final
from urllib.parse import parse_qs, urlsplit

from clean_swarm_env.config.errors import ConfigurationError
from train.live.conductor import Conductor

HOST: Final = "127.0.0.1"
MOST_ORDER: Final = 100_000
"""Bytes of an order."""
SIGN_OF_LIFE: Final = 10.0
"""Time without a block after which readers get a sign of life [s]: so it is found out which of them are gone."""


class LiveServer(ThreadingHTTPServer):
    """Serves one session; each request has a thread of its own, which ends with the program.

    Args:
        port: 0 for any free one.

    Attributes:
        address: the address of the page, with the token.

    Raises:
        ConfigurationError: the port cannot be had.

    """

    daemon_threads = True
    allow_reuse_address = (
        os.name == "posix"
    )  # there a port is free again at once; elsewhere two programs would share it
    conductor: Conductor
    page: bytes

    def __init__(self, port: int = 0) -> None:
        self.token = secrets.token_urlsafe(24)
        try:
            super().__init__((HOST, port), _Handler)
        except OSError as error:
            why = "is in use" if error.errno == errno.EADDRINUSE else f"cannot be had ({error.strerror})"
            raise ConfigurationError(f"--port: {port} {why}; expected a free port, or 0 for any") from error
        self.address = f"http://{HOST}:{self.server_address[1]}/?token={self.token}"

    def start(self, conductor: Conductor, page: str) -> None:
        """Serve the page of a session in a thread until `shutdown`."""
        self.conductor, self.page = conductor, page.encode()
        threading.Thread(target=self.serve_forever, daemon=True).start()

    def handle_error(self, request: Any, client_address: Any) -> None:  # noqa: ANN401  (as in the base class)
        """Say nothing of connections that clients have closed."""


class _Handler(BaseHTTPRequestHandler):
    """Answers one request."""

    server: LiveServer
    protocol_version = "HTTP/1.1"
    disable_nagle_algorithm = True

    def do_GET(self) -> None:
        path = self._allowed()
        if path == "/":
            self._answer(HTTPStatus.OK, self.server.page, "text/html; charset=utf-8")
        elif path == "/events":
            self._begin("text/event-stream")
            self._send_events()
        elif path == "/stream":
            self._begin("application/octet-stream")
            self._send_blocks()
        elif path:
            self._refuse(HTTPStatus.NOT_FOUND, "expected /, /events or /stream")

    def do_POST(self) -> None:
        if self._allowed() is None:
            return
        length = self.headers.get("Content-Length", "")
        if not length.isdecimal() or int(length) > MOST_ORDER:
            self.close_connection = True
            self._refuse(HTTPStatus.BAD_REQUEST, f"expected an order of at most {MOST_ORDER} bytes")
            return
        try:
            order = json.loads(self.rfile.read(int(length)))
            if not isinstance(order, Mapping):
                raise ValueError("expected an object in JSON")
            self.server.conductor.order(order)
        except (ValueError, RecursionError) as error:
            self._refuse(HTTPStatus.BAD_REQUEST, str(error) or "expected an order in JSON")
        except TimeoutError:
            self._refuse(HTTPStatus.SERVICE_UNAVAILABLE, "the session does not answer")
        else:
            self._answer(HTTPStatus.OK, b"{}", "application/json")

    def log_message(self, format: str, *args: object) -> None:
        """Write no log."""

    def _allowed(self) -> str | None:
        """Return the path that is asked for; refuse requests without the token."""
        asked = urlsplit(self.path)
        token = parse_qs(asked.query).get("token", [""])[0]
        if hmac.compare_digest(token.encode(), self.server.token.encode()):
            return asked.path
        self.close_connection = True
        self._refuse(HTTPStatus.FORBIDDEN, "expected the address that `clean-swarm play` has printed, with its token")
        return None

    def _send_events(self) -> None:
        """Send states and blocks as server-sent events; the id of an event says how many blocks have been sent."""
        stream, read = self.server.conductor.stream, 0
        last = self.headers.get("Last-Event-ID", "")
        if last.isdecimal():
            read = int(last)
        state = None
        while not stream.ended:
            blocks = stream.after(read, state, SIGN_OF_LIFE)
            text = "" if blocks or stream.state is not state else ": there\n\n"
            if stream.state is not state:
                state = stream.state
                text += f"event: state\ndata: {json.dumps(state)}\n\n"
            for block in blocks:
                read += 1
                text += f"id: {read}\ndata: {b64encode(block).decode()}\n\n"
            self.wfile.write(text.encode())

    def _send_blocks(self) -> None:
        """Send the recording as it grows."""
        stream, read, ended = self.server.conductor.stream, 0, False
        while not ended:
            ended = stream.ended
            for block in stream.after(read, stream.state, SIGN_OF_LIFE):
                read += 1
                self.wfile.write(block)

    def _begin(self, kind: str) -> None:
        self.close_connection = True
        self.send_response(HTTPStatus.OK)
        self.send_header("Content-Type", kind)
        self.send_header("Cache-Control", "no-store")
        self.send_header("Connection", "close")
        self.end_headers()

    def _refuse(self, status: HTTPStatus, text: str) -> None:
        self._answer(status, json.dumps({"error": text}).encode(), "application/json")

    def _answer(self, status: HTTPStatus, content: bytes, kind: str) -> None:
        self.send_response(status)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(content)))
        self.send_header("Cache-Control", "no-store")
        self.send_header("Referrer-Policy", "no-referrer")
        self.end_headers()
        self.wfile.write(content)
