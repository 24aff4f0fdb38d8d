"""One selector for the whole team: the cleaning robots as a Gymnasium environment with a single agent."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from clean_swarm_env.borders.gymnasium_vector import TeamVectorEnv
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.learning.observation.observer import Observations


class CleanSwarmTeam(gymnasium.Env[Observations, NDArray[Any]]):
    """One world of cleaning robots; the agent decides for all of them.

    The observation holds those of all robots, one after the other. The action is one option for each robot and goal
    (MultiDiscrete), or one option for all robots (Discrete). The reward is the mean over the robots.

    Args:
        mission: a mission, or the name of one in `configs/missions`.
        one_for_all: whether one option serves all robots.
        render_mode: None or "rgb_array".
        settings: further arguments of `Batch`.

    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 1}  # noqa: RUF012

    def __init__(
        self,
        mission: MissionConfig | str = "table1",
        *,
        one_for_all: bool = False,
        render_mode: str | None = None,
        **settings: Any,  # noqa: ANN401  (those of Batch)
    ) -> None:
        if render_mode not in (None, "rgb_array"):
            raise ValueError(f"render_mode: expected None or 'rgb_array', got {render_mode!r}")
        self._envs = TeamVectorEnv(1, one_for_all=one_for_all, mission=mission, begin_anew=False, **settings)
        self.batch = self._envs.batch
        self.render_mode = render_mode
        self.observation_space = self._envs.single_observation_space
        self.action_space = self._envs.single_action_space
        self._over = True

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observations, dict[str, Any]]:
        """Begin an episode; `options["start"]` may give a `StartConfiguration`."""
        super().reset(seed=seed)
        observations, infos = self._envs.reset(seed=[seed], options=options)
        self._over = False
        return observations[0], _first(infos)

    def step(self, action: NDArray[Any]) -> tuple[Observations, float, bool, bool, dict[str, Any]]:
        """Run one decision period; the period ends early when the mission does."""
        if self._over:
            raise RuntimeError("step: the episode is over (or has not begun), call reset first")
        seen, rewards, terminated, truncated, infos = self._envs.step(np.asarray(action)[None])
        self._over = bool(terminated[0] or truncated[0])
        info = _first(infos) | _first(infos.get("final_info", {}))
        return seen[0], float(rewards[0]), bool(terminated[0]), bool(truncated[0]), info

    def close(self) -> None:
        """End the recording of a mission that is still going on."""
        self.batch.close()

    def render(self) -> NDArray[np.uint8] | None:
        """Return the world as a picture (height, width, 3), or None without a render mode."""
        if self.render_mode is None:
            return None
        from clean_swarm_env.drawing.world_picture import portrait  # drawing is slow to import and seldom wanted

        return portrait(self.batch.worlds, 0)


def _first(infos: dict[str, Any]) -> dict[str, Any]:
    """Return the infos of the first environment."""
    return {name: values[0] for name, values in infos.items() if not name.startswith(("_", "final_")) and len(values)}
