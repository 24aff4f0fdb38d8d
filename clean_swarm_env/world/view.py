"""What a task knows of the worlds of a batch: robots, ground, time, buffers, knowledge and decisions.

Shapes: W worlds of N robots, R = W * N rows.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Annotated, Final, TypeVar

import numpy as np
from numpy.typing import NDArray

from clean_swarm_env.config.free_places import free_ground
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.physics.clock import Clock
from clean_swarm_env.world.floor import Floor
from clean_swarm_env.world.ground import Ground
from clean_swarm_env.world.minds import Minds
from clean_swarm_env.world.mission_end import tick_limit
from clean_swarm_env.world.parts.things import Things
from clean_swarm_env.world.team_changes import Team
from selector.configurations.running import RunningConfiguration
from selector.coordination.coordinator import Coordinator
from selforg.arrays import KEPT, READ, Flags, Floats, Ints
from selforg.components.memory import RobotMemory
from selforg.gradients.buffer import SoBuffer
from selforg.mechanisms import DecisionMechanism
from selforg.program import SENSE, Rows, Step
from selforg.walls.ways import UNKNOWN, Aims, Ways

V = TypeVar("V", bound=np.generic)
CARRYING: Final = "carrying"
"""What robots know that carry something."""


class TaskView:
    """The worlds of a batch, as a task reads them.

    Attributes:
        mission: the mission of the batch.
        worlds, robots, rows: W, N and R.
        ground: the ground, with its metric.
        period: length of a control period [s].
        max_speed: (R, 1) of the robots [m/s].
        every_row: (R,) all rows, 0..R-1.
        of_row: (R,) the world of each row.
        missions: (W,) those of the worlds until their next resets.
        limits: (W,) control periods after which these missions end.
        by_baseline: whether the baseline of the task commands the robots.
        floor, minds, team: bodies, what robots know and decide, and which of them are at work.

    """

    max_speed: Annotated[Floats, "R 1", READ]
    every_row: Annotated[Ints, "R", READ]
    of_row: Annotated[Ints, "R", READ]
    _targets: Annotated[list[Floats], "K", READ]
    limits: Annotated[Ints, "W", KEPT]

    def __init__(self, missions: Sequence[MissionConfig], floor: Floor, minds: Minds, team: Team, clock: Clock) -> None:
        self.floor, self.minds, self.team, self._clock, self.missions = floor, minds, team, clock, missions
        self.mission = missions[0]
        self.worlds, self.robots, self.rows = floor.worlds, floor.robots, floor.worlds * floor.robots
        self.ground: Ground = floor.ground
        self.period = clock.period
        self.max_speed = self.of_each("max_speed")[:, None]
        self.every_row = np.arange(self.rows)
        self.of_row = np.repeat(np.arange(self.worlds), self.robots)
        self.limits = np.full(self.worlds, tick_limit(self.mission))
        self.by_baseline = False
        self._aims: Aims | None = None  # things that gradients lead to round walls
        self._targets = []  # places of these things

    @cached_property
    def ways(self) -> Ways:
        """The ways round the walls, which all robots share; those of the largest robots."""
        mission = self.mission
        ways = Ways(free_ground(mission.world, mission.robots.radius), mission.world.ground == "torus")
        ways.corner = ways.corner + self.ground.corner
        return ways

    def go_round_to(self, things: Sequence[Things]) -> None:
        """Let gradients of `things` lead round the walls, if these attract and stay where they are.

        A gradient behind a wall then seems to lie in the direction of the way there, as far off as it is.
        """
        aims = [thing.places for thing in things if thing.attraction > 0 and not thing.moves and thing.count]
        if self.mission.world.has_walls and aims:
            self._targets = aims
            self._aims = Aims(self.ways, self.worlds, sum(places.shape[1] for places in aims))

    def finding_ways(self) -> list[Step]:
        """Return the steps that compute the ways to things of worlds that have begun, before robots sense."""
        return [] if self._aims is None else [Step(SENSE, lambda now, _: self.find_ways(), Rows.of(self.every_row))]

    def find_ways(self) -> None:
        """Compute the ways to things of worlds that have begun."""
        if self._aims is not None and (self._aims.numbers == UNKNOWN).any():
            self._aims.renew(np.concatenate(self._targets, axis=1))
            self.minds.poses.go_round(self.ways, self._aims)

    def forget_ways(self, world: int) -> None:
        """Forget where the things of a world were, which is about to begin."""
        if self._aims is not None:
            self._aims.numbers[world] = UNKNOWN

    def by_world(self, values: NDArray[V]) -> NDArray[V]:
        """Return values (R, ...) as (W, N, ...)."""
        return values.reshape(self.worlds, self.robots, *values.shape[1:])

    def of_each(self, key: str) -> Floats:
        """Return a setting of each robot (R,) by its model; see `RobotModel`."""
        return np.tile(self.mission.of_each(key), self.worlds)

    def nearest(self, row: int, places: Floats) -> float:
        """Return the distance from where the robot of a row decided last to the nearest of `places` (K, 2) [m]."""
        return float(self.ground.distances(self.minds.poses.positions[row], places).min())

    @property
    def centres(self) -> Floats:
        """The middle of the ground in each world, as the place of a thing (W, 1, 2) [m]."""
        return np.broadcast_to(self.ground.centre, (self.worlds, 1, 2))

    @property
    def positions(self) -> Floats:
        """Positions of the robots (W, N, 2) [m]."""
        return self.by_world(self.floor.physics.positions)

    @property
    def headings(self) -> Floats:
        """Headings of the robots (W, N) [rad]."""
        return self.by_world(self.floor.physics.headings)

    @property
    def tick(self) -> int:
        """Control periods of the batch; they go on through resets."""
        return self._clock.tick

    @property
    def ticks(self) -> Ints:
        """Control periods (W,) since the start of each world."""
        return self._clock.ticks

    @property
    def seconds(self) -> Floats:
        """Time (W,) since the start of each world [s]."""
        return self._clock.ticks.astype(np.float64) * self.period

    @property
    def robot_minutes(self) -> Floats:
        """Minutes (W,) of all robots of a world within its whole mission."""
        return self.limits.astype(np.float64) * (self.robots * self.period / 60.0)

    @property
    def now(self) -> float:
        """Time of the buffers [s]; it goes on through resets."""
        return self._clock.now

    @property
    def collisions(self) -> Ints:
        """Collision events (W,) since the start: pairs that came closer than the first collision distance."""
        return self.floor.collisions.events[:, 0]

    @property
    def buffers(self) -> Mapping[str, SoBuffer]:
        """The buffers of the robots, by name."""
        return self.minds.buffers

    @property
    def memory(self) -> RobotMemory:
        """Knowledge of every robot, by name, shared by all options."""
        return self.minds.memory

    @property
    def carrying(self) -> Flags:
        """Which robots (R,) know that they carry something.

        The task says it (`known`) for the baseline, or where no option asks for it.
        """
        asked = {CARRYING: self.memory[CARRYING].values} if CARRYING in self.memory.kinds else {}
        told = self.minds.known() if self.by_baseline or not asked else {}
        carrying: Flags = {CARRYING: np.zeros(self.rows), **asked, **told}[CARRYING] == 1.0
        return carrying

    @property
    def steers(self) -> Flags:
        """Which robots (R,) hold an option that changes commands instead of giving some."""
        found: Flags = self._coordinator.steers[self._coordinator.held] == 1
        return found

    def directions(self, rows: Ints) -> Floats:
        """Return random unit vectors (K, 2), each from the stream of its row (K,)."""
        return self.minds.directions.next_directions(rows)[:, :2]

    def decisions(self) -> tuple[Floats, Ints]:
        """Return what robots have decided: values and states (W, N) of the decision mechanism that each holds."""
        values, states = np.zeros(self.rows), np.zeros(self.rows, dtype=np.int64)
        for option in self._coordinator.used:
            rows = self._coordinator.held == option
            mechanism = deciding(self._coordinator.contents[option])
            values[rows], states[rows] = mechanism.values[rows], mechanism.state_codes[rows]
        return self.by_world(values), self.by_world(states)

    @property
    def _coordinator(self) -> Coordinator:
        return self.minds.coordinators[0]


def deciding(content: RunningConfiguration) -> DecisionMechanism:
    """Return the first decision mechanism of a configuration."""
    for mechanism in content.mechanisms.values():
        if isinstance(mechanism, DecisionMechanism):
            return mechanism
    raise ConfigurationError("expected an option with a decision mechanism, got one that decides nothing")
