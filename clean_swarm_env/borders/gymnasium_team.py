"""One selector for the whole team: the cleaning robots as a Gymnasium environment with a single agent."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Unpack

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode
from numpy.typing import NDArray

from clean_swarm_env.borders.gymnasium_vector import TeamVectorEnv
from clean_swarm_env.borders.settings import spelled_out
from clean_swarm_env.borders.spaces import start_of
from clean_swarm_env.borders.views import OneWorld
from clean_swarm_env.learning.episodes import EnvSettings
from clean_swarm_env.learning.given import GivenMission, seeds_from
from clean_swarm_env.learning.observation.observer import Observations


class CleanSwarmTeam(OneWorld, gymnasium.Env[Observations, NDArray[Any]]):
    """One world of cleaning robots; the agent decides for all of them.

    The observation holds those of all robots, one after the other. The action is one option for each robot and goal
    (MultiDiscrete), or one option for all robots (Discrete). The reward is the mean over the robots.

    Args:
        mission: its name in `configs/missions` ("table1" unless given), its path, its keys, or the model.
        one_for_all: whether one option serves all robots.
        render_mode: None; "rgb_array"; or "human", which shows every control period in a window.
        settings: see `EnvSettings`.

    """

    @spelled_out
    def __init__(
        self,
        mission: GivenMission | None = None,
        *,
        one_for_all: bool = False,
        render_mode: str | None = None,
        **settings: Unpack[EnvSettings],
    ) -> None:
        mode = AutoresetMode.DISABLED
        self._envs = TeamVectorEnv(1, mission, one_for_all=one_for_all, autoreset_mode=mode, **settings)
        self._show(self._envs.batch, render_mode)
        self.observation_space = self._envs.single_observation_space
        self.action_space = self._envs.single_action_space

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observations, dict[str, Any]]:
        """Begin an episode; `options["start"]` may give a `StartConfiguration` or its keys."""
        start_of(options)
        super().reset(seed=seeds_from([seed], [0], 1)[0])
        observations, infos = self._envs.reset(seed=[seed], options=options)
        return observations[0], _first(infos)

    def step(self, action: NDArray[Any]) -> tuple[Observations, float, bool, bool, dict[str, Any]]:
        """Run one decision period; the period ends early when the mission does."""
        seen, rewards, terminated, truncated, infos = self._envs.step(_alone(action))
        return seen[0], float(rewards[0]), bool(terminated[0]), bool(truncated[0]), _first(infos)

    def set_state(self, state: bytes) -> Observations:
        """Go on from a state; return the observation. ValueError: damaged, or does not fit; nothing has changed."""
        return self._envs.set_state(state).ravel()

    def action_masks(self) -> NDArray[np.bool_]:
        """Return which options can serve next, those of each robot one after the other (for sb3-contrib).

        One option for all robots can serve if it can in any robot.
        """
        return self._envs.masks().ravel()


def _alone(action: Any) -> Any:  # noqa: ANN401  (an action, of whatever space)
    """Return the action of the only environment as those of all environments."""
    parts = isinstance(action, Mapping)
    return {name: np.asarray(part)[None] for name, part in action.items()} if parts else np.asarray(action)[None]


def _first(infos: dict[str, Any]) -> dict[str, Any]:
    """Return the infos of the first environment."""
    return {
        name: values[0].item() if np.ndim(values[0]) == 0 else values[0]
        for name, values in infos.items()
        if not name.startswith("_")
    }
