"""Mechanisms that move cleaning robots by themselves, and the record by which compiled stages know robots' minds."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final

import numpy as np

from clean_swarm_env.tasks.cleaning.records import MINDS, MindsRecord
from clean_swarm_env.tasks.cleaning.settings import settings_of
from clean_swarm_env.tasks.cleaning.site import ITEM_CHANNEL
from clean_swarm_env.world.view import World
from selforg.arrays import Ints
from selforg.commands import Commands
from selforg.compiler.records import Packed
from selforg.mechanisms import ChemotaxisBalch, MovementMechanism, Patrol, Pheromone

PHEROMONES: Final = "pheromone"
"""Channel of the pheromones that patrolling robots deposit."""
HANDLING = ("PickGarbage", "Recycle", "Dump")
"""Behaviours that handle cargo."""
TRANSPORT = ("MoveToRecycling", "MoveToDump")
"""Behaviours that go to the nearest station of a kind."""


class Movers:
    """The mechanisms of MoveToGarbage and Patrol.

    Attributes:
        mechanisms: by the behaviours of the robots' network, also those that a robot's document replaces.
        packed: the record that compiled code takes.

    """

    def __init__(self, world: World) -> None:
        minds, config = world.minds, settings_of(world.mission).patrol
        pheromone = Pheromone(PHEROMONES, -1, config.diffusion, config.evaporation_factor, config.evaporation_period)
        self.mechanisms: dict[str, MovementMechanism] = {
            "MoveToGarbage": ChemotaxisBalch(
                minds.buffers["items"], channels=(ITEM_CHANNEL,), directions=minds.directions
            ),
            "Patrol": Patrol(
                minds.buffers["pheromones"],
                pheromone=pheromone,
                min_speed=config.min_speed,
                max_speed=config.max_speed,
                channels=(PHEROMONES,),
                directions=minds.directions,
            ),
        }
        index = minds.network.model.behaviour_index
        moving = {k: m for k, m in self.mechanisms.items() if k in index and k not in minds.robot.inner}
        self._moving = tuple(moving.values())
        self.packed: Packed[MindsRecord] = MINDS.pack(
            MindsRecord(
                readings=minds.network.readings,
                marks=minds.network.state.marks,
                handling=np.array([index[name] for name in HANDLING], dtype=np.int64),
                transport=np.array([index[name] for name in TRANSPORT], dtype=np.int64),
                movers=np.array([index[name] for name in moving], dtype=np.int64),
                starting=np.zeros((world.rows, 3), dtype=np.bool_),
                running=np.zeros((len(moving), world.rows), dtype=np.int64),
                counts=np.zeros(len(moving), dtype=np.int64),
            )
        )

    def move(self, now: float, commands: Commands) -> None:
        """Command the robots whose networks run a mechanism."""
        for mechanism, rows in self._running():
            mechanism.move_into(now, rows, commands.vectors, commands.commanded)

    def deposit(self, now: float) -> None:
        """Leave the pheromones of robots that patrol."""
        for mechanism, rows in self._running():
            if isinstance(mechanism, Patrol):
                mechanism.deposit(now, rows)

    def _running(self) -> Iterator[tuple[MovementMechanism, Ints]]:
        """Yield the mechanisms of this tick, and the rows that they move."""
        record = self.packed.record
        for mechanism, rows, count in zip(self._moving, record.running, record.counts.tolist(), strict=True):
            if count:
                yield mechanism, rows[:count]
