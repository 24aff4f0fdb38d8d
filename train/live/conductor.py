"""The conductor of a session: runs it at a speed, pauses it, and carries out what people ask for meanwhile."""

from __future__ import annotations

import queue
from collections.abc import Mapping
from concurrent.futures import Future
from time import monotonic
from typing import Any, Final

from clean_swarm_env.config.errors import ConfigurationError
from selector.documents.plain import short
from train.live.session import Session
from train.live.stream import Stream

MOST_SPEED: Final = 1000.0
"""Largest speed; whatever the machine does not reach is as fast as it can."""
MOST_LATE: Final = 0.2
"""A session that is later than this does not catch up [s]."""
LOOKING: Final = 0.2
"""Time after which a paused session looks whether it has been closed [s]."""
ANSWER: Final = 30.0
"""Longest time that an answer takes [s]: a control period, and the orders before."""
RUNNING_ORDERS: Final = ("play", "pause", "step", "speed")


class Conductor:
    """Runs a session in one thread; other threads give orders.

    Attributes:
        session: what is run; only the thread of `run` touches it.
        stream: what happens.

    """

    def __init__(self, session: Session, speed: float, *, playing: bool = True) -> None:
        self.session, self._speed, self._playing = session, speed, playing
        self._orders: queue.Queue[tuple[Mapping[str, Any], Future[None]]] = queue.Queue()
        self.stream = Stream(session.beginning, self._state())
        self._closed = False

    def order(self, order: Mapping[str, Any]) -> None:
        """Have an order carried out: `{"do": "play"}`, `pause`, `step`, `speed`, or a change by hand.

        ValueError, of one line, says what is impossible. May be called from any thread but that of `run`.
        """
        answer: Future[None] = Future()
        self._orders.put((order, answer))
        answer.result(ANSWER)

    def close(self) -> None:
        """Make `run` return."""
        self._closed = True

    def run(self) -> None:
        """Run the session until `close` is called or an exception (Ctrl-C) ends it; then end stream and recording."""
        due = monotonic()
        try:
            while not self._closed:
                wait = due - monotonic() if self._playing else LOOKING
                try:
                    self._obey(*self._orders.get(timeout=wait) if wait > 0.0 else self._orders.get_nowait())
                except queue.Empty:
                    if self._playing:
                        self._tick()
                        due = max(due + self.session.period / self._speed, monotonic() - MOST_LATE)
        finally:
            self.stream.end()
            self.session.close()
            while not self._orders.empty():
                self._orders.get()[1].set_exception(ValueError("the session has ended"))

    def _obey(self, order: Mapping[str, Any], answer: Future[None]) -> None:
        try:
            self._carry_out(order)
        except ValueError as error:
            answer.set_exception(error)
        else:
            answer.set_result(None)

    def _carry_out(self, order: Mapping[str, Any]) -> None:
        kind = order.get("do")
        if kind not in RUNNING_ORDERS:
            self.session.do(order)
        elif kind == "speed":
            self._speed = checked_speed(order.get("speed"))
        elif self.session.result is not None:
            raise ValueError("the mission is over")
        elif kind == "step":
            self._playing = False
            self._tick()
        else:
            self._playing = kind == "play"
        self.stream.tell(self._state())

    def _tick(self) -> None:
        self.stream.add(self.session.tick())
        if self.session.result is not None:
            self._playing = False
            self.stream.tell(self._state())

    def _state(self) -> dict[str, Any]:
        over = self.session.result is not None
        return {"playing": self._playing, "speed": self._speed, "over": over, **self.session.facts()}


def checked_speed(speed: object) -> float:
    """Return a speed, mission time over time; ConfigurationError if it is none."""
    if isinstance(speed, bool) or not isinstance(speed, int | float) or not 0.0 < speed <= MOST_SPEED:
        raise ConfigurationError(f"speed: expected a number above 0 and up to {MOST_SPEED:g}, got {short(speed)}")
    return float(speed)
