"""The input of a decision strategy: its problem, the decisions to make, and the rewards of earlier decisions."""

from collections.abc import Collection, Iterable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from selector.documents.plain import must_know
from selector.knowledge import Definitions, Knowledge, believed, must_know_option
from selforg.arrays import Flags, Floats, Ints


@dataclass(frozen=True)
class Problem:
    """A goal, the options that may serve it, and the features known at the time of a decision.

    Attributes:
        goal: name of the self-organisation goal.
        options: (O,) names of the options, at least one, each different.
        scores: (O,) the expert's scores, finite; learned ones where rewards are known, see `believed`.
        features: (F,) names of the components of a context, each different.
        rewards: (3, O) count, mean and variance of the rewards known at the beginning; zeros unless given, and
            where no reward is known.
        definitions: what names of options stand for, by the goals that are decided as one; none if nobody knows.

    Raises:
        ValueError: a name is given twice, the scores cannot be compared, or no rewards are such.

    """

    goal: str
    options: tuple[str, ...]
    scores: Floats
    features: tuple[str, ...] = ()
    rewards: Floats = field(default_factory=lambda: np.zeros((3, 1)))
    definitions: Definitions = field(default_factory=dict)

    def __post_init__(self) -> None:
        scores = np.array(self.scores, dtype=np.float64)
        rewards = np.array(np.broadcast_to(self.rewards, (3, len(self.options))), dtype=np.float64)
        expected = (len(self.options),)
        if not self.options:
            raise ValueError(f"goal {self.goal}: expected at least one option, got none")
        if scores.shape != expected:
            raise ValueError(f"goal {self.goal}: scores: expected shape {expected}, got {scores.shape}")
        if not np.isfinite(scores).all():
            raise ValueError(f"goal {self.goal}: scores: expected finite numbers, got {scores.tolist()}")
        for what, names in (("option", self.options), ("feature", self.features)):
            for name in names:
                if names.count(name) > 1:
                    raise ValueError(f"goal {self.goal}: {what} {name!r} is given twice")
        if not np.isfinite(rewards).all() or rewards[[0, 2]].min() < 0.0:
            got = rewards.tolist()
            raise ValueError(f"goal {self.goal}: rewards: expected counts and variances from 0 and means, got {got}")
        rewards[1:, rewards[0] == 0.0] = 0.0
        scores = believed(scores, rewards)
        for name, values in (("scores", scores), ("rewards", rewards)):
            values.flags.writeable = False
            object.__setattr__(self, name, values)

    def check_options(self, where: str, used: Iterable[str]) -> None:
        """Raise DocumentError, which begins with `where`, for the first name of `used` that is no option."""
        for name in used:
            must_know_option(self.goal, name, self.options, where)

    @classmethod
    def of(cls, knowledge: Knowledge, goal: str, features: tuple[str, ...] = ()) -> "Problem":
        """Return the problem of choosing among the options of a goal in expert knowledge."""
        meant = {option.name: option for option in knowledge.options(goal)}
        return cls(goal, tuple(meant), knowledge.scores(goal), features, knowledge.rewards(goal), {goal: meant})

    def only(self, options: tuple[str, ...]) -> "Problem":
        """Return the problem of choosing among some of the options, in this order."""
        kept = [self.options.index(name) for name in options]
        return replace(self, options=options, scores=self.scores[kept], rewards=self.rewards[:, kept])


@dataclass(frozen=True)
class Decisions:
    """K decisions to make now; no array may be written to.

    Attributes:
        rows: (K,) the rows that decide, each at most once.
        groups: (K,) the set of estimates that each row uses.
        context: (K, F) features of each row.
        allowed: (K, O) options that can serve; at least one in each row.
        draws: (K, D) random numbers, uniform in [0, 1).

    """

    rows: Ints
    groups: Ints
    context: Floats
    allowed: Flags
    draws: Floats


@dataclass(frozen=True)
class Outcomes:
    """K earlier decisions and their rewards, in an order that does not depend on the order of rows.

    Attributes:
        groups: (K,) the set of estimates that each decision changes.
        option: (K,) the chosen option.
        reward: (K,) its reward; larger is better.
        context: (K, F) the features at the decision.
        chance: (K,) the probability with which the option was chosen; 1 if the strategy is not random.

    """

    groups: Ints
    option: Ints
    reward: Floats
    context: Floats
    chance: Floats


def readable(name: str, values: npt.ArrayLike, shape: tuple[int, ...]) -> Floats:
    """Return finite numbers of a given shape as an array that cannot be written to."""
    array = np.asarray(values, dtype=np.float64).view()
    if array.shape != shape:
        raise ValueError(f"{name}: expected shape {shape}, got {array.shape}")
    if not np.isfinite(array).all():
        raise ValueError(f"{name}: expected finite numbers, got {array[~np.isfinite(array)][0]}")
    array.flags.writeable = False
    return array


def whole_numbers(name: str, values: npt.ArrayLike, shape: tuple[int, ...], what: str, count: int) -> Ints:
    """Return whole numbers from 0 to `count` - 1 of a given shape, as a copy that cannot be written to."""
    array: npt.NDArray[Any] = np.asarray(values)
    if array.shape != shape or not (np.issubdtype(array.dtype, np.integer) or array.size == 0):
        raise ValueError(f"{name}: expected integers {shape}, got {array.shape} of {array.dtype}")
    numbers = array.astype(np.int64)
    if array.size and (numbers.min() < 0 or numbers.max() >= count):
        raise ValueError(f"{name}: expected {what} 0..{count - 1}, got {numbers.min()}..{numbers.max()}")
    numbers.flags.writeable = False
    return numbers


def must_know_component(name: str, known: Collection[str], where: str) -> None:
    """Raise DocumentError for an unknown component of the observation; those of a fact need robots that declare it."""
    hint = "; it is there where the robots' document declares the fact"
    must_know("component", name, known, where, hint * name.startswith(("heard_", "age_of_")))
