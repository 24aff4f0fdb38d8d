"""The server of a session, for browsers and programs on this machine: the page, the stream, and orders.

It listens on 127.0.0.1 only, and every request must name its token, which other users and other pages in the browser
do not know. docs/play.md says against whom it is made, docs/decisions/0204-one-request-a-connection.md which other
ways were rejected.
"""

from __future__ import annotations

import errno
import hmac
import json
import os
import re
import secrets
import socket
import threading
from base64 import b64encode
from collections.abc import Mapping
from contextlib import suppress
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from io import BytesIO
from operator import itemgetter
from time import monotonic, sleep
from typing import Any, Final
from urllib.parse import parse_qs

from clean_swarm_env.config.types import ConfigurationError
from selector.documents.reading import json_value
from train.live.conductor import Conductor

HOST: Final = "127.0.0.1"
OWN_HOST: Final = re.compile(r"(127\.0\.0\.1|localhost)(:[0-9]+)?")
"""The header `Host` of requests to this machine; the port may be another one, of a tunnel."""
MOST_ORDER: Final = 100_000
"""Bytes of an order."""
SIGN_OF_LIFE: Final = 10.0
"""Time without a block after which readers get a sign of life [s]: so it is found out which of them are gone."""
MOST_CONNECTIONS: Final = 64
"""Connections, each with a thread; for one more, the oldest is cut, of those first that have not named the token."""
YOUNGER: Final = 1e9
"""Time by which a connection that has named the token counts as younger [s]."""
MOST_HEAD: Final = 65_536
"""Bytes before the body of a request."""
LONGEST_SILENCE: Final = 5.0
"""Time between two pieces of a request, after which the connection ends [s]."""
HEADERS: Final = {
    "Cache-Control": "no-store",
    "Content-Security-Policy": "frame-ancestors 'none'",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
}
"""Headers of every answer."""


class LiveServer(ThreadingHTTPServer):
    """Serves one session; each request has a connection and a thread of its own, which ends with the program.

    Args:
        port: 0 for any free one.

    Attributes:
        address: the address of the page, with the token.

    Raises:
        ConfigurationError: the port cannot be had.

    """

    daemon_threads = True
    request_queue_size = 128
    allow_reuse_address = (
        os.name == "posix"
    )  # there a port is free again at once; elsewhere two programs would share it

    def __init__(self, port: int = 0) -> None:
        self.token = secrets.token_urlsafe(24)
        self.since: dict[Any, float] = {}  # connection -> when it began [s], or `YOUNGER` once it has named the token
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

    def process_request(self, request: Any, client_address: Any) -> None:  # noqa: ANN401  (as in the base class)
        """Give a connection a thread, in place of the oldest one where there are too many."""
        self.since[request] = monotonic()
        super().process_request(request, client_address)
        while len(self.since) > MOST_CONNECTIONS:
            oldest, _ = min((one for one in list(self.since.items()) if one[0] is not request), key=itemgetter(1))
            self.since.pop(oldest, None)  # its thread may sleep, and must not hold others up
            with suppress(OSError):
                oldest.shutdown(socket.SHUT_RDWR)  # its thread notices it, and ends
            sleep(0.001)

    def shutdown_request(self, request: Any) -> None:  # noqa: ANN401  (as in the base class)
        """End a connection, and forget it."""
        self.since.pop(request, None)
        super().shutdown_request(request)

    def handle_error(self, request: Any, client_address: Any) -> None:  # noqa: ANN401  (as in the base class)
        """Say nothing of connections that clients have closed."""


def _whole(text: str) -> int:
    """Return the whole number of at most nine digits that a header gives, -1 if it gives none."""
    return int(text) if text.isdecimal() and len(text) < 10 else -1


class _Handler(BaseHTTPRequestHandler):
    """Answers one request; speaks HTTP/1.0, so that the connection then ends."""

    server: LiveServer
    disable_nagle_algorithm = True
    timeout = LONGEST_SILENCE

    def handle(self) -> None:
        """Answer one request, as soon as its head is there."""
        self._body, head = self.rfile, b""
        while len(head) < MOST_HEAD and (line := self.rfile.readline(MOST_HEAD - len(head))).strip():
            head += line
        self.rfile = BytesIO(head)
        self.handle_one_request()

    def do_GET(self) -> None:
        path = self._allowed("/", "/events", "/stream")
        if path == "/":
            self._answer(HTTPStatus.OK, self.server.page, "text/html; charset=utf-8")
        elif path:
            self.connection.settimeout(None)  # a reader may sleep
            self.send_response(HTTPStatus.OK)
            self.send_header("Content-Type", "text/event-stream" if path == "/events" else "application/octet-stream")
            self.end_headers()
            self._send_events() if path == "/events" else self._send_blocks()

    def do_POST(self) -> None:
        if not self._allowed("/do"):
            return
        length = _whole(",".join(self.headers.get_all("Content-Length", [])))  # two of them are none
        if not 0 <= length <= MOST_ORDER or "Transfer-Encoding" in self.headers:
            self._refuse(HTTPStatus.BAD_REQUEST, f"expected Content-Length and an order of at most {MOST_ORDER} bytes")
            return
        body = self._body.read(length)
        try:
            order = json_value(body.decode(errors="replace"), "order")
            if len(body) < length or not isinstance(order, Mapping):
                raise ValueError("expected an object in JSON, as long as Content-Length says")
            told = self.server.conductor.order(order)
        except ValueError as error:
            self._refuse(HTTPStatus.BAD_REQUEST, str(error))
        except TimeoutError:
            self._refuse(HTTPStatus.SERVICE_UNAVAILABLE, "the session does not answer")
        else:
            self._answer(HTTPStatus.OK, json.dumps(told).encode(), "application/json")

    def log_message(self, format: str, *args: object) -> None:
        """Write no log."""

    def end_headers(self) -> None:
        """End the headers, with those of every answer."""
        for name, value in HEADERS.items():
            self.send_header(name, value)
        super().end_headers()

    def _allowed(self, *paths: str) -> str:
        """Return the path that is asked for, one of `paths`; refuse requests for others, or from elsewhere."""
        path, _, query = self.path.partition("?")
        token = parse_qs(query).get("token", [""])[0]
        host, origins = ",".join(self.headers.get_all("Host", [])), self.headers.get_all("Origin", [])
        if not OWN_HOST.fullmatch(host) or any(origin != f"http://{host}" for origin in origins):
            self._refuse(HTTPStatus.FORBIDDEN, f"expected {HOST} or localhost as Host, and no other Origin")
        elif not hmac.compare_digest(token.encode(), self.server.token.encode()):
            self._refuse(
                HTTPStatus.FORBIDDEN, "expected the address that `clean-swarm play` has printed, with its token"
            )
        elif path not in paths:
            self._refuse(HTTPStatus.NOT_FOUND, f"expected {' or '.join(paths)}")
        else:
            self.server.since[self.connection] += YOUNGER
            return path
        return ""

    def _send_events(self) -> None:
        """Send states and blocks as server-sent events; the id of an event says how many blocks have been sent."""
        stream, state = self.server.conductor.stream, None
        read = max(0, _whole(self.headers.get("Last-Event-ID", "")))
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

    def _refuse(self, status: HTTPStatus, text: str) -> None:
        self._answer(status, json.dumps({"error": text}).encode(), "application/json")

    def _answer(self, status: HTTPStatus, content: bytes, kind: str) -> None:
        self.send_response(status)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(content)))
        self.end_headers()
        self.wfile.write(content)
