"""Who does not hold the token keeps nobody out, gets nothing, and makes nothing grow."""

import json
import socket
import threading
from itertools import product

import pytest

from tests.train.live.sessions import SMALL, asked, ordered, play_of, served
from train.live import server as live_server
from train.live.session import Session

ORDER = b'{"do": "step"}'


@pytest.fixture(scope="module")
def serving(tmp_path_factory):
    with served(Session(play_of(SMALL), tmp_path_factory.mktemp("strangers") / "run.swarm")) as running:
        yield running


@pytest.fixture
def server(serving):
    """The server, and how many steps were done before: one for all tests, which it survives."""
    serving.before = serving.conductor.session.ticks
    serving.since.clear()  # connections of tests before, whose threads take a while to notice that they ended
    return serving


def request(server, head: str, body: bytes = b"") -> bytes:
    """Return the answer to a request; `head` is what follows its first line, where HOST stands for the server."""
    host = f"127.0.0.1:{server.server_address[1]}"
    first = f"POST /do?token={server.token} HTTP/1.1\r\n"
    with socket.create_connection(server.server_address, timeout=60) as connection:
        connection.sendall((first + head.replace("HOST", host) + "\r\n").encode("latin-1") + body)
        connection.shutdown(socket.SHUT_WR)
        return b"".join(iter(lambda: connection.recv(65_536), b""))


def status_of(answer: bytes) -> int:
    return int(answer.split(b" ", 2)[1])


@pytest.mark.parametrize("said", [b"", b"GET /?token=x HTTP/1.1\r\nHost: 127.0.0.1\r\n"])
def test_hundreds_of_silent_connections_keep_the_owner_out_of_nothing(server, said):
    before = threading.active_count()
    strangers = [socket.create_connection(server.server_address, timeout=60) for _ in range(200)]
    for stranger in strangers[-50:]:
        stranger.sendall(said)
    assert asked(server, "")[0] == 200
    assert ordered(server, do="step") == ""
    assert threading.active_count() <= before + live_server.MOST_CONNECTIONS + 2
    assert strangers[0].recv(1) == b""
    for stranger in strangers:
        stranger.close()


def test_readers_that_hold_the_token_are_cut_after_all_strangers(server, monkeypatch):
    monkeypatch.setattr(live_server, "MOST_CONNECTIONS", 4)
    readers = [socket.create_connection(server.server_address, timeout=60) for _ in range(3)]
    for reader in readers:
        reader.sendall(f"GET /events?token={server.token} HTTP/1.1\r\nHost: localhost\r\n\r\n".encode())
        assert reader.recv(8) == b"HTTP/1.0"
    strangers = [socket.create_connection(server.server_address, timeout=60) for _ in range(9)]
    assert asked(server, "")[0] == 200
    assert ordered(server, do="step") == ""
    assert all(stranger.recv(1) == b"" for stranger in strangers[:8])
    assert len(server.since) >= 3
    assert all(reader.recv(1) for reader in readers)
    for connection in (*readers, *strangers):
        connection.close()


def test_listeners_that_do_not_read_hold_no_order_up(server, monkeypatch):
    monkeypatch.setattr(live_server, "MOST_CONNECTIONS", 4)
    monkeypatch.setattr(live_server, "SIGN_OF_LIFE", 1e6)
    listeners = [socket.create_connection(server.server_address, timeout=60) for _ in range(4)]
    for listener in listeners:
        listener.sendall(f"GET /events?token={server.token} HTTP/1.1\r\nHost: localhost\r\n\r\n".encode())
        assert listener.recv(8) == b"HTTP/1.0"
    assert [ordered(server, do="step") for _ in range(8)] == [""] * 8
    for listener in listeners:
        listener.close()


def test_a_connection_that_says_nothing_ends(server, monkeypatch):
    monkeypatch.setattr(live_server._Handler, "timeout", 0.2)
    with socket.create_connection(server.server_address, timeout=60) as stranger:
        stranger.sendall(b"GET / HTTP/1.1\r\n")
        assert stranger.recv(1) == b""


def test_a_head_without_end_is_not_kept(server):
    with socket.create_connection(server.server_address, timeout=60) as stranger:
        stranger.sendall(b"GET / HTTP/1.1\r\n" + b"a" * live_server.MOST_HEAD)
        assert status_of(stranger.recv(100)) >= 400


@pytest.mark.parametrize(
    "headers",
    [
        "",
        "Host: evil.example\r\n",
        "Host: 127.0.0.1.evil.example\r\n",
        "Host: HOST\r\nHost: evil.example\r\n",
        "Host: HOST\r\nOrigin: http://evil.example\r\n",
        "Host: HOST\r\nOrigin: http://127.0.0.1:1\r\n",
        "Host: HOST\r\nOrigin: null\r\n",
        "Host: HOST\r\nOrigin: http://HOST\r\nOrigin: null\r\n",
    ],
)
def test_requests_of_other_sites_are_refused_even_with_the_token(server, headers):
    answer = request(server, f"{headers}Content-Length: {len(ORDER)}\r\n", ORDER)
    assert status_of(answer) == 403
    assert b"expected 127.0.0.1 or localhost as Host, and no other Origin" in answer
    assert server.conductor.session.ticks == server.before


@pytest.mark.parametrize("host", ["HOST", "localhost:8000", "localhost"])
def test_requests_of_the_page_are_answered_through_a_tunnel_too(server, host):
    answer = request(server, f"Host: {host}\r\nOrigin: http://{host}\r\nContent-Length: {len(ORDER)}\r\n", ORDER)
    assert status_of(answer) == 200
    assert server.conductor.session.ticks == server.before + 1


LENGTHS = ("-1", "+14", "14.0", "0x0e", "1 4", "\u00b2", "fourteen", "100001", "9" * 5000, "", "15")
HEADS = [f"Content-Length: {length}\r\n" for length in LENGTHS]
HEADS += ["", "Content-Length: 14\r\nContent-Length: 14\r\n", "Content-Length: 14\r\nTransfer-Encoding: chunked\r\n"]


@pytest.mark.parametrize("head", HEADS)
def test_an_odd_length_of_an_order_is_one_line(server, head):
    answer = request(server, f"Host: HOST\r\n{head}", ORDER)
    assert status_of(answer) == 400
    (line,) = answer.partition(b"\r\n\r\n")[2].splitlines()
    assert "expected" in json.loads(line)["error"]
    assert server.conductor.session.ticks == server.before


def test_a_pipeline_is_one_request(server):
    head = f"Host: HOST\r\nContent-Length: {len(ORDER)}\r\n"
    again = f"POST /do?token={server.token} HTTP/1.1\r\n{head}\r\n".encode() + ORDER
    assert request(server, head, ORDER + again).count(b"HTTP/1.0") == 1
    assert server.conductor.session.ticks == server.before + 1


def test_every_answer_forbids_frames_and_guesses(server):
    for method, path in product(("GET", "POST", "HEAD"), ("/", "/events", "/do", "/other")):
        for token in (server.token, "x"):
            with socket.create_connection(server.server_address, timeout=60) as connection:
                line = f"{method} {path}?token={token} HTTP/1.1\r\nHost: localhost\r\n\r\n"
                connection.sendall(line.encode())
                head = connection.makefile("rb").read(400)
            assert b"X-Content-Type-Options: nosniff\r\n" in head, line
            assert b"Content-Security-Policy: frame-ancestors 'none'\r\n" in head, line
