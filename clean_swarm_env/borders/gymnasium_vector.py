"""Many worlds as a Gymnasium vector environment: each robot is an environment of its own, or each team is one.

    envs = RobotVectorEnv(worlds=64)
    observations, infos = envs.reset(seed=1)
    observations, rewards, terminations, truncations, infos = envs.step(envs.action_space.sample())

What happens when the mission of a world is over:

- `autoreset_mode="SameStep"` (the default): the world starts its next episode in the same step. The observation
  returned is its first one. `infos["final_obs"]` has the last one of the old episode, `infos["final_info"]` its infos.
- "NextStep": the world starts its next episode in the next step, whatever the actions; that step pays nothing.
- "Disabled": `reset(options={"reset_mask": mask})` must reset it before the next step.

`reset(seed=S)` gives each world a seed of its own that follows from S (docs/environment.md#seeds).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, Unpack

import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from clean_swarm_env.borders.infos import ALIVE, Info, own_infos, team_infos
from clean_swarm_env.borders.settings import spelled_out
from clean_swarm_env.borders.spaces import action_space, members, observation_space, rows_of, start_of
from clean_swarm_env.borders.views import PICTURE, checked_mode, world_picture
from clean_swarm_env.learning.episodes import EnvSettings
from clean_swarm_env.learning.given import GivenMission, seeds_from, whole_number
from clean_swarm_env.learning.joined import Joined, batches_of
from clean_swarm_env.learning.observation.observer import Observations
from selforg.arrays import Flags, Floats, Ints


class BatchVectorEnv(VectorEnv[Observations, NDArray[Any], NDArray[Any]]):
    """The base class of both kinds: E environments of `together` rows each, E * together = R.

    Args:
        together: rows of one environment: 1, or 0 for all robots of a world.
        worlds: W.
        mission: its name in `configs/missions` ("table1" unless given), its path, its keys, or the model.
        threads: number of threads that step the worlds, with the same results for any number.
        one_for_all: whether one action serves all rows of an environment.
        autoreset_mode: what happens when the mission of a world is over.
        render_mode: None or "rgb_array".
        settings: see `EnvSettings`.

    Attributes:
        autoreset_mode: the mode, as a member of `AutoresetMode`.
        joined: the worlds.
        batch: the worlds; of several `threads` or tori, the first of them.

    """

    metadata = {"autoreset_mode": AutoresetMode.SAME_STEP, "render_modes": [PICTURE], "render_fps": 1}  # noqa: RUF012

    def __init__(
        self,
        together: int,
        worlds: int,
        mission: GivenMission | None,
        *,
        threads: int = 1,
        one_for_all: bool = False,
        autoreset_mode: AutoresetMode | str = AutoresetMode.SAME_STEP,
        render_mode: str | None = None,
        **settings: Unpack[EnvSettings],
    ) -> None:
        self.render_mode = checked_mode(render_mode, self.metadata["render_modes"])
        self.autoreset_mode = AutoresetMode(autoreset_mode)
        self._anew = self.autoreset_mode == AutoresetMode.SAME_STEP
        self.joined = Joined(batches_of(mission, worlds, threads, begin_anew=self._anew, **settings), threads)
        self.batch = self.joined.batches[0]
        told = {"autoreset_mode": self.autoreset_mode, "render_fps": 1.0 / self.batch.decision_period}
        self.metadata = {**self.metadata, **told}
        self._together = together or self.batch.robots
        self._sharing = self._together if one_for_all else 1
        self.num_envs = self.joined.rows // self._together
        self._per_world = self.batch.robots // self._together
        self.single_observation_space = observation_space(self.joined, self._together)
        self.single_action_space = action_space(self.joined, self._together // self._sharing)
        self.observation_space = batch_space(self.single_observation_space, self.num_envs)
        self.action_space = batch_space(self.single_action_space, self.num_envs)
        self.envs = members(self.joined, self._together)

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observations, Info]:
        """Begin an episode in every world.

        `seed` may be a list, of one for each world or for each robot: a world takes that of its first robot. In
        `options`, `start` is a start for all worlds; `reset_mask` (E,) says which environments begin, always whole
        worlds.
        """
        start = start_of(options, ("start", "reset_mask"))
        worlds = self._chosen((options or {}).get("reset_mask"))
        seeds = seeds_from(seed, self.joined.first_rows.tolist(), self.joined.rows)
        super().reset(seed=seeds[0])
        return self._shaped(self.joined.reset(seeds, [start] * len(seeds), worlds)), self._infos()

    def step(self, actions: NDArray[Any]) -> tuple[Observations, Floats, Flags, Flags, Info]:
        """Run one decision period."""
        given = rows_of(actions, self.action_space, self.joined.rows // self._sharing)
        over = self.joined.over & (not self._anew)  # worlds that begin their next mission, or are to be reset before
        waiting = np.flatnonzero(over)
        if len(waiting) and self.autoreset_mode == AutoresetMode.DISABLED:
            raise RuntimeError(f"step: the missions of worlds {waiting.tolist()} are over, call reset first")
        step = self.joined.step(np.repeat(given, self._sharing, axis=0))
        seen = self.joined.reset(worlds=waiting) if len(waiting) else step.observations
        return (
            self._shaped(seen),
            step.rewards.reshape(self.num_envs, -1).mean(axis=1),
            np.repeat(step.terminated & ~over, self._per_world),
            np.repeat(step.truncated & ~over, self._per_world),
            self._infos(step.final_observations if self._anew else None),
        )

    def masks(self) -> Flags:
        """Return which options (E, ...) can serve next; one option for all can if it can in any robot."""
        return np.asarray(self.joined.masks().reshape(self.num_envs, self._sharing, -1).any(axis=1))

    def get_state(self, worlds: Sequence[int] | None = None) -> bytes:
        """Return the states of `worlds`, or of all; see `Batch.get_state`."""
        return self.joined.get_state(worlds)

    def set_state(self, state: bytes, worlds: Sequence[int] | None = None) -> Observations:
        """Make `worlds`, or all, go on from a state, see `Batch.set_state`; return all observations."""
        return self._shaped(self.joined.set_state(state, worlds))

    def close_extras(self, **_: object) -> None:
        """End the recordings of missions that are still going on."""
        self.joined.close()

    def render(self) -> tuple[NDArray[np.uint8], ...] | None:
        """Return a picture (height, width, 3) for each environment, or None without a render mode."""
        if self.render_mode is None:
            return None
        pictures = [world_picture(*place) for place in self.joined.places()]
        return tuple(pictures[env.world] for env in self.envs)

    def call(self, name: str, *arguments: Any, **settings: Any) -> tuple[Any, ...]:  # noqa: ANN401
        """Call a method of every environment (`action_masks`), or return an attribute of each."""
        found = [getattr(env, name) for env in self.envs]
        return tuple(one(*arguments, **settings) if callable(one) else one for one in found)

    def get_attr(self, name: str) -> tuple[Any, ...]:
        """Return an attribute of every environment, such as `world`; AttributeError if they do not have it."""
        return tuple(getattr(env, name) for env in self.envs)

    def _chosen(self, mask: Any) -> Ints | None:  # noqa: ANN401  (what a user gave)
        """Return the worlds that a mask (E,) of environments chooses; None for all."""
        flags = np.ones(self.num_envs, dtype=np.bool_) if mask is None else np.asarray(mask)
        if flags.shape != (self.num_envs,) or flags.dtype != np.bool_:
            expected = f"truth values of shape {(self.num_envs,)}"
            raise ValueError(f"options['reset_mask']: expected {expected}, got {flags.dtype} of shape {flags.shape}")
        worlds = flags.reshape(-1, self._per_world)
        if (worlds != worlds[:, :1]).any():
            raise ValueError("options['reset_mask']: expected all robots of a world or none")
        return None if flags.all() else np.flatnonzero(worlds[:, 0])

    def _shaped(self, observations: Observations) -> Observations:
        return observations.reshape(self.num_envs, -1).copy()

    def _infos(self, final: Observations | None = None) -> Info:
        """Return the infos as arrays: (E,) for a team's, (E,) or (E, N) for a robot's own, (E, ...) for the mask.

        `final` has the last observations of missions that ended, if others have begun.
        """
        of_teams, of_robots = (_columns(map(told, self.joined.batches)) for told in (team_infos, own_infos))
        infos: Info = {name: values.repeat(self._per_world) for name, values in of_teams.items()}
        for name, own in of_robots.items():
            infos[name] = own if self._together == own.ndim == 1 else own.reshape(self.num_envs, -1)
        told, finished = _flagged(infos, np.ones(self.num_envs, dtype=np.bool_)), self.joined.finished
        if final is not None and finished:
            ended = np.isin(np.arange(self.num_envs) // self._per_world, [end.world for end in finished])
            last = np.full(self.num_envs, None, dtype=object)
            for env in np.flatnonzero(ended):
                last[env] = self._shaped(final)[env]
            worked = np.concatenate([batch.worked for batch in self.joined.batches]).reshape(infos[ALIVE].shape)
            happened = _flagged(infos | {ALIVE: worked}, ended)
            told |= _flagged({"final_obs": last, "final_info": happened}, ended)
        return told


def _columns(told: Iterable[Info]) -> dict[str, NDArray[Any]]:
    """Return what is told of batches, with the values of all one after the other."""
    each = list(told)
    return {name: np.concatenate([one[name] for one in each]) for name in each[0]}


def _flagged(infos: Info, which: Flags) -> Info:
    """Return infos, and for each of them which environments have it."""
    return infos | {f"_{name}": which.copy() for name in infos}


class VectorSettings(EnvSettings, total=False):
    """Settings of both kinds, as keyword arguments."""

    autoreset_mode: AutoresetMode | str
    """What happens when the mission of a world is over."""
    render_mode: str | None
    """None or "rgb_array"."""
    threads: int
    """Number of threads that step the worlds, 1 unless given; the results are the same."""


class RobotVectorEnv(BatchVectorEnv):
    """Every robot of every world is an environment; learners share parameters among them (rows = worlds * robots).

    Args:
        worlds: W.
        mission: see `BatchVectorEnv`.
        settings: see `VectorSettings`.

    """

    @spelled_out
    def __init__(
        self, worlds: int = 1, mission: GivenMission | None = None, **settings: Unpack[VectorSettings]
    ) -> None:
        super().__init__(1, worlds, mission, **settings)


class TeamVectorEnv(BatchVectorEnv):
    """Every world is an environment in which one selector decides for the whole team, as in `CleanSwarmTeam`.

    Args:
        num_envs: W.
        mission: see `BatchVectorEnv`.
        one_for_all: whether one option serves all robots of a team.
        settings: see `VectorSettings`.

    """

    @spelled_out
    def __init__(
        self,
        num_envs: int = 1,
        mission: GivenMission | None = None,
        *,
        one_for_all: bool = False,
        **settings: Unpack[VectorSettings],
    ) -> None:
        worlds = whole_number(num_envs, "num_envs", 1)
        super().__init__(0, worlds, mission, one_for_all=one_for_all, **settings)
