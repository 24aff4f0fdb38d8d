"""Single substeps of the physics, and single counts of collisions."""

import numpy as np

from clean_swarm_env.physics.collisions import CollisionCounter, count_world
from clean_swarm_env.physics.drive import DifferentialDrive
from selforg.commands import Commands
from selforg.program import Program


def substep(physics, speed, turn_rate):
    """Advance all worlds by one timestep; speed and turn_rate (R,)."""
    settings, rows = physics.settings, len(physics.positions)
    drive = DifferentialDrive(rows)
    drive.speed[:], drive.turn_rate[:] = speed, turn_rate
    counter = CollisionCounter(settings.worlds, settings.robots, settings.width, settings.height)
    Program(lambda: [physics.ticking(1, Commands(rows, 2).packed, drive, counter)]).run(0.0)


def count(counter, positions, present=True):
    """Count all worlds once: the robots `present` (R,) or all, at positions (R, 2)."""
    for world in range(len(counter.samples)):
        count_world(world, positions, np.full(len(positions), present), counter.packed.handle)
