"""Sessions for the tests: six robots, eight items."""

import json
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any
from urllib.error import HTTPError
from urllib.request import Request, urlopen

from clean_swarm_env.config.families import Scenario
from clean_swarm_env.config.load import load_mission, with_changes
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.starts import random_start
from train.live.chosen import PlayedMission, with_room
from train.live.conductor import Conductor
from train.live.server import LiveServer
from train.live.session import Session
from train.replay.page_file import live_page

SMALL = {"robots": {"count": 6}, "task": {"garbage": {"count": 8}}, "knowledge": "avoidance", "time_limit": 120.0}


def play_of(changes: Mapping[str, Any], strategy: str = "MaxScore") -> PlayedMission:
    """Return the play of a mission with `changes` of that of Table 1."""
    mission = with_room(MissionConfig.model_validate(with_changes(load_mission("table1").model_dump(), changes)))
    start = random_start(mission, 5, 0)
    return PlayedMission("small", Scenario(start.id, 11, mission, start), strategy)


def only_once() -> Session:
    raise ValueError("there is one session only")


@contextmanager
def served(
    session: Session,
    speed: float = 5.0,
    *,
    playing: bool = False,
    port: int = 0,
    others: Mapping[str, Callable[[], Session]] | None = None,
) -> Iterator[LiveServer]:
    """Run and serve a session in threads; `others` open further ones, "" the same again."""
    first, further = iter([session]), {"": only_once, **(others or {})}
    conductor = Conductor({**further, "": lambda: next(first, None) or further[""]()}, speed, playing=playing)
    runner = threading.Thread(target=conductor.run)
    with LiveServer(port) as server:
        server.start(conductor, live_page())
        runner.start()
        try:
            yield server
        finally:
            conductor.close()
            runner.join()
            server.shutdown()


def asked(server: LiveServer, path: str, body: bytes | None = None, token: str | None = None) -> tuple[int, bytes]:
    """Return status and content of an answer; `token` in place of the right one."""
    address = f"{server.address.partition('?')[0]}{path}?token={server.token if token is None else token}"
    try:
        with urlopen(Request(address, body), timeout=60) as answer:
            return answer.status, answer.read()
    except HTTPError as error:
        return error.code, error.read()


def ordered(server: LiveServer, **order: object) -> str:
    """Give an order; return why it was refused, nothing if it was carried out."""
    return str(json.loads(asked(server, "do", json.dumps(order).encode())[1]).get("error", ""))
