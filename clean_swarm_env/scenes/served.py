"""A team served by a coordinator, which runs an option of one goal in the robots of a scene."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from clean_swarm_env.config.errors import ConfigurationError
from clean_swarm_env.scenes.arena import DRAWS
from clean_swarm_env.scenes.baselines import Controller
from clean_swarm_env.scenes.scene import Scene
from selector.configurations.host import Host, host_memory
from selector.configurations.library import Library
from selector.configurations.running import RunningConfiguration
from selector.coordination.coordinator import Coordinator
from selector.coordination.model import CoordinatorModel
from selector.coordination.robots import CoordinatedRobots
from selector.knowledge import Knowledge, load_knowledge
from selector.strategies.max_score import MaxScore
from selforg.arrays import Floats, Ints
from selforg.commands import Commands
from selforg.mechanisms import DecisionMechanism
from selforg.registry import unknown

KNOWLEDGE = "library"
"""Name of the expert knowledge that has the goals of the scenes."""


@dataclass(frozen=True)
class Expertise:
    """The options of a goal, and the one that is taken.

    Attributes:
        model: the options with their configurations.
        option: number of the option that all robots hold.

    """

    model: CoordinatorModel
    option: int

    @property
    def name(self) -> str:
        """Name of the option."""
        return self.model.options[self.option]


def expertise(
    goal: str, option: str | None = None, directories: Sequence[Path] = (), knowledge: Knowledge | str = KNOWLEDGE
) -> Expertise:
    """Return the options of a goal in some expert knowledge, with the named option or that of the highest score taken.

    `knowledge` may be the name of a file.

    Raises:
        ConfigurationError: no such goal or option, or a mistake in a file.

    """
    known = load_knowledge(knowledge, directories) if isinstance(knowledge, str) else knowledge
    model = CoordinatorModel(goal, known, Library(directories))
    if option is None:
        strategy = MaxScore(model.problem(), np.zeros(1, dtype=np.uint64))
        return Expertise(model, int(strategy.select(np.zeros((1, 0)))[0]))
    if option not in model.options:
        raise ConfigurationError(f"goal {goal}: {unknown('option', option, model.options)}")
    return Expertise(model, model.options.index(option))


class ServedTeam(Controller):
    """Robots that consist of one coordinator, which commands them.

    Attributes:
        memory: knowledge of every robot, shared by all options; at first that of the scene.
        options: names of the options of the goal.
        buffers: what the robots perceive and leave, by the names that configurations use.
        minds: coordinator and networks of the robots; `explained` ones note why each behaviour runs or does not.

    """

    def __init__(self, scene: Scene, expert: Expertise, *, explained: bool = False) -> None:
        super().__init__(scene.arena)
        arena = scene.arena
        self._goal, self.buffers = expert.model.goal, scene.buffers()
        self.memory = host_memory(expert.model.configurations, arena.rows)
        for name, values in scene.known.items():
            if name in self.memory.kinds:
                self.memory[name].write(np.arange(arena.rows), values)
        host = Host(arena.poses, self.buffers, arena.directions, arena.generators(DRAWS), self.memory)
        self.minds = CoordinatedRobots(expert.model, host, explained=explained)
        self._steers = expert.model.configurations[expert.option].steers
        self._errand: Controller | None = None
        self.options = expert.model.options
        self.hold(np.full(arena.rows, expert.option))

    @property
    def coordinator(self) -> Coordinator:
        """The coordinator of which the robots consist."""
        return self.minds.coordinators[0]

    @property
    def held(self) -> Ints:
        """The option (R,) that each robot holds."""
        return self.coordinator.held

    @property
    def views(self) -> tuple[float, ...]:
        """View distances of the options [m]."""
        return tuple(float(content.view_distance) for content in self.minds.coordinators[0].contents)

    def hold(self, options: Ints) -> None:
        """Give each robot the option (R,) that serves the goal from now on."""
        self.minds.hold(options)

    def with_errand(self, errand: Controller) -> Controller:
        """Return the team on an errand, which an option that steers changes, and any other adds to."""
        if not self._steers:
            return super().with_errand(errand)
        self._errand = errand
        return self

    def decisions(self) -> tuple[Floats, Ints]:
        """Return values (R,) and states (R,) of the first decision mechanism of the option that each robot holds."""
        (coordinator,) = self.minds.coordinators
        values, states = np.zeros(self.arena.rows), np.zeros(self.arena.rows, dtype=np.int64)
        for option in coordinator.used:
            rows, mechanism = self.held == option, self._deciding(coordinator.contents[option])
            values[rows], states[rows] = mechanism.values[rows], mechanism.state_codes[rows]
        return values, states

    def _deciding(self, content: RunningConfiguration) -> DecisionMechanism:
        for mechanism in content.mechanisms.values():
            if isinstance(mechanism, DecisionMechanism):
                return mechanism
        raise ConfigurationError(f"goal {self._goal}: expected an option with a decision mechanism")

    def _command(self, commands: Commands) -> None:
        for buffer in self.buffers.values():
            buffer.deliver(self.arena.now)
        commands.copy_from(self.minds.tick(self.arena.now, self._errand.command() if self._errand else None))
