"""Terms about the robot's task: garbage, cargo, phase and stations."""

from __future__ import annotations

from clean_swarm_env.learning.observation.around import Around, open_around, write_way
from clean_swarm_env.learning.observation.term import TERMS, Observed, Term
from clean_swarm_env.learning.phases import PHASES
from clean_swarm_env.world.garbage import NOTHING
from selforg.arrays import Floats, Ints
from selforg.compiler.decorators import lean_kernel
from selforg.compiler.records import Words


@TERMS.register
class GarbageTerm(Term):
    """The nearest item: whether one lies within sight, and the way to it by the range of sight."""

    name = "garbage"
    components = ("garbage_seen", "garbage_distance", "garbage_ahead", "garbage_left")

    def write(self, rows: Ints, out: Floats) -> None:
        """Write the components."""
        write_garbage(self.observed.around.words, rows, out[0], out[1:])


@lean_kernel
def write_garbage(around: Words[Around], rows: Ints, seen: Floats, way: Floats) -> None:
    """Write whether an item is `seen` (R,) and the `way` (3, R) to it; see `write_way`."""
    a = open_around(around)
    robots = a.present.shape[0] // a.team.shape[0]
    for row in rows:
        way[0, row] = 1.0
        if a.item[row] >= 0:
            seen[row] = 1.0
            write_way(a, row, a.items[row // robots, a.item[row]], a.sight, way)


@TERMS.register
class CargoTerm(Term):
    """Whether the robot carries something, and whether that has been recycled."""

    name = "cargo"
    components = ("carrying", "recycled")

    def write(self, rows: Ints, out: Floats) -> None:
        """Write the components."""
        write_cargo(self.observed.around.words, rows, out)


@lean_kernel
def write_cargo(around: Words[Around], rows: Ints, out: Floats) -> None:
    """Write the components of `CargoTerm` into `out` (2, R)."""
    a = open_around(around)
    for row in rows:
        out[0, row] = 1.0 if a.cargo[row] != NOTHING else 0.0
        out[1, row] = 1.0 if a.recycled[row] == 1 else 0.0


@TERMS.register
class PhaseTerm(Term):
    """One flag: nothing in sight, an item in sight, on the way to recycling, on the way to the dump."""

    name = "phase"
    components = tuple(f"phase_{phase}" for phase in PHASES)

    def write(self, rows: Ints, out: Floats) -> None:
        """Write the components."""
        raise_flags(self.observed.around.record.phases, rows, out)


@lean_kernel
def raise_flags(numbers: Ints, rows: Ints, out: Floats) -> None:
    """Write 1 for each of `rows` (P,) into the line of `out` (K, R) that `numbers` (R,) name."""
    for row in rows:
        out[numbers[row], row] = 1.0


@TERMS.register
class SituationTerm(Term):
    """One flag: without or with cargo, far from both stations or within `station_range` of one."""

    name = "situation"
    needs = ("stations",)
    components = ("free_far", "free_near", "carrying_far", "carrying_near")

    def __init__(self, observed: Observed, *, station_range: float) -> None:
        super().__init__(observed)
        self._range = station_range

    def write(self, rows: Ints, out: Floats) -> None:
        """Write the components."""
        write_situation(self.observed.around.words, rows, self._range, out)


@lean_kernel
def write_situation(around: Words[Around], rows: Ints, station_range: float, out: Floats) -> None:
    """Write the components of `SituationTerm` into `out` (4, R)."""
    a = open_around(around)
    for row in rows:
        near = min(a.station_distances[0, row], a.station_distances[1, row]) <= station_range
        out[2 * (a.cargo[row] != NOTHING) + near, row] = 1.0


@TERMS.register
class RecyclingTerm(Term):
    """The way to the recycling station, by half the torus' diagonal."""

    name = "recycling"
    needs = ("stations",)
    components = ("recycling_distance", "recycling_ahead", "recycling_left")

    def write(self, rows: Ints, out: Floats) -> None:
        """Write the components."""
        out[:] = self.observed.around.record.station_ways[0]


@TERMS.register
class DumpTerm(Term):
    """The way to the dump, by half the torus' diagonal."""

    name = "dump"
    needs = ("stations",)
    components = ("dump_distance", "dump_ahead", "dump_left")

    def write(self, rows: Ints, out: Floats) -> None:
        """Write the components."""
        out[:] = self.observed.around.record.station_ways[1]


@TERMS.register
class NearnessTerm(Term):
    """How near the stations are: 1 at a station, 0 from `station_range` on."""

    name = "nearness"
    needs = ("stations",)
    components = ("recycling_near", "dump_near")

    def __init__(self, observed: Observed, *, station_range: float) -> None:
        super().__init__(observed)
        self._range = station_range

    def write(self, rows: Ints, out: Floats) -> None:
        """Write the components."""
        write_nearness(self.observed.around.record.station_distances, rows, self._range, out)


@lean_kernel
def write_nearness(distances: Floats, rows: Ints, station_range: float, out: Floats) -> None:
    """Write the components of `NearnessTerm` into `out` (2, R); distances (2, R) [m]."""
    for row in rows:
        for station in range(2):
            out[station, row] = max(1.0 - distances[station, row] / station_range, 0.0)


@TERMS.register
class TargetTerm(Term):
    """The way to the station that the cargo has to go to, by half the torus' diagonal."""

    name = "target"
    needs = ("stations",)
    components = ("target_distance", "target_ahead", "target_left")

    def write(self, rows: Ints, out: Floats) -> None:
        """Write the components."""
        write_target(self.observed.around.words, rows, out)


@lean_kernel
def write_target(around: Words[Around], rows: Ints, out: Floats) -> None:
    """Write the components of `TargetTerm` into `out` (3, R)."""
    a = open_around(around)
    for row in rows:
        out[0, row] = 1.0
        if a.cargo[row] != NOTHING:
            for k in range(3):
                out[k, row] = a.station_ways[1 if a.recycled[row] == 1 else 0, k, row]
