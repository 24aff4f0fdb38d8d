"""Helpers of all borders: spaces of a batch, masks in the form that `sample` takes, a start among options."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from reprlib import repr as brief
from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from clean_swarm_env.config.mission import StartConfiguration
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.given import config_from
from selforg.registry import unknown

Mask = NDArray[np.int8] | tuple[NDArray[np.int8], ...]


def observation_space(batch: Batch, robots: int = 1) -> spaces.Box:
    """Return the space of the observations of `robots` robots, one after the other."""
    bounds = np.tile(batch.observer.bounds, robots)
    return spaces.Box(-bounds, bounds, dtype=np.float32)


def action_space(batch: Batch, robots: int = 1) -> spaces.Space[Any]:
    """Return the space of the actions of `robots` robots, one after the other.

    A single option is Discrete, several options are MultiDiscrete, vectors are a Box.
    """
    if batch.action.mode == "velocity":
        return spaces.Box(-1.0, 1.0, (2 * robots,), np.float32)
    counts = list(batch.choices.counts) * robots
    return spaces.Discrete(counts[0]) if len(counts) == 1 else spaces.MultiDiscrete(counts)


def masks_of(batch: Batch) -> Iterable[Mask]:
    """Return the options that can serve next in each row, in the form that `sample` of one robot's space takes."""
    whole = batch.masks().astype(np.int8)
    counts = batch.choices.counts
    return whole if len(counts) == 1 else zip(*np.split(whole, np.cumsum(counts)[:-1], axis=1), strict=True)


def state_space(names: Sequence[str]) -> spaces.Box:
    """Return the space of the global state with these components."""
    return spaces.Box(-1.0, 1.0, (len(names),), np.float32)


def start_of(options: Mapping[str, Any] | None, known: Sequence[str] = ("start",)) -> StartConfiguration | None:
    """Return the start in the options of a reset, None without one; `known` are the keys that they may have."""
    if options is not None and not isinstance(options, Mapping):
        raise TypeError(f"options: expected a dictionary, got {brief(options)}")
    for key in options or {}:
        if key not in known:
            raise ValueError(f"options: {unknown('key', str(key), known)}")
    start = (options or {}).get("start")
    return None if start is None else config_from(StartConfiguration, start, "options['start']")


def check_render_mode(mode: object, known: Sequence[str]) -> None:
    """Raise ValueError for a render mode other than None and those `known`."""
    if mode is not None and mode not in known:
        raise ValueError(f"render_mode: expected None or {' or '.join(map(repr, known))}, got {mode!r}")
