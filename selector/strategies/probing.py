"""Probing: robots that try another option than the one that a machine or a policy thinks best, so that all learn."""

from typing import Annotated, Self

import numpy as np
import numpy.typing as npt
from pydantic import Field, model_validator

from selector.documents.errors import impossible
from selector.documents.fields import Closed, Flag, JointName, Name, Share
from selector.documents.plain import must_fit, must_know
from selector.strategies.choosing import drawn, shares
from selector.strategies.problem import Problem, must_know_component
from selector.strategies.streams import Keys, row_keys, uniforms
from selforg.arrays import Flags, Floats, Ints


class Probing(Closed):
    """Which robots try another option, and when."""

    probability: Share = 0.0
    """Probability in each decision that a robot takes another option than it would, each equally likely [-]."""
    robots: Annotated[int, Field(strict=True, ge=0, le=100_000)] = 0
    """How many robots of a team, its first ones, hold `option` until they have heard."""
    option: JointName | None = None
    """The option that they hold."""
    until: Name | None = None
    """Component of the observation; they hold the option while it is at most 0.5."""
    sampled: Flag = False
    """Whether a policy takes each option with the probability that it gives it, in place of the likeliest."""

    @model_validator(mode="after")
    def _together(self) -> Self:
        given = [bool(self.robots), self.option is not None, self.until is not None]
        if any(given) and not all(given):
            raise impossible("robots", "robots, option and until together", f"{sum(given)} of them")
        return self


def check_probing(robots: int, least: int) -> None:
    """Raise DocumentError if more robots are to try another option than the `least` that a team has."""
    must_fit(robots <= least, "probing.robots", f"at most {least}, the robots of the smallest team", robots)


class Prober:
    """Lets some of R rows try other options, by random numbers of their own.

    Args:
        probing: who tries what.
        problem: has the option and the component that `probing` names.
        teams: (R,) number of the team of each row.

    Raises:
        DocumentError: the problem has none of that name, or a team has fewer robots than begin otherwise.

    Attributes:
        probing: who tries what.

    """

    def __init__(self, probing: Probing, problem: Problem, teams: Ints) -> None:
        rows, least = len(teams), int(np.unique(teams, return_counts=True)[1].min(initial=len(teams)))
        self.probing, self._first = probing, np.zeros(rows, dtype=np.bool_)
        self._keys: Keys = row_keys(np.random.SeedSequence(0), rows)
        self._decided: Keys = np.zeros(rows, dtype=np.uint64)
        check_probing(probing.robots, least)
        if probing.option is not None:
            must_know("option", probing.option, problem.options, "probing")
        if probing.until is not None:
            must_know_component(probing.until, problem.features, "probing")
        named = (probing.option, problem.options), (probing.until, problem.features)
        self._places = [names.index(name) for name, names in named if name is not None]

    def reset(self, rows: Ints, seed: int) -> None:
        """Give `rows` (N,), those of a team, new keys."""
        self._keys[rows], self._decided[rows] = row_keys(np.random.SeedSequence([seed, 2]), len(rows)), 0
        self._first[rows] = np.arange(len(rows)) < self.probing.robots

    def choose(self, best: Ints, known: Flags, outputs: Floats | None = None) -> Ints:
        """Return the column `best` (R,) of O, or in its place one that the robot tries, of those `known`.

        known: (R, O) or (O,). `outputs` (R, O) are the logarithms of probabilities, by which robots sample.
        """
        sampled = outputs if self.probing.sampled else None
        if sampled is None and not self.probing.probability:
            return best
        likely = np.eye(known.shape[-1])[best]
        others = known & (likely == 0.0)
        tried = self.probing.probability * others.any(axis=1, keepdims=True)
        chances = (1.0 - tried) * (likely if sampled is None else shares(sampled))
        chances += tried * others / np.maximum(others.sum(axis=1, keepdims=True), 1)
        self._decided += np.uint64(1)
        return drawn(chances, uniforms(self._keys, self._decided, 1)[:, 0])

    def held(self, options: Ints, observations: npt.NDArray[np.floating]) -> Ints:
        """Return `options` (R,), or the option with which some begin until they see in `observations` (R, F) to end."""
        if not self.probing.robots:
            return options
        return np.where(self._first & (observations[:, self._places[1]] <= 0.5), self._places[0], options)
