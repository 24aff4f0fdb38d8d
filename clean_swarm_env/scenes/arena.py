"""W worlds of N robots on one ground, without networks: bodies, drives, poses, clock and random draws.

Rows are robots, R = W * N. A world depends on its own seed only, alone or in a batch.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil
from typing import Final, Literal, TypeVar

import numpy as np
from numpy.typing import NDArray

from clean_swarm_env.physics.collisions import CollisionCounter
from clean_swarm_env.physics.drive import DifferentialDrive, DriveSettings
from clean_swarm_env.physics.physics import Physics
from clean_swarm_env.physics.settings import Contacts, PhysicsSettings
from clean_swarm_env.scenes.ground import Ground
from selforg.arrays import Ints
from selforg.commands import Commands
from selforg.elementary import directions
from selforg.gradients.poses import OwnPoses
from selforg.randomness import DirectionStream

T = TypeVar("T", bound=np.generic)
DriveKind = Literal["differential", "holonomic"]

SUBSTEPS: Final = 4  # physics steps in a control period
TIMESTEP: Final = 0.05  # [s] of physics
CONTROL_PERIOD: Final = ceil(0.2 * 2**30) / 2**30  # [s] of control, on a grid that floats hold exactly (see Clock)
CLOSE: Final = 0.55  # [m] between centres below which a pair counts as colliding, as in the mission
PLACES, THINGS, STREAMS, DRAWS, BASELINES = range(5)  # kinds of random draws, each with a seed of its own


@dataclass(frozen=True)
class Body:
    """The body of all robots of a scene.

    Attributes:
        radius: of the disc [m].
        max_speed: [m/s].
        drive: differential robots turn into their direction, holonomic ones move in it at once.
        contacts: whether robots are solid.
        pose_goal_radius, pose_diffusion: of the repulsive gradient that each robot carries [m].

    """

    radius: float = 0.25
    max_speed: float = 1.0
    drive: DriveKind = "differential"
    contacts: Contacts = "solid"
    pose_goal_radius: float = 0.5
    pose_diffusion: float = 1.0


class Arena:
    """The bodies of W worlds; a `Controller` commands them.

    Attributes:
        positions, headings: (R, 2) [m] and (R,) [rad]; the same arrays all the time.
        poses: the pose gradients as of the last `announce`.
        directions: random directions of each row.
        collisions: counts of pairs closer than CLOSE.
        entered: (R,) collision events since the start in which the robot took part.
        now: [s] since the start.

    """

    def __init__(self, ground: Ground, robots: int, seeds: Sequence[int], body: Body) -> None:
        self.ground, self.robots, self.worlds, self.body = ground, robots, len(seeds), body
        self.rows = self.worlds * robots
        side = ground.side
        self.physics = Physics(PhysicsSettings(self.worlds, robots, side, side, body.radius, body.contacts, TIMESTEP))
        self.positions, self.headings = self.physics.positions, self.physics.headings
        self.drive = DifferentialDrive(self.rows, DriveSettings(max_speed=body.max_speed))
        self.collisions = CollisionCounter(self.worlds, robots, side, side, (CLOSE,))
        self.world_of_row: Ints = np.repeat(np.arange(self.worlds), robots)
        self.entered: Ints = np.zeros(self.rows, dtype=np.int64)
        self.poses = OwnPoses(
            ground.space, self.rows, self.world_of_row, diffusion=body.pose_diffusion, goal_radius=body.pose_goal_radius
        )
        self._seeds = [np.random.SeedSequence(seed).spawn(5) for seed in seeds]
        self.directions = DirectionStream(self.generators(STREAMS))
        self.ticks = 0

    @property
    def now(self) -> float:
        """Time since the start [s]."""
        return self.ticks * CONTROL_PERIOD

    def chance(self, world: int, what: int) -> np.random.Generator:
        """Return a new generator of a world for one kind of its random draws."""
        return np.random.default_rng(self._seeds[world][what])

    def generators(self, what: int) -> list[np.random.Generator]:
        """Return a new generator for each row (R,)."""
        roots = [np.random.SeedSequence(s[what].entropy, spawn_key=s[what].spawn_key) for s in self._seeds]
        return [np.random.default_rng(child) for root in roots for child in root.spawn(self.robots)]

    def by_world(self, values: NDArray[T]) -> NDArray[T]:
        """Return values (R, ...) as (W, N, ...)."""
        return values.reshape(self.worlds, self.robots, *values.shape[1:])

    def announce(self) -> None:
        """Spread the poses of all robots now."""
        self.poses.update(self.positions, self.headings, self.now)

    def move(self, commands: Commands) -> None:
        """Move the robots by their commands for one control period."""
        vectors, commanded = commands.vectors, commands.commanded
        if self.body.drive == "holonomic":
            turned = commanded & ~commands.in_place & (vectors != 0.0).any(axis=1)
            self.headings[turned] = directions(vectors[turned])
        self.drive.command(vectors, commanded, self.headings, self.now)
        self.drive.speed[commands.in_place] = 0.0
        for _ in range(SUBSTEPS):
            self.physics.substep(self.drive.speed, self.drive.turn_rate)
            self.collisions.count(self.positions)
            self.entered += self.collisions.entered
        self.ticks += 1
