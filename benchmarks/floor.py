"""The floor: the cost of pymunk alone for the same robots, seams and substeps, and that of our physics beside it.

The floor calls pymunk in every substep, by the cheapest path: one compiled call for the forces of all worlds, and one C
call each to write the forces of a world, to step the world and to read it back. Bodies near a seam get copies, checked
once a tick. There are no headings, no collision counts and no mission. In the column `all copies` every body has all
its copies all the time.

    python -m benchmarks.floor

Shapes: W worlds, N robots a world, R = W * N rows, T ticks.
"""

from collections.abc import Callable
from math import ceil, sqrt
from statistics import median
from time import process_time

import numpy as np
from numpy.typing import NDArray

from benchmarks.shared.pymunk_space import PymunkSpace, find_copies, push_bodies, wrap_bodies
from clean_swarm_env.physics.collisions import CollisionCounter
from clean_swarm_env.physics.drive import DifferentialDrive
from clean_swarm_env.physics.motion import COPY_OFFSETS
from clean_swarm_env.physics.physics import Physics, PhysicsSettings
from selforg.commands import Commands
from selforg.program import Program

SUBSTEPS = 4  # a tick
WARM_UP = 20  # ticks before the measurement: spaces are built, robots have met
WALK = 256  # ticks after which the walk at random begins again
REPEATS = 7
SIZES = ((1, 5, 11.0), (64, 5, 11.0), (1, 50, 34.8), (1, 200, 69.6), (1, 1000, 155.6))  # W, N, width [m]


def floor_seconds_per_tick(
    worlds: int, robots: int, width: float, ticks: int, everywhere: bool = False, seed: int = 0
) -> float:
    """Return the CPU seconds of pymunk alone for a tick of four substeps of all worlds, robots walking at random."""
    floor = floor_at_start(worlds, robots, width, everywhere, seed)
    for _ in range(WARM_UP):
        floor.walk()
    begin = process_time()
    for _ in range(ticks):
        floor.walk()
    return (process_time() - begin) / ticks


def floor_at_start(worlds: int, robots: int, width: float, everywhere: bool = False, seed: int = 0) -> "Floor":
    """Return worlds of robots that do not touch at first."""
    settings = PhysicsSettings(worlds, robots, width, width)
    rng = np.random.default_rng(seed)
    return Floor(settings, lattice(settings, rng), everywhere, rng)


class Floor:
    """Pymunk alone, with rows as in Physics; with `everywhere`, bodies always have all copies."""

    def __init__(
        self, settings: PhysicsSettings, places: NDArray[np.float64], everywhere: bool, rng: np.random.Generator
    ) -> None:
        headings = np.cumsum(rng.uniform(-0.4, 0.4, (WALK, len(places))), axis=0)
        self._wanted = np.stack([np.cos(headings), np.sin(headings)], axis=2)  # (WALK, R, 2) [m/s]
        self._walked = 0
        self._settings = settings
        # A body moves by up to 0.2 m until the copies are checked again; `everywhere` takes the whole world.
        self._zone = settings.width if everywhere else 4.0 * settings.radius + SUBSTEPS * settings.timestep
        self._bodies = np.hstack([places, np.zeros_like(places)])  # (R, 4) x, y, vx, vy [m, m/s]
        self._forces = np.zeros_like(places)
        self._copies = np.zeros((len(places), len(COPY_OFFSETS)), np.bool_)
        self._blocks = [
            slice(world * settings.robots, (world + 1) * settings.robots) for world in range(settings.worlds)
        ]
        self._spaces = [PymunkSpace(settings, self._bodies[block], self._forces[block]) for block in self._blocks]
        for space in self._spaces:
            space.load()

    def walk(self) -> None:
        """Run one tick of a random walk, which begins again at its end."""
        self.tick(self._wanted[self._walked % WALK])
        self._walked += 1

    def tick(self, wanted: NDArray[np.float64]) -> None:
        """Run four substeps with the wanted velocities (R, 2) [m/s], after the copies are checked."""
        size, timestep = (self._settings.width, self._settings.height), self._settings.timestep
        crossed = wrap_bodies(self._bodies, *size)
        find_copies(self._bodies, *size, self._zone, self._copies)
        for space, block in zip(self._spaces, self._blocks, strict=True):
            if crossed:
                space.load()
            space.set_copies(self._copies[block])
        for _ in range(SUBSTEPS):
            push_bodies(self._bodies, wanted, timestep, self._forces)
            for space in self._spaces:
                space.step(timestep)


def lattice(settings: PhysicsSettings, rng: np.random.Generator) -> NDArray[np.float64]:
    """Return places (R, 2) [m] of robots that do not touch at first."""
    side = ceil(sqrt(settings.robots))
    pitch = settings.width / side
    spots = np.stack(np.divmod(np.arange(settings.robots), side), axis=1) * pitch
    shake = max(pitch - 2.0 * settings.radius, 0.0)
    return np.concatenate([spots + rng.uniform(0.0, shake, spots.shape) for _ in range(settings.worlds)])


def physics_seconds_per_tick(worlds: int, robots: int, width: float, ticks: int, seed: int = 0) -> float:
    """Return the CPU seconds of our physics for the same, with headings, drives and collision counts."""
    physics, drive = Physics(PhysicsSettings(worlds, robots, width, width)), DifferentialDrive(worlds * robots)
    counter, commands = CollisionCounter(worlds, robots, width, width), Commands(worlds * robots, 2)
    rng = np.random.default_rng(seed)
    places, headings = lattice(physics.settings, rng), np.zeros(robots)
    for world in range(worlds):
        physics.place(world, places[world * robots : (world + 1) * robots], headings)
    drive.speed[:] = 1.0
    turn_rates = rng.uniform(-2.0, 2.0, (WARM_UP + ticks, worlds * robots))  # 0.4 rad in a tick, as the floor's walk
    program = Program(lambda: [physics.ticking(SUBSTEPS, commands.packed, drive, counter)])
    for tick in range(WARM_UP + ticks):
        if tick == WARM_UP:
            begin = process_time()
        drive.turn_rate[:] = turn_rates[tick]
        program.run(0.0)
    return (process_time() - begin) / ticks


def measure(worlds: int, robots: int, width: float) -> list[float]:
    """Return the median CPU seconds per tick of the three contestants, in alternating repeats."""
    ticks = max(20, 10_000 // (worlds * robots))
    contestants: list[Callable[[int], float]] = [
        lambda ticks: floor_seconds_per_tick(worlds, robots, width, ticks),
        lambda ticks: floor_seconds_per_tick(worlds, robots, width, ticks, everywhere=True),
        lambda ticks: physics_seconds_per_tick(worlds, robots, width, ticks),
    ]
    for contestant in contestants:
        contestant(2)  # compiled code is loaded before anything is measured
    repeats = [[contestant(ticks) for contestant in contestants] for _ in range(REPEATS)]
    return [median(times) for times in zip(*repeats, strict=True)]


def main() -> None:
    """Print CPU microseconds per tick and world."""
    print(f"CPU time of a tick (0.2 s, {SUBSTEPS} substeps) per world [us], median of {REPEATS} alternating repeats")
    print("worlds x robots   floor   all copies   our physics   physics / floor")
    for worlds, robots, width in SIZES:
        times = [1e6 * seconds / worlds for seconds in measure(worlds, robots, width)]
        cells = "".join(f"{time:{column}.1f}" for time, column in zip(times, (9, 13, 14), strict=True))
        print(f"{worlds:6d} x {robots:<6d}{cells}{times[2] / times[0]:18.2f}")


if __name__ == "__main__":
    main()
