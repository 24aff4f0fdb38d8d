"""Helpers of all borders: spaces of a batch and of its members, masks as `sample` takes them, a start among options."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from reprlib import repr as brief
from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from clean_swarm_env.config.mission import StartConfiguration
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.given import config_from
from clean_swarm_env.learning.interface import ManyWorlds
from clean_swarm_env.learning.joined import Joined
from selector.documents.plain import must_know

OPTION, CORRECTION = "option", "correction"
"""Keys of an action that is both an option and a vector."""


NAMES = "names"
"""Attribute of a space: names of the components of an observation, or goal -> names of its options. Whatever keeps a
space, as the files of Stable-Baselines3 do, keeps the names (docs/decisions/0220-spaces-have-names.md)."""


def observation_space(worlds: ManyWorlds, robots: int = 1) -> spaces.Box:
    """Return the space of the observations of `robots` robots, one after the other."""
    observer = worlds.batches[0].observer
    bounds = np.tile(observer.bounds, robots)
    space = spaces.Box(-bounds, bounds, dtype=np.float32)
    vars(space)[NAMES] = tuple(observer.names) * robots
    return space


def action_space(worlds: ManyWorlds, robots: int = 1) -> spaces.Space[Any]:
    """Return the space of the actions of `robots` robots, one after the other.

    A single option is Discrete, several options are MultiDiscrete, vectors are a Box. Both are a Dict: `option`, and
    `correction` of its movement.
    """
    mode, vectors = worlds.batches[0].action.mode, spaces.Box(-1.0, 1.0, (2 * robots,), np.float32)
    if mode == "velocity":
        return vectors
    counts = [len(names) for names in worlds.options.values()] * robots
    choices = spaces.Discrete(counts[0]) if len(counts) == 1 else spaces.MultiDiscrete(counts)
    vars(choices)[NAMES] = dict(worlds.options)
    return choices if mode == "option" else spaces.Dict({OPTION: choices, CORRECTION: vectors})


def flat_space(worlds: ManyWorlds) -> spaces.Space[Any]:
    """Return the space of the actions of a robot for learners that know no dictionaries.

    Actions of both kinds are a Box: a number for each option, the largest of which is taken, and the correction.
    """
    space = action_space(worlds)
    if not isinstance(space, spaces.Dict):
        return space
    box = spaces.Box(-1.0, 1.0, (sum(map(len, worlds.options.values())) + 2,), np.float32)
    vars(box)[NAMES] = dict(worlds.options)
    return box


def preferred(numbers: NDArray[Any], counts: Sequence[int]) -> NDArray[Any]:
    """Return actions (R, C + ...) of numbers (R, O + ...): of each goal the option with the largest, then the rest."""
    *parts, rest = np.split(numbers, np.cumsum(counts), axis=1)
    return np.column_stack([*(part.argmax(axis=1) for part in parts), rest])


def rows_of(actions: Any, space: spaces.Space[Any], rows: int) -> NDArray[Any]:  # noqa: ANN401  (what a user gave)
    """Return actions of a space as rows (R, ...), an option before its correction; ValueError for other shapes."""
    if isinstance(space, spaces.Dict):
        if not isinstance(actions, Mapping) or actions.keys() != space.keys():
            raise ValueError(f"actions: expected a dictionary with {sorted(space.keys())}, got {brief(actions)}")
        return np.column_stack([rows_of(actions[name], space[name], rows) for name in (OPTION, CORRECTION)])
    given = np.asarray(actions)
    if given.shape != space.shape:
        raise ValueError(f"actions: expected shape {space.shape}, got {given.shape}")
    return given.reshape(rows, -1)


def start_of(options: Mapping[str, Any] | None, known: Sequence[str] = ("start",)) -> StartConfiguration | None:
    """Return the start in the options of a reset, None without one; `known` are the keys that they may have."""
    if options is not None and not isinstance(options, Mapping):
        raise TypeError(f"options: expected a dictionary, got {brief(options)}")
    for key in options or {}:
        must_know("key", str(key), known, "options")
    start = (options or {}).get("start")
    return None if start is None else config_from(StartConfiguration, start, "options['start']")


class Member:
    """One environment of a vectorised environment.

    Attributes:
        batch: the batch of its world.
        world: number of its world, over all batches.
        robot: number of its first robot within the world.

    """

    spec = None
    render_mode = None

    def __init__(self, batch: Batch, world: int, robot: int, rows: slice) -> None:
        """Make the environment of some `rows` of a batch, from a robot of a world on."""
        self.world, self.robot = world, robot
        self._batch, self._rows = batch, rows

    @property
    def batch(self) -> Batch:
        """The batch of the world."""
        return self._batch

    @property
    def options(self) -> dict[str, tuple[str, ...]]:
        """Coordinated goal -> names of its options."""
        return dict(self._batch.options)

    def action_masks(self) -> NDArray[np.bool_]:
        """Return which options of all goals and robots, one after the other, can serve next (for sb3-contrib)."""
        return self._batch.masks()[self._rows].ravel()


def members(joined: Joined, together: int = 1) -> list[Member]:
    """Return the environments of a vectorised environment, of `together` rows each."""
    return [
        Member(batch, world, robot, slice(own * batch.robots + robot, own * batch.robots + robot + together))
        for world, (batch, own) in enumerate(joined.places())
        for robot in range(0, batch.robots, together)
    ]
