"""Joined worlds as a vectorised environment of Stable-Baselines3: each row is an environment, all share parameters."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray
from stable_baselines3.common.vec_env.base_vec_env import VecEnv, VecEnvIndices, VecEnvStepReturn

from clean_swarm_env.spaces import action_space, observation_space
from train.scenario_worlds import Done, JoinedWorlds, Observations, Source


class JoinedVecEnv(VecEnv):
    """The rows of joined worlds.

    Args:
        joined: the worlds.
        sources: gives the scenarios with which the worlds begin at a reset, batch by batch.
        finished: is told of every mission that ended.

    """

    def __init__(
        self, joined: JoinedWorlds, sources: Callable[[], Sequence[Source]], finished: Callable[[Done], None]
    ) -> None:
        self.joined, self._sources, self._finished = joined, sources, finished
        first = joined.batches[0]
        super().__init__(joined.rows, observation_space(first), action_space(first))

    def reset(self) -> Observations:
        """Begin with new scenarios in all worlds."""
        return self.joined.begin(self._sources())

    def step_async(self, actions: NDArray[Any]) -> None:
        """Note the options of the coming step."""
        self._actions = np.asarray(actions, dtype=np.int64)

    def step_wait(self) -> VecEnvStepReturn:
        """Let all robots act for one decision period."""
        moment = self.joined.step(self._actions)
        infos: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        for row in np.flatnonzero(moment.over).tolist():
            infos[row]["terminal_observation"] = moment.final[row].copy()
            infos[row]["TimeLimit.truncated"] = bool(moment.truncated[row])
        for done in moment.done:
            self._finished(done)
        return moment.observations, moment.rewards.astype(np.float32), moment.over, infos

    def close(self) -> None:
        """Nothing has to be closed."""

    def get_attr(self, attr_name: str, indices: VecEnvIndices = None) -> list[Any]:
        """Return the attribute of this environment once for each row asked for."""
        return [getattr(self, attr_name, None) for _ in self._get_indices(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: VecEnvIndices = None) -> None:  # noqa: ANN401
        """Rows have nothing to set."""
        raise AttributeError(f"rows have no attribute {attr_name!r} to set")

    def env_method(self, method_name: str, *args: Any, indices: VecEnvIndices = None, **kwargs: Any) -> list[Any]:  # noqa: ANN401
        """Rows have no methods."""
        raise AttributeError(f"rows have no method {method_name!r}")

    def env_is_wrapped(
        self, wrapper_class: type[gymnasium.Wrapper[Any, Any, Any, Any]], indices: VecEnvIndices = None
    ) -> list[bool]:
        """Return that no row is wrapped."""
        return [False for _ in self._get_indices(indices)]
