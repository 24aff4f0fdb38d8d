"""Which broadcasts count: the rules for those that come late, twice, in the wrong order, or from nobody known."""

from __future__ import annotations

from collections import Counter, deque
from collections.abc import Sequence
from typing import Final

from clean_swarm_env.robots.sensed import Broadcast

OLDEST: Final = 60.0
"""Age up to which a broadcast counts [s]; the longest delay that a mission may have."""
EARLIEST: Final = 1.0
"""By how much the clock of another robot may go fast [s]."""
SESSIONS: Final = 8
"""Sessions of a robot that are remembered."""


class Ear:
    """Decides which broadcasts of a team one robot listens to.

    - *Late* ones, older than OLDEST, do not count: deposits have evaporated, poses are forgotten long before.
    - *Early* ones, from more than EARLIEST ahead, do not count: that clock is wrong.
    - What comes *twice or after a newer one* of the same robot counts once or not at all, as if it were lost.
    - *A new session* of a robot ends its old one: what still comes of that does not count any more. The clock of a
      robot that restarted may be behind its old one; its broadcasts are as late as they say.
    - Robots that are not of the team, and the own name, do not count.

    Attributes:
        refused: how many broadcasts, or parts of them, did not count, by the reason.

    >>> ear = Ear(("robot_0", "robot_1"), "robot_0")
    >>> [ear.refuses(Broadcast("robot_1", session=7, sequence=n, stamp=0.2 * n), now=0.4) for n in (0, 2, 1, 2)]
    ['', '', 'twice', 'twice']

    """

    def __init__(self, robots: Sequence[str], own: str) -> None:
        self._sessions = {name: deque([-1], maxlen=SESSIONS) for name in robots if name != own}  # the newest last
        self._newest = dict.fromkeys(self._sessions, -1)  # number of the newest broadcast in it
        self.refused: Counter[str] = Counter()

    def refuses(self, said: Broadcast, now: float) -> str:
        """Return why a broadcast does not count at `now` [s], and count it in `refused`; empty if it counts."""
        why = self._reason(said, now)
        if why:
            self.refused[why] += 1
        return why

    def _reason(self, said: Broadcast, now: float) -> str:
        if said.robot not in self._sessions:
            return "unknown"
        if said.stamp > now + EARLIEST:
            return "early"
        if not said.stamp >= now - OLDEST:
            return "late"
        sessions = self._sessions[said.robot]
        if said.session != sessions[-1]:
            if said.session in sessions:
                return "over"
            sessions.append(said.session)
        elif said.sequence <= self._newest[said.robot]:
            return "twice"
        self._newest[said.robot] = said.sequence
        return ""
