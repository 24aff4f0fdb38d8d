"""The server of a session: who may ask, what it answers, and that nobody who listens slows the run."""

import json
import os
import signal
import socket
import subprocess
import sys
import time
from itertools import product
from urllib.request import urlopen

import pytest

from clean_swarm_env.recording.file import blocks_in
from clean_swarm_env.recording.reader import RecordedMission, RecordedParts, frames_from
from tests.paths import ROOT
from tests.train.commands import refused
from tests.train.live.sessions import SMALL, asked, ordered, play_of, served
from train.live.session import Session


def test_requests_without_the_token_are_refused(session):
    with served(session) as server:
        requests = (("", None), ("events", None), ("stream", None), ("do", b'{"do": "step"}'))
        for (path, body), token in product(requests, ("", "x", server.token[:-1], "c3a9")):
            status, content = asked(server, path, body, token=token)
            assert status == 403
            assert "expected the address that `clean-swarm play` has printed" in json.loads(content)["error"]
        assert session.ticks == 0
        assert asked(server, "")[0] == 200
        assert asked(server, "other")[0] == 404


def test_only_this_machine_can_connect(session):
    with served(session) as server:
        address, port = server.socket.getsockname()
        assert address == "127.0.0.1"
        own = {found[4][0] for found in socket.getaddrinfo(socket.gethostname(), None, socket.AF_INET)}
        for other in {"127.0.0.2", *own} - {"127.0.0.1"}:
            with pytest.raises(OSError, match="refused"):
                socket.create_connection((other, port), timeout=5)


def test_a_port_in_use_is_one_line(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
        line = refused("play", "table1", "--port", port, "--no-browser")
    assert line == f"error: --port: {port} is in use; expected a free port, or 0 for any\n"
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (("crowdet",), "unknown mission, family, experiment or task 'crowdet'"),
        (("table1", "--speed", "0"), "speed: expected a number from 0.01 to 1000"),
        (("table1", "--strategy", "policy:none"), "none"),
        (("table1", "--strategy", "fixed:ORCA"), "in the knowledge avoidance, exploring, transport (--knowledge)"),
        (("table1", "--strategy", "fsm:rule"), "it is in the knowledge avoidance, repulsion (--knowledge)"),
        (("table1", "--knowledge", "none"), "unknown expert knowledge 'none'"),
        (("none.swarm", "--knowledge", "avoidance"), "--knowledge: expected none, because the recording has its own"),
        (("table1", "--port", "70000"), "--port: expected a whole number of at most 65535, got 70000"),
        (("none.swarm",), "none.swarm: cannot be read"),
        (("table1", "--output", "there.swarm"), "--output: there.swarm exists already"),
    ],
)
def test_bad_input_is_one_line(tmp_path, monkeypatch, words, expected):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "there.swarm").write_bytes(b"")
    assert expected in refused("play", *words, "--no-browser")
    assert [path.name for path in tmp_path.iterdir()] == ["there.swarm"]


def test_orders_are_carried_out_or_refused_in_one_line(session):
    with served(session) as server:
        assert [ordered(server, do="step") for _ in range(2)] == ["", ""]
        assert session.ticks == 2
        assert ordered(server, do="put_robot", robot=99, x=1.0, y=1.0) == "robot 99: expected a robot that is there"
        for speed in (-1, "fast"):
            assert "speed: expected a number from 0.01 to 1000" in ordered(server, do="speed", speed=speed)
        for body in (b"", b"[]", b"{", b"\xff", b"[" * 99_999, b" " * 200_000):
            status, content = asked(server, "do", body)
            assert status == 400, body[:10]
            assert len(json.loads(content)["error"].splitlines()) == 1
        assert ordered(server, do="add_item", x=1.0, y=1.0) == ""
        with urlopen(server.address.replace("/?", "/stream?"), timeout=60) as source:
            frames = frames_from(RecordedParts(blocks_in(source, "stream"), "stream"))
            assert ordered(server, do="play") == ""
            for _ in range(5):
                next(frames)
        assert ordered(server, do="pause") == ""
        ticks = session.ticks
        time.sleep(0.5)  # more than two periods
        assert session.ticks == ticks


@pytest.mark.long
def test_a_reader_that_sleeps_slows_nobody_and_misses_nothing(tmp_path):
    """One client does not read while the run goes on to its end, long after the buffers of its connection are full."""
    changes = {**SMALL, "task": {"garbage": {"count": 8, "respawn": 5.0}}, "time_limit": 100.0}
    session = Session(play_of(changes), tmp_path / "a.swarm")
    room = 8192
    with served(session, speed=1000.0) as server, socket.socket() as sleeping:
        server.socket.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, room)
        sleeping.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, room)
        sleeping.connect(server.server_address)
        sleeping.sendall(f"GET /stream?token={server.token} HTTP/1.1\r\nHost: localhost\r\n\r\n".encode())
        assert ordered(server, do="play") == ""
        with urlopen(server.address.replace("/?", "/stream?")) as source:
            assert frames_until_the_end(source) == 500
        sent = sum(map(len, server.conductor.stream.after(0, None, 0.0)))
        assert sent > 20 * 2 * room  # the sender has been waiting for the sleeping one nearly all the time
        woken = sleeping.makefile("rb")
        while woken.readline().strip():
            pass  # the head of the answer
        assert frames_until_the_end(woken) == 500


def frames_until_the_end(source) -> int:
    parts = RecordedParts(blocks_in(source, "stream"), "stream")
    for _ in parts:
        if parts.frames == 500:
            break
    return parts.frames


@pytest.mark.long
def test_ctrl_c_ends_it_and_the_recording_is_whole(tmp_path):
    words = ("play", "table1", "--no-browser", "--output", "a.swarm", "--no-minds")
    command = [sys.executable, "-c", "from train.cli import main; main()", *words]
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    process = subprocess.Popen(command, cwd=tmp_path, env=environment, start_new_session=True, **pipes)
    address = process.stdout.readline().strip()
    urlopen(address.replace("/?", "/do?"), json.dumps({"do": "play"}).encode()).close()  # no page does
    with urlopen(address.replace("/?", "/stream?")) as source:
        frames = frames_from(RecordedParts(blocks_in(source, "stream"), "stream"))
        for _ in range(10):
            next(frames)
    os.kill(process.pid, signal.SIGINT)
    out, err = process.communicate(timeout=60)
    assert process.returncode == 130
    assert "steps in a.swarm; the same again: clean-swarm play a.swarm" in out
    assert "Traceback" not in err
    assert RecordedMission(tmp_path / "a.swarm").frames >= 10
