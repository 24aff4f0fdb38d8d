"""How robots may choose their avoidance by the conflicts that they have: two ways of the literature, with our terms.

`EffortLadder` climbs a ladder of options while there are conflicts, in the manner of Rosenfeld, Kaminka, Kraus and
Shehory (2008), Artificial Intelligence 172, 633-655. `AtMeetings` lets robots choose when they meet somebody, and learn
from what the time since the last meeting has cost, in the manner of Kaminka and Douchan (2025),
doi:10.3389/frobt.2024.1426282. We know both by their abstracts only: rungs, numbers, and what a meeting is, are ours.

    python -m docs.comparison.prior.write    # how both fare
"""

from typing import Any

import numpy as np

from selector.documents.arrays import Arrays
from selector.documents.fields import NonNegative
from selector.strategies.choosing import drawn
from selector.strategies.problem import Decisions, Outcomes, Problem
from selector.strategies.registry import STRATEGIES
from selector.strategies.strategy import DecisionStrategy
from selector.strategies.streams import row_keys
from selforg.arrays import Flags, Floats, Ints

NO_RUNG = 1e9
"""Rung of an option that is not on the ladder: it is taken only where no other can serve."""


@STRATEGIES.register
class EffortLadder(DecisionStrategy):
    """Climb a ladder of options while there are conflicts, and slowly come down without any.

    A reward is the share of a decision period that conflicts took, as a negative number.
    """

    rungs: str = "Off/PredictiveSteering/ORCA/ORCA-distance0.8"
    """Options from the least effort to the most."""
    up: NonNegative = 1.0
    """Rungs by which a period climbs that conflicts took as a whole [-]."""
    down: NonNegative = 0.05
    """Rungs by which each period comes down [-]."""
    effort: Floats  # (G,) place on the ladder

    @classmethod
    def example(cls, problem: Problem) -> dict[str, Any]:
        """Return a ladder of all options."""
        return {"rungs": "/".join(problem.options)}

    def _prepare(self) -> None:
        ladder, known = self.rungs.split("/"), self.problem.options
        self.problem.check_options("EffortLadder: rungs", ladder)
        self._top = len(ladder) - 1
        self._rung_of: Floats = np.array([ladder.index(name) if name in ladder else NO_RUNG for name in known])

    def _first_state(self) -> Arrays:
        return {"effort": np.zeros(self.groups)}

    def _select(self, decisions: Decisions) -> Ints:
        wanted = np.floor(self.effort[decisions.groups, None])
        away = np.where(decisions.allowed, np.abs(self._rung_of - wanted), np.inf)
        nearest: Ints = away.argmin(axis=1)
        return nearest

    def _update(self, outcomes: Outcomes) -> None:
        paid = np.bincount(outcomes.groups, minlength=self.groups)
        conflicts = np.bincount(outcomes.groups, -outcomes.reward, self.groups) / np.maximum(paid, 1)
        climbed = np.clip(self.effort + self.up * conflicts - self.down, 0.0, self._top)
        self.effort[:] = np.where(paid > 0, climbed, self.effort)


@STRATEGIES.register
class ByShares(DecisionStrategy):
    """Each row draws an option by chances of its own (R, O), equal ones unless `chances` is set."""

    chances: Floats
    draws_per_decision = 1

    def _prepare(self) -> None:
        self.chances = np.ones((self.rows, self.options))

    def _select(self, decisions: Decisions) -> Ints:
        return drawn(self.chances[decisions.rows] * decisions.allowed, decisions.draws[:, 0])


class AtMeetings:
    """The options of all robots (R,), who choose anew when they meet somebody, or in each period.

    Args:
        strategy: chooses, and is paid at the end of a stage: its mean cost for a period, as a negative number.
        least: least number of periods of a stage; 0: each period is a stage, whether somebody is met or not.

    Attributes:
        options: (R,) the options that robots hold.

    """

    def __init__(self, strategy: DecisionStrategy, least: int) -> None:
        self._strategy, self._least = strategy, least
        self.options: Ints = np.zeros(strategy.rows, dtype=np.int64)
        self._periods, self._cost = np.zeros(strategy.rows), np.zeros(strategy.rows)

    def reset(self, rows: Ints, seed: int) -> None:
        """Let rows (N,) begin a mission; what they have learned stays."""
        self._strategy.reseed(rows, row_keys(np.random.SeedSequence([seed, 1]), len(rows)))
        self._choose(rows)

    def go_on(self, met: Flags, costs: Floats) -> None:
        """Count a period with its costs (R,); where a stage ends, learn from it and choose."""
        self._periods += 1.0
        self._cost += costs
        rows = np.flatnonzero((self._periods >= self._least) & (met | (self._least == 0)))
        reward = -self._cost[rows] / self._periods[rows]
        self._strategy.update(self.options[rows], reward, np.zeros((len(rows), 0)), rows)
        self._choose(rows)

    def _choose(self, rows: Ints) -> None:
        self.options[rows] = self._strategy.select(np.zeros((len(rows), 0)), rows=rows)
        self._periods[rows] = self._cost[rows] = 0.0
