"""The conductor of a session: runs it at a speed, pauses it, carries out orders, and tells readers what happens."""

from __future__ import annotations

import queue
import threading
from base64 import b64encode
from collections.abc import Callable, Mapping
from concurrent.futures import Future
from time import monotonic
from typing import Any, Final

from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.deciders.named import without_digest
from selector.documents.plain import plain, short
from train.live.session import Session

LEAST_SPEED: Final = 0.01
"""Smallest speed: a control period in 20 s."""
MOST_SPEED: Final = 1000.0
"""Largest speed; above its limit the machine runs as fast as it can."""
MOST_LATE: Final = 0.2
"""A session that is later than this does not catch up [s]."""
LOOKING: Final = 0.2
"""Time after which a session that waits looks whether it has been closed [s]."""
ANSWER: Final = 30.0
"""Longest time that an answer takes [s]: a control period, and the orders before."""
RUNNING_ORDERS: Final = ("play", "pause", "step", "speed", "open")


class Stream:
    """Blocks that one writer appends and readers fetch; a slow or sleeping reader delays no other.

    Attributes:
        state: how the session runs, plain data.

    """

    def __init__(self, beginning: bytes, state: Mapping[str, Any]) -> None:
        self._blocks = [beginning]
        self.state = state
        self._changed = threading.Condition()
        self.ended = False

    def tell(self, *blocks: bytes, state: Mapping[str, Any] | None = None, ended: bool = False) -> None:
        """Append blocks, replace the state if one is given, or tell all readers that nothing more comes."""
        with self._changed:
            self._blocks += blocks
            self.state = self.state if state is None else state
            self.ended = ended
            self._changed.notify_all()

    def after(self, read: int, state: Mapping[str, Any] | None, seconds: float) -> list[bytes]:
        """Return the blocks after the first `read` ones; wait up to `seconds` for a new block or another state."""
        with self._changed:
            self._changed.wait_for(
                lambda: len(self._blocks) > read or self.state is not state or self.ended, timeout=seconds
            )
            return self._blocks[read:]


