"""Which broadcasts count: the rules for those that come late, twice, in the wrong order, or from nobody known."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import Final

from clean_swarm_env.robots.sensed import Broadcast

OLDEST: Final = 60.0
"""Age up to which a broadcast counts [s]; the longest delay that a mission may have."""
EARLIEST: Final = 1.0
"""By how much the clock of another robot may go fast [s]."""
SILENCE: Final = 2.0
"""Time without a newer broadcast of a robot after which one that seems older counts [s]."""


class Ear:
    """Decides which broadcasts of a team one robot listens to.

    - *Late* ones, older than OLDEST, do not count: deposits have evaporated, poses are forgotten long before.
    - *Early* ones, from more than EARLIEST ahead, do not count: that clock is wrong.
    - *Old* ones, which come twice or after a newer one of the same robot, do not count, as if they were lost.
    - A robot that *restarted with an old clock* counts again once nothing newer has come from it for SILENCE. So no
      single broadcast, however wrong, can silence a robot for longer.
    - Robots that are not of the team, and the own name, do not count.

    Where within SILENCE more robots were early than counted, it is the own clock that is wrong.

    Attributes:
        refused: how many broadcasts, or parts of them, did not count, by the reason.
        wrong_until: time up to which the own clock seems wrong [s].

    >>> ear = Ear(("robot_0", "robot_1"), "robot_0")
    >>> [ear.refuses(Broadcast("robot_1", sequence=n, stamp=0.2 * n), now=0.4) for n in (0, 2, 1, 2)]
    ['', '', 'old', 'old']

    """

    def __init__(self, robots: Sequence[str], own: str) -> None:
        self._newest = {name: (-OLDEST, -1) for name in robots if name != own}  # stamp [s] and number
        self._counted_at = dict.fromkeys(self._newest, -SILENCE)  # when the last one of each counted [s]
        self._early_at = dict(self._counted_at)  # when the last one of each was early [s]
        self.refused: Counter[str] = Counter()
        self.wrong_until = -SILENCE

    def refuses(self, said: Broadcast, now: float) -> str:
        """Return why a broadcast does not count at `now` [s], and count it in `refused`; empty if it counts."""
        why = self._reason(said, now)
        if why == "early":
            self._early_at[said.robot] = now
            early, counted = (
                sum(now - at < SILENCE for at in times.values()) for times in (self._early_at, self._counted_at)
            )
            agree = early > counted and early >= min(2, len(self._newest))  # one alone may be wrong itself
            self.wrong_until = now + SILENCE if agree else self.wrong_until
        if why:
            self.refused[why] += 1
        else:
            self._newest[said.robot], self._counted_at[said.robot] = (said.stamp, said.sequence), now
        return why

    def _reason(self, said: Broadcast, now: float) -> str:
        if said.robot not in self._newest:
            return "unknown"
        if said.stamp > now + EARLIEST:
            return "early"
        if not said.stamp >= now - OLDEST:
            return "late"
        newer = (said.stamp, said.sequence) > self._newest[said.robot]
        return "" if newer or now - self._counted_at[said.robot] > SILENCE else "old"
