"""The blueprint of decision strategies: which option serves a goal now, for many robots at once."""

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from typing import ClassVar, TypeVar, final

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
S = TypeVar("S", bound="type[DecisionStrategy]")

_registered: "dict[str, type[DecisionStrategy]]" = {}


class DecisionStrategy(ABC):
    """Choose one of O options for each of R rows, and learn from the reward that the choice brought.

    `select` is called once a decision period for all rows; `update` once the reward of an earlier choice is known, with
    the context in which it was made. A new strategy is one file with a registered class that implements `_select` and
    `_update`:

    >>> @register
    ... class LastOption(DecisionStrategy):
    ...     def _select(self, context, draws):
    ...         return np.full(self.rows, self.options - 1)
    ...
    ...     def _update(self, option, reward, context):
    ...         self.estimates[0, option] = reward
    >>> strategy = create("LastOption", np.array([1.0, 0.5]), [np.random.default_rng(0)])
    >>> strategy.select(np.zeros((1, 0)))
    array([1])
    >>> _ = _registered.pop("LastOption")

    What a strategy knows is `estimates`, (1, O) when the rows share it and (R, O) when each row learns for itself, plus
    what a subclass lists in `state_names`. Random numbers come from one generator per row, so that a row decides alike
    alone and in a batch; a subclass that needs them says how many in `draws_per_decision`.

    Args:
        scores: (O,) the expert's scores, finite; the estimates to begin with.
        generators: (R,) one source of randomness for each row; the caller keeps and saves them.
        features: F, the number of features of a context row.
        shared: whether all rows share one set of estimates.

    """

    draws_per_decision: ClassVar[int] = 0
    """Random numbers that one row takes for one decision."""
    state_names: ClassVar[tuple[str, ...]] = ("estimates",)
    """Names of the attributes, all arrays, that make up the state."""

    def __init__(
        self, scores: Floats, generators: Sequence[np.random.Generator], *, features: int = 0, shared: bool = True
    ) -> None:
        expert = np.array(scores, dtype=np.float64)
        if expert.ndim != 1 or expert.size == 0:
            raise ValueError(f"scores: expected shape (O,) with at least one option, got {expert.shape}")
        if not np.isfinite(expert).all():
            raise ValueError(f"scores: expected finite numbers, got {expert.tolist()}")
        self.options = expert.size
        self.rows = len(generators)
        self.features = features
        self.shared = shared
        self.estimates: Floats = np.tile(expert, (1 if shared else self.rows, 1))
        self._generators = list(generators)

    @final
    def select(self, context: Floats) -> Ints:
        """Return the option (R,) for each row of `context` (R, F)."""
        draws = np.empty((self.rows, self.draws_per_decision))
        seen = self._readable("context", context, (self.rows, self.features))
        for row, generator in enumerate(self._generators if self.draws_per_decision else ()):
            draws[row] = self._draw(generator)
        chosen = np.asarray(self._select(seen, draws))
        return self._checked_options(chosen, f"{type(self).__name__}._select")

    @final
    def update(self, option: Ints, reward: Floats, context: Floats) -> None:
        """Learn that `option` (R,), chosen in `context` (R, F), brought `reward` (R,), larger being better."""
        chosen = self._checked_options(np.asarray(option), "option")
        chosen.flags.writeable = False
        gained = self._readable("reward", reward, (self.rows,))
        self._update(chosen, gained, self._readable("context", context, (self.rows, self.features)))

    @final
    def state_dict(self) -> dict[str, npt.NDArray[np.generic]]:
        """Return a copy of the state as named arrays."""
        return {name: np.array(getattr(self, name)) for name in self.state_names}

    @final
    def load_state(self, state: Mapping[str, npt.NDArray[np.generic]]) -> None:
        """Take over a state that `state_dict` of a strategy of the same class and sizes gave."""
        if set(state) != set(self.state_names):
            raise ValueError(f"state: expected the arrays {sorted(self.state_names)}, got {sorted(state)}")
        for name in self.state_names:
            own = getattr(self, name)
            given = np.asarray(state[name])
            if given.shape != own.shape or not np.can_cast(given.dtype, own.dtype, "same_kind"):
                got = f"{given.shape} of {given.dtype}"
                raise ValueError(f"state '{name}': expected {own.shape} of {own.dtype}, got {got}")
        for name in self.state_names:
            getattr(self, name)[...] = state[name]

    @abstractmethod
    def _select(self, context: Floats, draws: Floats) -> Ints:
        """Return the option (R,) for `context` (R, F), using `draws` (R, draws_per_decision) for all randomness."""

    @abstractmethod
    def _update(self, option: Ints, reward: Floats, context: Floats) -> None:
        """Move the state by the `reward` (R,) of `option` (R,) in `context` (R, F)."""

    def _draw(self, generator: np.random.Generator) -> Floats:
        """Return the random numbers (draws_per_decision,) of one row's decision: uniform in [0, 1) unless changed."""
        return generator.random(self.draws_per_decision)

    def _readable(self, name: str, values: Floats, shape: tuple[int, ...]) -> Floats:
        array = np.asarray(values, dtype=np.float64).view()
        if array.shape != shape:
            raise ValueError(f"{name}: expected shape {shape}, got {array.shape}")
        if not np.isfinite(array).all():
            raise ValueError(f"{name}: expected finite numbers, got {array[~np.isfinite(array)][0]}")
        array.flags.writeable = False
        return array

    def _checked_options(self, chosen: npt.NDArray[np.generic], name: str) -> Ints:
        if chosen.shape != (self.rows,) or not np.issubdtype(chosen.dtype, np.integer):
            raise ValueError(f"{name}: expected integers ({self.rows},), got {chosen.shape} of {chosen.dtype}")
        options = chosen.astype(np.int64)
        if self.rows and (options.min() < 0 or options.max() >= self.options):
            given = f"{options.min()}..{options.max()}"
            raise ValueError(f"{name}: expected options 0..{self.options - 1}, got {given}")
        return options


def register(strategy: S) -> S:
    """Make a strategy known by the name of its class."""
    name = strategy.__name__
    if name in _registered:
        raise ValueError(f"strategy '{name}' is registered twice")
    _registered[name] = strategy
    return strategy


def registered() -> "dict[str, type[DecisionStrategy]]":
    """Return all registered strategies by name."""
    return dict(sorted(_registered.items()))


def create(
    name: str, scores: Floats, generators: Sequence[np.random.Generator], *, features: int = 0, shared: bool = True
) -> DecisionStrategy:
    """Return a new strategy of a registered name; the other arguments are those of `DecisionStrategy`."""
    if name not in _registered:
        raise ValueError(f"unknown strategy {name!r} (known: {', '.join(registered())})")
    return _registered[name](scores, generators, features=features, shared=shared)