class Conductor:
    """Runs a session in one thread; other threads give orders.

    Args:
        sessions: name of a mission, family or goal -> what opens a session of it; the first one has the name "".
        speed: seconds of the mission in a second.
        playing: whether each session runs as soon as a page shows it; else it waits for an order.

    Attributes:
        session: what is run; only the thread of `run` touches it.
        stream: what happens in it.

    """

    def __init__(self, sessions: Mapping[str, Callable[[], Session]], speed: float, *, playing: bool = True) -> None:
        self._sessions, self._speed, self._at_once = sessions, speed, playing
        self._orders: queue.Queue[tuple[Mapping[str, Any], Future[Mapping[str, Any]]]] = queue.Queue()
        self._closed, self._number, self._failure = False, 0, ""
        self._open("", "")

    def order(self, order: Mapping[str, Any]) -> Mapping[str, Any]:
        """Have an order carried out: one of `RUNNING_ORDERS`, such as `{"do": "play"}`, or a change by hand; answer it.

        ValueError, of one line, says what is impossible. May be called from any thread but that of `run`.
        """
        answer: Future[Mapping[str, Any]] = Future()
        self._orders.put((order, answer))
        return answer.result(ANSWER)

    def close(self) -> None:
        """Make `run` return."""
        self._closed = True

    def run(self) -> None:
        """Run the session until `close` is called or an exception (Ctrl-C) ends it; then end stream and recording."""
        latest = monotonic()
        try:
            while not self._closed:
                due = latest + self.session.period / self._speed
                wait = min(due - monotonic(), LOOKING) if self._playing else LOOKING
                try:
                    self._obey(*self._orders.get(timeout=wait) if wait > 0.0 else self._orders.get_nowait())
                except queue.Empty:
                    if self._playing and monotonic() >= due:
                        self._tick()
                        latest = max(due, monotonic() - MOST_LATE)
        finally:
            self._end()
            while not self._orders.empty():
                self._orders.get()[1].set_exception(ValueError("the session has ended"))

    def _obey(self, order: Mapping[str, Any], answer: Future[Mapping[str, Any]]) -> None:
        try:
            told = self._carry_out(order)
        except Exception as error:  # a mistake of ours in an order is shown, and ends no session
            answer.set_exception(error if isinstance(error, ValueError) else ValueError(failed("the order", error)))
        else:
            answer.set_result(told)

    def _carry_out(self, order: Mapping[str, Any]) -> Mapping[str, Any]:
        """Carry out an order; return what it asked for."""
        kind = order.get("do")
        if kind == "open":
            self._open(order.get("name"), order.get("strategy", ""))
        elif self._failure:
            raise ValueError(self._failure)
        elif kind == "what_if":
            return {"options": self.session.what_if(order.get("robot"))}
        elif kind not in RUNNING_ORDERS:
            self.session.do(order)
        elif kind == "speed":
            self._speed = checked_speed(order.get("speed"))
        elif self.session.result is not None:
            raise ValueError("the mission is over")
        elif kind == "step":
            self._playing = False
            self._tick()
            if self._failure:
                raise ValueError(self._failure)
        else:
            self._playing = kind == "play"
        self.stream.tell(state=self._state())
        return {}

    def _open(self, name: object, strategy: object) -> None:
        """Run a session in place of the present one, which goes on if the other one cannot be had.

        Robots follow a `strategy` from the start on, the session's own if it is "".
        """
        if not isinstance(name, str) or name not in self._sessions:
            raise ConfigurationError(f"open: expected one of {list(self._sessions)}, got {short(name)}")
        session = self._sessions[name]()
        try:
            if strategy != "":
                session.do({"do": "follow_strategy", "strategy": strategy})
        except ValueError:
            session.close()
            raise
        try:
            if self._number:
                self._end()
        finally:  # also where the recording of the one before cannot be ended
            self.session: Session = session
            self._name: str = name
            self._number, self._playing = self._number + 1, False
            self._offered = {**session.offered(), "missions": [name for name in self._sessions if name]}
            self._failure = ""
            self.stream = Stream(session.beginning, self._state())

    def _end(self) -> None:
        self.stream.tell(ended=True)
        self.session.close()

    def _tick(self) -> None:
        try:
            self.stream.tell(self.session.tick())
        except Exception as error:  # a mistake of ours, or a full disk: this session cannot go on, another one can
            self._failure, self._playing = failed("the mission", error), False
            self.stream.tell(state={**self.stream.state, "playing": False, "over": True, "failure": self._failure})
            return
        if self.session.result is not None:
            self._playing = False
            self.stream.tell(state=self._state())

    def _state(self) -> dict[str, Any]:
        """Return what the page shows beside the frames; `now` is a frame of the present, before the next one is run.

        `begins`: whether the page orders to play as soon as somebody sees it.
        """
        return {
            "number": self._number,
            "begins": self._at_once,
            "name": self._name,
            "playing": self._playing,
            "speed": self._speed,
            "over": self.session.result is not None,
            "failure": self._failure,
            "now": b64encode(self.session.present()).decode(),
            **self._offered,
            "strategy": without_digest(self.session.strategy),
            "loss": float(self.session.worlds.minds.reception.losses[0]),
        }


def failed(what: str, error: Exception) -> str:
    """Return the line that says that something failed."""
    return f"{what} failed: {type(error).__name__}: {plain(str(error))}"


def checked_speed(speed: object) -> float:
    """Return a speed, mission time over time; ConfigurationError if it is none."""
    if isinstance(speed, bool) or not isinstance(speed, int | float) or not LEAST_SPEED <= speed <= MOST_SPEED:
        raise ConfigurationError(f"speed: expected a number from {LEAST_SPEED:g} to {MOST_SPEED:g}, got {short(speed)}")
    return float(speed)
