"""Mechanisms that move cleaning robots by themselves, and the record by which compiled stages know robots' minds."""

from __future__ import annotations

from typing import Annotated, Final

import numpy as np

from clean_swarm_env.tasks.cleaning.garbage import NOTHING
from clean_swarm_env.tasks.cleaning.records import MindsRecord
from clean_swarm_env.tasks.cleaning.settings import settings_of
from clean_swarm_env.tasks.cleaning.site import ITEM_CHANNEL, SAME_PLACE, Site
from clean_swarm_env.world.view import TaskView
from selforg.arrays import READ, Flags, Ints
from selforg.commands import Commands, Moved
from selforg.compiler.records import Packed
from selforg.mechanisms import ChemotaxisBalch, MovementMechanism, Patrol, Pheromone
from selforg.program import AFTER_ACTING, COMMANDING, Rows, Step

PHEROMONES: Final = "pheromone"
"""Channel of the pheromones that patrolling robots deposit."""
HANDLING = ("PickGarbage", "Recycle", "Dump")
"""Behaviours that handle cargo."""
TRANSPORT = ("MoveToRecycling", "MoveToDump")
"""Behaviours that go to the nearest station of a kind."""


NO_BEHAVIOUR: Final = -1


class Movers:
    """The mechanisms of MoveToGarbage and Patrol.

    Robots that see or carry otherwise than the task says go straight to the item that their sensors mean, which need
    not be the nearest.

    Attributes:
        mechanisms: by the behaviours of the robots' network, also those that a robot's document replaces.
        packed: the record that compiled code takes.
        to_garbage: number of the behaviour that goes to the nearest item, NO_BEHAVIOUR where others do.

    """

    _straight: Annotated[Flags, "R", READ]

    def __init__(self, world: TaskView, site: Site) -> None:
        minds, config = world.minds, settings_of(world.mission).patrol
        self._floor, self._ground = site.packed.record, world.ground
        self._straight = (self._floor.room != 1) | (world.of_each("sight") > 0.0)
        self._all_nearest = not self._straight.any()
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
        self.to_garbage = index["MoveToGarbage"] if "MoveToGarbage" not in minds.robot.inner else NO_BEHAVIOUR
        moving = {k: m for k, m in self.mechanisms.items() if k in index and k not in minds.robot.inner}
        self._of_behaviours = tuple(moving.values())
        self.packed: Packed[MindsRecord] = Packed(
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

    def steps(self, commands: Commands) -> list[Step]:
        """Return the steps that command the robots whose networks run a mechanism, and leave their pheromones."""
        steps, moved, record = [], Packed(Moved(commands.vectors, commands.commanded)), self.packed.record
        for number, mechanism in enumerate(self._of_behaviours):
            rows = Rows(record.running[number], record.counts[number : number + 1])
            if mechanism is self.mechanisms["MoveToGarbage"] and not self._all_nearest:
                steps.append(Step(COMMANDING, lambda now, rows: self._go_to_items(now, rows, commands), rows))
            else:
                steps += mechanism.moving(COMMANDING, rows, moved)
            if isinstance(mechanism, Patrol):
                steps += [step._replace(stage=AFTER_ACTING) for step in mechanism.spreader.depositing(rows)]
        return steps

    def _go_to_items(self, now: float, rows: Ints, commands: Commands) -> None:
        """Command `rows` (K,) to go to items: some straight, the others as their mechanism says."""
        straight = self._straight[rows]
        self._go_straight(rows[straight], commands)
        self.mechanisms["MoveToGarbage"].move_into(now, rows[~straight], commands.vectors, commands.commanded)

    def _go_straight(self, rows: Ints, commands: Commands) -> None:
        """Command `rows` (K,) to go to the items that their sensors mean, as fast as to a station."""
        floor = self._floor
        rows = rows[floor.nearest[rows] != NOTHING]
        items = floor.items[rows // (len(floor.robots) // len(floor.items)), floor.nearest[rows]]
        offsets = self._ground.offsets(floor.robots[rows], items)
        lengths = np.linalg.norm(offsets, axis=1, keepdims=True)
        commands.vectors[rows] = offsets / np.maximum(lengths, SAME_PLACE)
        commands.commanded[rows] = True
