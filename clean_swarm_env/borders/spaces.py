"""Helpers of all borders: spaces of a batch, masks in the form that `sample` takes, a start among options."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from clean_swarm_env.config.mission import StartConfiguration
from clean_swarm_env.learning.batch import Batch

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


def start_of(options: Mapping[str, Any] | None) -> StartConfiguration | None:
    """Return the start in the options of a reset, None without one; other keys are ignored."""
    start = (options or {}).get("start")
    if start is not None and not isinstance(start, StartConfiguration):
        raise TypeError(f"options['start']: expected a StartConfiguration, got {type(start).__name__}")
    return start
