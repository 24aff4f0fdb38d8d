"""The base class of decision strategies, which choose options for many robots at once."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any, ClassVar, final, get_origin, get_type_hints

import numpy as np
import numpy.typing as npt
from pydantic import create_model

from selector.documents.arrays import Arrays
from selector.documents.errors import validated
from selector.documents.fields import Closed
from selector.strategies.problem import Decisions, Outcomes, Problem, readable, whole_numbers
from selector.strategies.streams import Keys, uniforms
from selforg.arrays import Flags, Floats, Ints
from selforg.plugins import Promises, are_numbers


class DecisionStrategy(ABC):
    """Base class: chooses one of O options for each of R rows, and learns from the rewards of its choices.

    Call `select` once in a decision period, for all rows or those that decide, and `update` when the reward of an
    earlier choice is known, at any later time, with the context of the choice. A new strategy is one file with a class
    that implements `_select`, and, if it learns, `_first_state` and `_update`. Annotated attributes with a value, as
    `rate`, are its parameters:

    >>> import numpy as np
    >>> from selector.documents.fields import Share
    >>> from selector.strategies.registry import STRATEGIES, create
    >>> @STRATEGIES.register
    ... class LastReward(DecisionStrategy):
    ...     rate: Share = 1.0
    ...     last: Floats
    ...
    ...     def _first_state(self):
    ...         return {"last": np.tile(self.problem.scores, (self.groups, 1))}
    ...
    ...     def _select(self, decisions):
    ...         return np.where(decisions.allowed, self.last[decisions.groups], -np.inf).argmax(axis=1)
    ...
    ...     def _update(self, outcomes):
    ...         place = outcomes.groups, outcomes.option
    ...         self.last[place] += self.rate * (outcomes.reward - self.last[place])
    >>> problem = Problem("AvoidCollision", ("Fernandez", "Gradient"), np.array([1.0, 0.5]))
    >>> strategy = create("LastReward", problem, keys=np.arange(3, dtype=np.uint64))
    >>> strategy.update(np.zeros(3, int), np.full(3, -1.0), np.zeros((3, 0)))
    >>> strategy.select(np.zeros((3, 0)))
    array([1, 1, 1])

    The learned state is the arrays of `_first_state`, whose first axis is the group: rows of one group share estimates.
    Random numbers are a function of the key of a row and of the number of its decision, so that a row decides the same
    alone and in a batch. A subclass states in `draws_per_decision` and `draws_per_option` how many it needs.

    Args:
        problem: goal, options, scores, names of the features, and rewards known at the beginning.
        keys: (R,) key of the random numbers of each row, from `selector.strategies.streams.row_keys`.
        parameters: values in place of those that the class gives its parameters.
        groups: (R,) 0..G-1, the set of estimates that each row uses; all rows share one unless given.

    """

    promises: ClassVar[Promises] = {
        **dict.fromkeys(
            ("__init__", "update"),
            (
                "a state of finite arrays by name, with the {0.groups} groups first",
                lambda one, *_: all(
                    are_numbers(state, one.groups, *state.shape[1:]) for state in one.learned().values()
                ),
            ),
        ),
        "select": (
            "chances above 0 and up to 1",
            lambda one, *_: one.chance.shape == (one.rows,) and ((one.chance > 0.0) & (one.chance <= 1.0)).all(),
        ),
        "opinions": ("opinions that are numbers", lambda one, thought, *_: not np.isnan(thought).any()),
    }
    Parameters: ClassVar[type[Closed]] = Closed
    """Model of the parameters, made of the annotated attributes."""
    draws_per_decision: ClassVar[int] = 0
    """Random numbers that one row takes for one decision."""
    draws_per_option: ClassVar[int] = 0
    """Further ones, for each option."""

    def __init_subclass__(cls, **settings: Any) -> None:  # noqa: ANN401  (of the base class)
        super().__init_subclass__(**settings)
        fields: dict[str, Any] = {
            name: (hint, getattr(cls, name))
            for name, hint in get_type_hints(cls, include_extras=True).items()
            if hasattr(cls, name) and get_origin(hint) is not ClassVar
        }
        cls.Parameters = create_model(cls.__name__, __base__=Closed, **fields)

    def __init__(
        self,
        problem: Problem,
        keys: Keys,
        parameters: Mapping[str, Any] | None = None,
        *,
        groups: Ints | None = None,
    ) -> None:
        self.problem = problem
        checked = validated(self.Parameters, dict(parameters or {}), f"strategy {type(self).__name__}")
        for name, value in checked:
            setattr(self, name, value)
        self.parameters = checked.model_dump(mode="json")
        self.options, self.features, self.rows = len(problem.options), len(problem.features), len(keys)
        self.group_of: Ints = whole_numbers(
            "groups", np.zeros(self.rows, np.int64) if groups is None else groups, (self.rows,), "groups", self.rows
        )
        self.groups = 1 + int(self.group_of.max(initial=0))
        self.keys: Keys = np.array(keys, dtype=np.uint64)
        self.counters: Keys = np.zeros(self.rows, dtype=np.uint64)
        self.chance: Floats = np.ones(self.rows)
        self._all_can: Flags = np.broadcast_to(np.True_, (self.rows, self.options))
        self._prepare()
        first = self._first_state()
        self.state_names = tuple(first)
        for name, array in first.items():
            setattr(self, name, array)

    @classmethod
    def example(cls, problem: Problem) -> dict[str, Any]:
        """Return the parameters with which the contract tests build the class for a problem."""
        return {}

    @classmethod
    def can_learn(cls) -> bool:
        """Return whether rewards change what it decides."""
        return cls._update is not DecisionStrategy._update

    @final
    def select(self, context: Floats, allowed: Flags | None = None, rows: Ints | None = None) -> Ints:
        """Return the option (K,) for each row of `context` (K, F).

        Args:
            context: (K, F) features of each row.
            allowed: (K, O) whether an option can serve; all can unless given.
            rows: (K,) the rows that decide, each once; all rows unless given.

        """
        deciding = self._rows(rows)
        if rows is not None and np.bincount(deciding, minlength=1).max() > 1:
            raise ValueError(f"rows: expected each row once, got {deciding.tolist()}")
        seen = readable("context", context, (len(deciding), self.features))
        can_serve = self._allowed(allowed, deciding)
        count = self.draws_per_decision + self.draws_per_option * self.options
        draws = uniforms(self.keys[deciding], self.counters[deciding], count)
        draws.flags.writeable = False
        options = self._checked(Decisions(deciding, self.group_of[deciding], seen, can_serve, draws))
        self.counters[deciding] += np.uint64(1)
        return options

    @final
    def opinions(self, context: Floats) -> Floats:
        """Return what each row thinks of each option (R, O) in `context` (R, F), for readers of a decision.

        A score, an estimate of the reward or a probability, as the strategy has it. Nothing changes.
        """
        rows, seen = np.arange(self.rows), readable("context", context, (self.rows, self.features))
        decisions = Decisions(rows, self.group_of, seen, self._allowed(None, rows), np.zeros((self.rows, 0)))
        thought = np.empty((self.rows, self.options))
        thought[:] = self._opinions(decisions)
        return thought

    @final
    def update(
        self, option: Ints, reward: Floats, context: Floats, rows: Ints | None = None, chance: Floats | None = None
    ) -> None:
        """Learn from the rewards of earlier decisions.

        Args:
            option: (K,) the chosen option.
            reward: (K,) its reward; larger is better.
            context: (K, F) the features at the decision.
            rows: (K,) the rows that decided; a row may be given several times. All rows unless given.
            chance: (K,) the value of `chance[rows]` after the decision; needed only if the row has decided again since.

        """
        decided = self._rows(rows)
        count = len(decided)
        chosen = whole_numbers("option", option, (count,), "options", self.options)
        gained, seen = readable("reward", reward, (count,)), readable("context", context, (count, self.features))
        likely = readable("chance", self.chance[decided] if chance is None else chance, (count,))
        if count and (likely.min() <= 0.0 or likely.max() > 1.0):
            raise ValueError(f"chance: expected probabilities above 0, got {likely.min()}..{likely.max()}")
        groups = self.group_of[decided]
        # sums over a batch must not depend on the order of its rows
        order = np.lexsort((*seen.T, likely, gained, chosen, groups))
        self._update(Outcomes(groups[order], chosen[order], gained[order], seen[order], likely[order]))

    @final
    def reseed(self, rows: Ints, keys: Keys) -> None:
        """Give `rows` (K,) new `keys` (K,); learned arrays stay."""
        self.keys[rows] = keys
        self.counters[rows] = 0
        self.chance[rows] = 1.0

    @final
    def learned(self) -> Arrays:
        """Return copies of the learned arrays (G, ...), by name."""
        return {name: np.array(getattr(self, name)) for name in self.state_names}

    @final
    def load_learned(self, learned: Mapping[str, npt.NDArray[Any]]) -> None:
        """Copy the `learned` arrays of another strategy of the same class, parameters and problem.

        Arrays of one group are copied to every group; the groups then learn independently.
        """
        if set(learned) != set(self.state_names):
            raise ValueError(f"state: expected the arrays {sorted(self.state_names)}, got {sorted(learned)}")
        for name in self.state_names:
            own, given = getattr(self, name), np.asarray(learned[name])
            shapes = {own.shape, (1, *own.shape[1:])}
            if given.shape not in shapes or not np.can_cast(given.dtype, own.dtype, "same_kind"):
                got = f"{given.shape} of {given.dtype}"
                raise ValueError(f"state '{name}': expected {own.shape} of {own.dtype}, got {got}")
            least, most = self._ranges().get(name, (-LEARNED_LIMIT, LEARNED_LIMIT))
            within = (given >= least) & (given <= most)  # NaN is not
            if not within.all():
                raise ValueError(f"state '{name}': expected {least:g} to {most:g}, got {given[~within][0]:g}")
        for name in self.state_names:
            getattr(self, name)[...] = learned[name]

    def _prepare(self) -> None:  # noqa: B027  (a hook that may stay empty)
        """Check the parameters and derive values from them; called once, before `_first_state`."""

    def _first_state(self) -> Arrays:
        """Return the state before any update: arrays (G, ...) by name, which become attributes.

        A strategy that keeps counts and means begins with the rewards that its problem knows.
        """
        return {}

    def _ranges(self) -> dict[str, tuple[float, float]]:
        """Return the least and the largest number of state arrays, by name, where `LEARNED_LIMIT` is too much."""
        return {}

    @abstractmethod
    def _select(self, decisions: Decisions) -> Ints:
        """Return the option (K,) of each decision; set `chance[decisions.rows]` if the choice was random."""

    def _opinions(self, decisions: Decisions) -> Floats:
        """Return the opinion of each option (K, O); the scores of the expert unless a strategy has better."""
        return self.problem.scores

    def _update(self, outcomes: Outcomes) -> None:  # noqa: B027  (not every strategy learns)
        """Learn from the rewards of decisions; a strategy that does not learn leaves this out."""

    def _checked(self, decisions: Decisions) -> Ints:
        """Return the option (K,) of each decision; ValueError unless it is one that can serve."""
        name, rows = f"{type(self).__name__}._select", decisions.rows
        options = whole_numbers(name, self._select(decisions), (len(rows),), "options", self.options).copy()
        served = np.take_along_axis(decisions.allowed, options[:, None], axis=1)[:, 0]
        if not served.all():
            raise ValueError(f"{name}: option {options[~served][0]} cannot serve row {rows[~served][0]}")
        return options

    def _rows(self, rows: Ints | None) -> Ints:
        if rows is None:
            return np.arange(self.rows)
        return whole_numbers("rows", rows, np.shape(rows)[:1], "rows", self.rows)

    def _allowed(self, allowed: Flags | None, rows: Ints) -> Flags:
        shape = (len(rows), self.options)
        if allowed is None:
            return self._all_can[: len(rows)]
        flags = np.asarray(allowed).view()
        if flags.shape != shape or flags.dtype != np.bool_:
            raise ValueError(f"allowed: expected truth values {shape}, got {flags.shape} of {flags.dtype}")
        if not flags.any(axis=1).all():
            raise ValueError(f"allowed: expected an option for every row, got none for {rows[~flags.any(axis=1)][0]}")
        flags.flags.writeable = False
        return flags


LEARNED_LIMIT = 1e15
"""Largest absolute value of a learned number; sums up to this value are still exact to a whole reward."""
