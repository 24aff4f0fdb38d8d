"""The blueprint of decision strategies: which option serves a goal now, for many robots at once."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar, final

import numpy as np
import numpy.typing as npt

from selector.documents.arrays import Arrays
from selector.documents.errors import validated
from selector.documents.fields import Closed
from selector.strategies.problem import Decisions, Outcomes, Problem, canonical_order, readable, whole_numbers
from selector.strategies.streams import Keys, uniforms
from selforg.arrays import Flags, Floats, Ints


class NoParameters(Closed):
    """A strategy without anything to set."""


class DecisionStrategy(ABC):
    """Choose one of O options for each of R rows, and learn from the reward that the choice brought.

    `select` is called once a decision period, for all rows or those that decide; `update` once the reward of an earlier
    choice is known, however late, with the context in which it was made. A new strategy is one file with a class that
    implements `_select` and `_update`, and, if it learns, `_first_state`; what it may set is a model of its own:

    >>> import numpy as np
    >>> from selector.strategies.registry import STRATEGIES, create
    >>> @STRATEGIES.register
    ... class LastReward(DecisionStrategy):
    ...     last: Floats
    ...
    ...     def _first_state(self):
    ...         return {"last": np.tile(self.problem.scores, (self.groups, 1))}
    ...
    ...     def _select(self, decisions):
    ...         return np.where(decisions.allowed, self.last[decisions.groups], -np.inf).argmax(axis=1)
    ...
    ...     def _update(self, outcomes):
    ...         self.last[outcomes.groups, outcomes.option] = outcomes.reward
    >>> problem = Problem("AvoidCollision", ("Fernandez", "Gradient"), np.array([1.0, 0.5]))
    >>> strategy = create("LastReward", problem, keys=np.arange(3, dtype=np.uint64))
    >>> strategy.update(np.zeros(3, int), np.full(3, -1.0), np.zeros((3, 0)))
    >>> strategy.select(np.zeros((3, 0)))
    array([1, 1, 1])

    What a strategy has learned is the arrays of `_first_state`, whose first axis is the group: rows of one group share
    estimates. Random numbers are a function of a row's key and of how often it decided, so that a row decides alike
    alone and in a batch; a subclass that needs them says how many in `draws_per_decision`.

    Args:
        problem: goal, options, scores and names of the features.
        keys: (R,) the source of randomness of each row, from `selector.strategies.streams.row_keys`.
        parameters: values for the fields of `Parameters`.
        groups: (R,) 0..G-1, the set of estimates that each row uses; all rows share one unless given.
        directories: of the user's configurations, searched before the shipped one for files that parameters name.

    """

    Parameters: ClassVar[type[Closed]] = NoParameters
    """What can be set, with a default for everything that has a sensible one."""

    def __init__(
        self,
        problem: Problem,
        keys: Keys,
        parameters: Mapping[str, Any] | None = None,
        *,
        groups: Ints | None = None,
        directories: Sequence[Path] = (),
    ) -> None:
        self.problem = problem
        self.directories = directories
        self.parameters = validated(self.Parameters, dict(parameters or {}), f"strategy {type(self).__name__}")
        self.options, self.features, self.rows = len(problem.options), len(problem.features), len(keys)
        self.group_of: Ints = whole_numbers(
            "groups", np.zeros(self.rows, np.int64) if groups is None else groups, (self.rows,), "groups", self.rows
        )
        self.groups = 1 + int(self.group_of.max(initial=0))
        self.keys: Keys = np.array(keys, dtype=np.uint64)
        self.counters: Keys = np.zeros(self.rows, dtype=np.uint64)
        self.chance: Floats = np.ones(self.rows)
        self._prepare()
        first = self._first_state()
        self.state_names = tuple(first)
        for name, array in first.items():
            setattr(self, name, array)

    @classmethod
    def example(cls, problem: Problem) -> dict[str, Any]:
        """Return the parameters with which the contract tests build the class for a problem."""
        return {}

    @property
    def draws_per_decision(self) -> int:
        """Random numbers that one row takes for one decision."""
        return 0

    @final
    def select(self, context: Floats, allowed: Flags | None = None, rows: Ints | None = None) -> Ints:
        """Return the option (K,) for each row of `context` (K, F).

        Args:
            context: (K, F) what each row knows.
            allowed: (K, O) options that can serve; all unless given.
            rows: (K,) the rows that decide, each once; all unless given.

        """
        deciding = self._rows(rows)
        if rows is not None and np.bincount(deciding, minlength=1).max() > 1:
            raise ValueError(f"rows: expected each row once, got {deciding.tolist()}")
        seen = readable("context", context, (len(deciding), self.features))
        can_serve = self._allowed(allowed, deciding)
        draws = uniforms(self.keys[deciding], self.counters[deciding], self.draws_per_decision)
        draws.flags.writeable = False
        groups = self.group_of[deciding]
        chosen = np.asarray(self._select(Decisions(deciding, groups, seen, can_serve, draws)))
        self.counters[deciding] += np.uint64(1)
        name = f"{type(self).__name__}._select"
        options = whole_numbers(name, chosen, (len(deciding),), "options", self.options).copy()
        served = np.take_along_axis(can_serve, options[:, None], axis=1)[:, 0]
        if not served.all():
            raise ValueError(f"{name}: option {options[~served][0]} cannot serve row {deciding[~served][0]}")
        return options

    @final
    def update(
        self, option: Ints, reward: Floats, context: Floats, rows: Ints | None = None, chance: Floats | None = None
    ) -> None:
        """Learn that `option` (K,), chosen in `context` (K, F), brought `reward` (K,), larger being better.

        Args:
            option: (K,) what was chosen.
            reward: (K,) what it brought.
            context: (K, F) in which it was chosen.
            rows: (K,) the rows that chose, any of them more than once if several of its rewards come together.
            chance: (K,) the value of `chance[rows]` when the option was chosen; to be given for rewards that come after
                the row's next decision, else that of the row's last decision.

        """
        told = self._rows(rows)
        count = len(told)
        chosen = whole_numbers("option", option, (count,), "options", self.options)
        gained, seen = readable("reward", reward, (count,)), readable("context", context, (count, self.features))
        likely = readable("chance", self.chance[told] if chance is None else chance, (count,))
        if count and (likely.min() <= 0.0 or likely.max() > 1.0):
            raise ValueError(f"chance: expected probabilities above 0, got {likely.min()}..{likely.max()}")
        groups = self.group_of[told]
        order = canonical_order(groups, chosen, gained, likely, seen)
        outcomes = Outcomes(groups[order], chosen[order], gained[order], seen[order], likely[order])
        self._update(outcomes)

    @final
    def reseed(self, rows: Ints, keys: Keys) -> None:
        """Give `rows` (K,) new keys (K,); what was learned stays."""
        self.keys[rows] = keys
        self.counters[rows] = 0
        self.chance[rows] = 1.0

    @final
    def forget(self, groups: Ints) -> None:
        """Let `groups` (K,) begin anew, with the expert's scores."""
        for name, first in self._first_state().items():
            getattr(self, name)[groups] = first[groups]

    @final
    def learned(self) -> Arrays:
        """Return a copy of what was learned: named arrays (G, ...)."""
        return {name: np.array(getattr(self, name)) for name in self.state_names}

    @final
    def load_learned(self, learned: Mapping[str, npt.NDArray[Any]]) -> None:
        """Take over what another strategy of the same class, parameters and problem `learned`.

        What one group learned can be given to any number of groups, each of which then goes on for itself.
        """
        self._load(learned, self.state_names, spread=True)

    @final
    def state_dict(self) -> Arrays:
        """Return a copy of everything that further decisions depend on: what was learned and the rows' randomness."""
        return self.learned() | {name: np.array(getattr(self, name)) for name in ROW_STATE}

    @final
    def load_state(self, state: Mapping[str, npt.NDArray[Any]]) -> None:
        """Take over a state that `state_dict` of a strategy of the same class and sizes gave."""
        self._load(state, (*self.state_names, *ROW_STATE), spread=False)

    def context_keys(self, context: Floats) -> str | Sequence[str]:
        """Return under which name a store of knowledge keeps rewards in `context` (K, F): one for all, or (K,)."""
        return ""

    @final
    def recall(self, count: Ints, mean: Floats, variance: Floats) -> None:
        """Begin with what a store of knowledge holds of each option, as if its rewards had just come, in all groups.

        Args:
            count: (O,) number of rewards of each option.
            mean: (O,) their mean; any number where there is none.
            variance: (O,) their mean squared deviation from it.

        Raises:
            ValueError: numbers that do not fit, or a strategy that keeps no such estimates.

        """
        shape = (self.options,)
        known = readable("count", count, shape)
        average, spread = readable("mean", mean, shape), readable("variance", variance, shape)
        if known.min() < 0.0 or spread.min() < 0.0:
            raise ValueError(f"recall: expected no negative count or variance, got {known.min()} and {spread.min()}")
        self._recall(known, average, spread)

    def _recall(self, count: Floats, mean: Floats, variance: Floats) -> None:
        raise ValueError(f"strategy {type(self).__name__} keeps no count and mean of options that a store could give")

    def _prepare(self) -> None:  # noqa: B027  (a hook that may stay empty)
        """Check and set up what follows from problem and parameters; called once, before `_first_state`."""

    def _first_state(self) -> Arrays:
        """Return what the strategy knows before any reward: named arrays (G, ...) that become attributes."""
        return {}

    @abstractmethod
    def _select(self, decisions: Decisions) -> Ints:
        """Return the option (K,) of each decision; set `chance[decisions.rows]` if it was left to chance."""

    @abstractmethod
    def _update(self, outcomes: Outcomes) -> None:
        """Move the state by what decisions brought."""

    def _rows(self, rows: Ints | None) -> Ints:
        if rows is None:
            return np.arange(self.rows)
        return whole_numbers("rows", rows, np.shape(rows)[:1], "rows", self.rows)

    def _allowed(self, allowed: Flags | None, rows: Ints) -> Flags:
        shape = (len(rows), self.options)
        if allowed is None:
            return np.broadcast_to(np.True_, shape)
        flags = np.asarray(allowed).view()
        if flags.shape != shape or flags.dtype != np.bool_:
            raise ValueError(f"allowed: expected truth values {shape}, got {flags.shape} of {flags.dtype}")
        if not flags.any(axis=1).all():
            raise ValueError(f"allowed: expected an option for every row, got none for {rows[~flags.any(axis=1)][0]}")
        flags.flags.writeable = False
        return flags

    def _load(self, state: Mapping[str, npt.NDArray[Any]], names: tuple[str, ...], *, spread: bool) -> None:
        if set(state) != set(names):
            raise ValueError(f"state: expected the arrays {sorted(names)}, got {sorted(state)}")
        for name in names:
            own, given = getattr(self, name), np.asarray(state[name])
            shapes = {own.shape, (1, *own.shape[1:])} if spread else {own.shape}
            if given.shape not in shapes or not np.can_cast(given.dtype, own.dtype, "same_kind"):
                got = f"{given.shape} of {given.dtype}"
                raise ValueError(f"state '{name}': expected {own.shape} of {own.dtype}, got {got}")
        for name in names:
            getattr(self, name)[...] = state[name]


ROW_STATE = ("keys", "counters", "chance")
"""Names of the arrays (R,) that every strategy has besides what it learned."""
