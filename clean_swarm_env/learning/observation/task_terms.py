"""Terms about the robot's task: garbage, cargo, phase and stations."""

from __future__ import annotations

from clean_swarm_env.learning.observation.around import Around, copy_way, write_way
from clean_swarm_env.learning.observation.term import TERMS, CompiledTerm
from clean_swarm_env.learning.phases import PHASES
from clean_swarm_env.world.garbage import NOTHING
from selforg.arrays import Floats
from selforg.compiler.decorators import inlined


@TERMS.register
class GarbageTerm(CompiledTerm):
    """The nearest item: whether one lies within sight, and the way to it by the range of sight."""

    name = "garbage"
    components = ("garbage_seen", "garbage_distance", "garbage_ahead", "garbage_left")

    @staticmethod
    @inlined
    def see(around: Around, row: int, out: Floats) -> None:
        out[1] = 1.0
        if around.item[row] >= 0:
            out[0] = 1.0
            place = around.items[row // around.robots, around.item[row]]
            write_way(around, row, place, around.sight, out[1:])


@TERMS.register
class CargoTerm(CompiledTerm):
    """Whether the robot carries something, and whether that has been recycled."""

    name = "cargo"
    components = ("carrying", "recycled")

    @staticmethod
    @inlined
    def see(around: Around, row: int, out: Floats) -> None:
        out[0], out[1] = around.cargo[row] != NOTHING, around.recycled[row] == 1


@TERMS.register
class PhaseTerm(CompiledTerm):
    """One flag: nothing in sight, an item in sight, on the way to recycling, on the way to the dump."""

    name = "phase"
    components = tuple(f"phase_{phase}" for phase in PHASES)

    @staticmethod
    @inlined
    def see(around: Around, row: int, out: Floats) -> None:
        out[around.phases[row]] = 1.0


@TERMS.register
class SituationTerm(CompiledTerm):
    """One flag: without or with cargo, far from all stations or within `station_range` of one."""

    name = "situation"
    components = ("free_far", "free_near", "carrying_far", "carrying_near")

    @staticmethod
    @inlined
    def see(around: Around, row: int, out: Floats) -> None:
        near = min(around.station_distances[row, 0], around.station_distances[row, 1]) <= around.station_range
        out[2 * (around.cargo[row] != NOTHING) + near] = 1.0


@TERMS.register
class RecyclingTerm(CompiledTerm):
    """The way to the nearest recycling station, by half the torus' diagonal."""

    name = "recycling"
    components = ("recycling_distance", "recycling_ahead", "recycling_left")

    @staticmethod
    @inlined
    def see(around: Around, row: int, out: Floats) -> None:
        copy_way(around.station_ways[row, 0], out)


@TERMS.register
class DumpTerm(CompiledTerm):
    """The way to the nearest dump, by half the torus' diagonal."""

    name = "dump"
    components = ("dump_distance", "dump_ahead", "dump_left")

    @staticmethod
    @inlined
    def see(around: Around, row: int, out: Floats) -> None:
        copy_way(around.station_ways[row, 1], out)


@TERMS.register
class NearnessTerm(CompiledTerm):
    """How near the nearest stations are: 1 at a station, 0 from `station_range` on."""

    name = "nearness"
    components = ("recycling_near", "dump_near")

    @staticmethod
    @inlined
    def see(around: Around, row: int, out: Floats) -> None:
        for station in range(2):
            out[station] = max(1.0 - around.station_distances[row, station] / around.station_range, 0.0)


@TERMS.register
class TargetTerm(CompiledTerm):
    """The way to the nearest station that the cargo has to go to, by half the torus' diagonal."""

    name = "target"
    components = ("target_distance", "target_ahead", "target_left")

    @staticmethod
    @inlined
    def see(around: Around, row: int, out: Floats) -> None:
        out[0] = 1.0
        if around.cargo[row] != NOTHING:
            copy_way(around.station_ways[row, 1 if around.recycled[row] == 1 else 0], out)
