"""The cleaning swarm as a PettingZoo environment.

    from clean_swarm_env import clean_swarm_v0

    env = clean_swarm_v0.parallel_env()
    observations, infos = env.reset(seed=1)
    while env.agents:
        actions = {agent: env.action_space(agent).sample() for agent in env.agents}
        observations, rewards, terminations, truncations, infos = env.step(actions)

An action is the option that serves AvoidCollision in that robot for the next decision period; with several coordinated
goals it is one option for each. The robot's network decides the rest. With `action={"mode": "velocity"}` an action is a
movement vector. `learning.observation` describes the observations, `learning.reward` the rewards, `borders.infos`
the infos, `learning.global_state` the global state. `wrappers` keeps the agents of a changing team the same.
`parallel_env("Foraging")` is an environment with another task than cleaning: see `clean_swarm_env.tasks`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from reprlib import repr as brief
from typing import Any, Literal, Unpack

import gymnasium
import numpy as np
from numpy.typing import NDArray
from pettingzoo import AECEnv, ParallelEnv
from pettingzoo.utils.conversions import parallel_to_aec_wrapper
from pettingzoo.utils.wrappers import OrderEnforcingWrapper

from clean_swarm_env.borders.infos import robot_infos
from clean_swarm_env.borders.settings import spelled_out
from clean_swarm_env.borders.spaces import CORRECTION, OPTION, action_space, observation_space, start_of
from clean_swarm_env.borders.views import PICTURE, WINDOW, OneWorld
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.episodes import EnvSettings
from clean_swarm_env.learning.given import GivenMission, whole_number
from clean_swarm_env.learning.observation.observer import Observations

AgentAction = int | NDArray[np.int64] | NDArray[np.float32]
INTEGRAL = (int, np.integer)
"""Types of whole numbers."""
AgentInfos = dict[str, dict[str, Any]]
AgentsStep = tuple[dict[str, Observations], dict[str, float], dict[str, bool], dict[str, bool], AgentInfos]


class CleanSwarm(OneWorld, ParallelEnv[str, Observations, AgentAction]):
    """One world of cleaning robots; each agent is a robot, `robot_0`, `robot_1` and so on.

    A step is a decision period of 1 s. Shapes: N robots, F components of an observation, G of the state, M items, O
    options. The numbers are those of "table1": N = 5, F = 43, G = 106, M = 10, O = 3.

    **Observation**: float32 (F,) within [-1, 1] for each agent, what the robot senses or has heard, in its own frame;
    `observation_names` names the components, `observation={"terms": [...]}` chooses others. In this order:

    - nearest item (4): whether it is in sight, its distance by the range of sight, its direction ahead and left.
    - cargo (2): carries something; whether that is recycled.
    - phase (4), one flag: patrol, approach, on the way to recycling, to the dump.
    - situation (4), one flag: free or carrying, far from or near a station.
    - nearest recycling station, nearest dump (3 each): distance by half the torus' diagonal, ahead, left; then how
      near both are (2): 1 at a station, 0 from 2 m on.
    - target (3): the way to the station that the cargo has to go to.
    - nearest robot heard (6): distance, ahead, left; its heading, ahead and left; how fast it comes closer.
    - crowd (3): robots heard within 1, 1.5 and 2.5 m, by 6.
    - avoidance (2): length of the avoidance vector by the reach of a pose; whether the robot avoids somebody.
    - movement (2): speed and turn rate by the largest ones.
    - time (1): share of the time limit that is left; idle (1): time since the robot last achieved something, by 60 s.
    - options (O), one flag for each: the robot holds it. Missing with vectors as actions.

    **Action** for each agent at work, by `action={"mode": ...}`:

    - "option", the default: int within 0..O-1, the option of `options` that the robot holds in the next period;
      int64 (goals,) where several goals are coordinated.
    - "velocity": float32 (2,) within [-1, 1], a movement vector ahead and left, as shares of the largest speed.
    - "both": a dictionary of `option` and of `correction`, such a vector, which is added to the robot's command.

    **Reward**, a float for each agent: -0.01 for each second by which the mission's cost grew: time, own collisions,
    and at the end two time limits for each item left. `reward={"own_dumped": 1.0, ...}` adds shaping.

    **State**, for critics: `state()` is float32 (G,) within [-1, 1], true values without errors of sensing, named by
    `state_names`: of each robot whether it works, place, heading (cosine, sine), cargo (2) and options (7 + O each); of
    each item whether it lies, is carried or is done, and its place (5 each); places of stations (4); time; share done.

    **End**: terminated when all garbage is dumped, truncated at the time limit. **Infos**, the same keys for each
    agent: `time_s`, `garbage_done`, `mission_collision_events`, `own_dumped`, `action_mask` (O,) and others.

    Args:
        mission: its name in `configs/missions` ("table1" unless given), its path, its keys, or the model.
        render_mode: None, "rgb_array", or "human", which shows every control period in a window.
        max_cycles: most steps of an episode, which is then truncated; None: as the mission has it.
        state: what `state` returns, the global state or all observations, one after the other.
        settings: see `EnvSettings`.

    Without `options={"start": StartConfiguration}` each reset draws a new start; episode k after `reset(seed=S)` is
    always the same. An episode terminates when all garbage is dumped and is truncated at the mission's time limit. The
    agents are the robots at work. A robot that fails or is taken away terminates and does not come back. A robot that
    joins during the mission is a possible agent from the beginning, and an agent from the end of the step in which it
    joins.

    Attributes:
        options: coordinated goal -> names of its options.
        observation_names: names of the components of an observation.
        state_names: names of the components of the global state.

    """

    metadata: dict[str, Any] = {  # noqa: RUF012
        "name": "clean_swarm_v0",
        "render_modes": [WINDOW, PICTURE],
        "render_fps": 1,
        "is_parallelizable": True,
    }

    @spelled_out
    def __init__(
        self,
        mission: GivenMission | None = None,
        *,
        render_mode: str | None = None,
        max_cycles: int | None = None,
        state: Literal["global", "observations"] = "global",
        **settings: Unpack[EnvSettings],
    ) -> None:
        if state not in ("global", "observations"):
            raise ValueError(f"state: expected 'global' or 'observations', got {state!r}")
        batch = Batch(mission, begin_anew=False, **settings)
        self._show(batch, render_mode)
        self._cycles = None if max_cycles is None else whole_number(max_cycles, "max_cycles", 1)
        self.mission, self.options = batch.mission, batch.options
        self.possible_agents = [f"robot_{row}" for row in range(batch.robots)]
        self.agents: list[str] = []
        self.observation_spaces = {agent: observation_space(batch) for agent in self.possible_agents}
        self.action_spaces = {agent: action_space(batch) for agent in self.possible_agents}
        self._state = batch.global_state()
        self.observation_names, self.state_names = batch.observer.names, self._state.names
        self._sees_all = state == "global"
        whole = gymnasium.spaces.Box(-1.0, 1.0, (len(self.state_names),), np.float32)
        self.state_space = whole if self._sees_all else observation_space(batch, batch.robots)
        space, mode, options = action_space(batch), batch.action.mode, batch.choices.default
        self._choices = int(space.n) if isinstance(space, gymnasium.spaces.Discrete) else 0
        kinds = {"option": options[0] if self._choices else options, "velocity": np.zeros(2)}
        self._idle = kinds.get(mode, np.append(options, np.zeros(2)))  # the action of robots that join during a period

    def observation_space(self, agent: str) -> gymnasium.spaces.Box:
        """Return the space of an agent's observations: always the same object."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> gymnasium.Space[Any]:
        """Return the space of an agent's actions: always the same object."""
        return self.action_spaces[agent]

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Observations], AgentInfos]:
        """Begin an episode; `options["start"]` may give a `StartConfiguration` or its keys."""
        self.batch.reset([seed], [start_of(options, ("start", "options"))])  # PettingZoo's tests give {"options": 1}
        self.agents = self.at_work()
        return self.seen(self.agents)

    def step(self, actions: Mapping[str, AgentAction]) -> AgentsStep:
        """Run one decision period; the period ends early when the mission does."""
        if not self.agents:
            raise RuntimeError("step: the episode is over (or has not begun), call reset first")
        step = self.batch.step(self._checked(actions))
        terminated = bool(step.terminated[0])
        truncated = not terminated and (bool(step.truncated[0]) or self._cut())
        before, after = self.agents, self.at_work()
        changed = before != after
        gone = set(before).difference(after) if changed else ()
        joined = set(after).difference(before) if changed else ()
        there = [agent for agent in self.possible_agents if agent in before or agent in joined] if joined else before
        gained = self._of(there, step.rewards.tolist()) | dict.fromkeys(joined, 0.0)
        self.agents = [] if terminated or truncated else after
        observations, infos = self.seen(there)
        return (
            observations,
            gained,
            dict.fromkeys(there, terminated) | dict.fromkeys(gone, True),
            dict.fromkeys(there, truncated) | dict.fromkeys(gone, False),
            infos,
        )

    def set_state(self, state: bytes) -> tuple[dict[str, Observations], AgentInfos]:
        """Go on from a state of an environment or of a world of a batch; return observations and infos.

        The counts of the last period are no part of it. ValueError says what is damaged or does not fit, and then
        nothing has changed.
        """
        self.batch.set_state(state)
        self.agents = [] if self.batch.over[0] or self._cut() else self.at_work()
        return self.seen(self.at_work())

    def seen(self, agents: list[str]) -> tuple[dict[str, Observations], AgentInfos]:
        """Return the present observations and infos of some of the possible agents."""
        return self._of(agents, self.batch.observations.copy()), self._of(agents, robot_infos(self.batch))

    @property
    def agents_by_model(self) -> dict[str, list[str]]:
        """All possible agents by the models of their robots, as learners group them that have a policy for each."""
        names, models = [model.model for model in self.mission.robots.models], self.mission.models.tolist()
        return {
            name: [agent for agent, model in zip(self.possible_agents, models, strict=True) if model == number]
            for number, name in enumerate(names)
        }

    def at_work(self) -> list[str]:
        """Return the agents whose robots are at work, also when the episode is over."""
        working = self.batch.working.tolist()
        return [agent for agent, works in zip(self.possible_agents, working, strict=True) if works]

    def state(self) -> Observations:
        """Return the global state (G,), see `GlobalState`, or all observations (N * F,)."""
        return self._state.now()[0] if self._sees_all else self.batch.observations.ravel().copy()

    def _cut(self) -> bool:
        """Return whether the episode has had `max_cycles` steps."""
        return self._cycles is not None and self.batch.steps(0) >= self._cycles

    def _of(self, agents: list[str], rows: Iterable[Any]) -> dict[str, Any]:
        """Return the values of `agents` among `rows` (N,)."""
        every = dict(zip(self.possible_agents, rows, strict=True))
        return every if len(agents) == len(every) else {agent: every[agent] for agent in agents}

    def _checked(self, actions: Mapping[str, AgentAction]) -> NDArray[Any]:
        """Return `actions` as rows, or raise TypeError or ValueError."""
        if not isinstance(actions, Mapping):
            raise TypeError(f"actions: expected a dictionary with one for each agent, got {brief(actions)}")
        if actions.keys() != set(self.agents):
            missing = sorted(set(self.agents) - actions.keys())
            unknown = sorted(actions.keys() - set(self.agents), key=str)
            raise ValueError(f"actions: expected one for each agent, missing {missing}, unknown {unknown}")
        choices = self._choices
        for agent, action in actions.items():
            if choices and isinstance(action, INTEGRAL) and 0 <= action < choices:
                continue  # the answer of `contains`, in a tenth of its time
            space = self.action_spaces[agent]
            if not space.contains(action):
                expected = f"0..{space.n - 1}" if isinstance(space, gymnasium.spaces.Discrete) else repr(space)
                raise ValueError(f"actions[{agent!r}]: expected {expected}, got {brief(action)}")
        given: Mapping[str, Any] = actions
        if self.batch.action.mode == "both":
            given = {agent: np.hstack([action[OPTION], action[CORRECTION]]) for agent, action in given.items()}
        return np.array([given.get(agent, self._idle) for agent in self.possible_agents])


class WholeSettings(EnvSettings, total=False):
    """All that `CleanSwarm` takes by name only."""

    render_mode: str | None
    """None, "rgb_array", or "human"."""
    max_cycles: int | None
    """Most steps of an episode, which is then truncated; None: as the mission has it."""
    state: Literal["global", "observations"]
    """What `state` returns."""


parallel_env = CleanSwarm


@spelled_out
def raw_env(
    mission: GivenMission | None = None, **settings: Unpack[WholeSettings]
) -> AECEnv[str, Observations, AgentAction]:
    """Return the environment in which robots act one after the other (by PettingZoo's own conversion).

    The arguments are those of `CleanSwarm`.
    """
    return parallel_to_aec_wrapper(CleanSwarm(mission, **settings))


@spelled_out
def env(
    mission: GivenMission | None = None, **settings: Unpack[WholeSettings]
) -> AECEnv[str, Observations, AgentAction]:
    """Return the environment of `raw_env`, which also raises an error for calls in a wrong order."""
    return OrderEnforcingWrapper(raw_env(mission, **settings))
