"""Terms about the robot's task: garbage, cargo, phase and stations."""

from __future__ import annotations

from clean_swarm_env.learning.observation.around import Around, open_around, write_way
from clean_swarm_env.learning.observation.term import TERMS, CompiledTerm
from clean_swarm_env.learning.phases import PHASES
from clean_swarm_env.world.garbage import NOTHING
from selforg.arrays import Floats
from selforg.compiler.decorators import part
from selforg.compiler.records import Words


@TERMS.register
class GarbageTerm(CompiledTerm):
    """The nearest item: whether one lies within sight, and the way to it by the range of sight."""

    name = "garbage"
    components = ("garbage_seen", "garbage_distance", "garbage_ahead", "garbage_left")

    @staticmethod
    @part
    def see(around: Words[Around], row: int, out: Floats) -> None:
        a = open_around(around)
        out[1] = 1.0
        if a.item[row] >= 0:
            out[0] = 1.0
            write_way(a, row, a.items[row // (a.present.shape[0] // a.team.shape[0]), a.item[row]], a.sight, out[1:])


@TERMS.register
class CargoTerm(CompiledTerm):
    """Whether the robot carries something, and whether that has been recycled."""

    name = "cargo"
    components = ("carrying", "recycled")

    @staticmethod
    @part
    def see(around: Words[Around], row: int, out: Floats) -> None:
        a = open_around(around)
        out[0], out[1] = a.cargo[row] != NOTHING, a.recycled[row] == 1


@TERMS.register
class PhaseTerm(CompiledTerm):
    """One flag: nothing in sight, an item in sight, on the way to recycling, on the way to the dump."""

    name = "phase"
    components = tuple(f"phase_{phase}" for phase in PHASES)

    @staticmethod
    @part
    def see(around: Words[Around], row: int, out: Floats) -> None:
        out[open_around(around).phases[row]] = 1.0


@TERMS.register
class SituationTerm(CompiledTerm):
    """One flag: without or with cargo, far from both stations or within `station_range` of one."""

    name = "situation"
    needs = ("stations",)
    components = ("free_far", "free_near", "carrying_far", "carrying_near")

    @staticmethod
    @part
    def see(around: Words[Around], row: int, out: Floats) -> None:
        a = open_around(around)
        near = min(a.station_distances[row, 0], a.station_distances[row, 1]) <= a.station_range
        out[2 * (a.cargo[row] != NOTHING) + near] = 1.0


@TERMS.register
class RecyclingTerm(CompiledTerm):
    """The way to the recycling station, by half the torus' diagonal."""

    name = "recycling"
    needs = ("stations",)
    components = ("recycling_distance", "recycling_ahead", "recycling_left")

    @staticmethod
    @part
    def see(around: Words[Around], row: int, out: Floats) -> None:
        a = open_around(around)
        for k in range(3):
            out[k] = a.station_ways[row, 0, k]


@TERMS.register
class DumpTerm(CompiledTerm):
    """The way to the dump, by half the torus' diagonal."""

    name = "dump"
    needs = ("stations",)
    components = ("dump_distance", "dump_ahead", "dump_left")

    @staticmethod
    @part
    def see(around: Words[Around], row: int, out: Floats) -> None:
        a = open_around(around)
        for k in range(3):
            out[k] = a.station_ways[row, 1, k]


@TERMS.register
class NearnessTerm(CompiledTerm):
    """How near the stations are: 1 at a station, 0 from `station_range` on."""

    name = "nearness"
    needs = ("stations",)
    components = ("recycling_near", "dump_near")

    @staticmethod
    @part
    def see(around: Words[Around], row: int, out: Floats) -> None:
        a = open_around(around)
        for station in range(2):
            out[station] = max(1.0 - a.station_distances[row, station] / a.station_range, 0.0)


@TERMS.register
class TargetTerm(CompiledTerm):
    """The way to the station that the cargo has to go to, by half the torus' diagonal."""

    name = "target"
    needs = ("stations",)
    components = ("target_distance", "target_ahead", "target_left")

    @staticmethod
    @part
    def see(around: Words[Around], row: int, out: Floats) -> None:
        a = open_around(around)
        out[0] = 1.0
        if a.cargo[row] != NOTHING:
            for k in range(3):
                out[k] = a.station_ways[row, 1 if a.recycled[row] == 1 else 0, k]
