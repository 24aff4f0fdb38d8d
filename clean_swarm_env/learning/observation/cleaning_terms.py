"""Terms about the robot's task: garbage, cargo, phase and stations."""

from __future__ import annotations

from clean_swarm_env.learning.observation.around import Around, copy_way, write_way
from clean_swarm_env.learning.observation.term import compiled_term
from clean_swarm_env.learning.phases import PHASES
from clean_swarm_env.tasks.cleaning.garbage import NOTHING
from selforg.arrays import Floats


@compiled_term("garbage", "garbage_seen", "garbage_distance", "garbage_ahead", "garbage_left")
def see_garbage(around: Around, row: int, out: Floats) -> None:
    """The nearest item: whether one lies within sight, and the way to it by the range of sight."""
    out[1] = 1.0
    if around.item[row] >= 0:
        out[0] = 1.0
        place = around.items[row // around.robots, around.item[row]]
        write_way(around, row, place, around.sight, out[1:])


@compiled_term("cargo", "carrying", "recycled")
def see_cargo(around: Around, row: int, out: Floats) -> None:
    """Whether the robot carries something, and whether that has been recycled."""
    out[0], out[1] = around.cargo[row] != NOTHING, around.recycled[row] == 1


@compiled_term("phase", *(f"phase_{phase}" for phase in PHASES))
def see_phase(around: Around, row: int, out: Floats) -> None:
    """One flag: nothing in sight, an item in sight, on the way to recycling, on the way to the dump."""
    out[around.phases[row]] = 1.0


@compiled_term("situation", "free_far", "free_near", "carrying_far", "carrying_near")
def see_situation(around: Around, row: int, out: Floats) -> None:
    """One flag: without or with cargo, far from all stations or within `station_range` of one."""
    near = min(around.station_distances[row, 0], around.station_distances[row, 1]) <= around.station_range
    out[2 * (around.cargo[row] != NOTHING) + near] = 1.0


@compiled_term("recycling", "recycling_distance", "recycling_ahead", "recycling_left")
def see_recycling(around: Around, row: int, out: Floats) -> None:
    """The way to the nearest recycling station, by half the torus' diagonal."""
    copy_way(around.station_ways[row, 0], out)


@compiled_term("dump", "dump_distance", "dump_ahead", "dump_left")
def see_dump(around: Around, row: int, out: Floats) -> None:
    """The way to the nearest dump, by half the torus' diagonal."""
    copy_way(around.station_ways[row, 1], out)


@compiled_term("nearness", "recycling_near", "dump_near")
def see_nearness(around: Around, row: int, out: Floats) -> None:
    """How near the nearest stations are: 1 at a station, 0 from `station_range` on."""
    for station in range(2):
        out[station] = max(1.0 - around.station_distances[row, station] / around.station_range, 0.0)


@compiled_term("target", "target_distance", "target_ahead", "target_left")
def see_target(around: Around, row: int, out: Floats) -> None:
    """The way to the nearest station that the cargo has to go to, by half the torus' diagonal."""
    out[0] = 1.0
    if around.cargo[row] != NOTHING:
        copy_way(around.station_ways[row, 1 if around.recycled[row] == 1 else 0], out)
