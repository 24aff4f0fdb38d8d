"""Rays from the middles of robots: how far it is along each to the first wall, robot or thing (compiled).

W worlds of N robots, R = W * N rows, K rays, M things of a kind in each world.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, NamedTuple

import numpy as np

from clean_swarm_env.physics.cells import NOBODY, cell_at, cell_beside, cells_along, fill_cells
from clean_swarm_env.physics.physics import Physics
from selforg.arrays import READ, SCRATCH, Flags, Floats, Ints
from selforg.compiler.decorators import inlined, kernel, lean_kernel
from selforg.compiler.records import Handle, Packed, opening
from selforg.components.sources import Surroundings
from selforg.elementary import sine_cosine, unit_vectors
from selforg.space import nearest_image
from selforg.walls.segments import Walls, open_walls, wall_along


@dataclass(frozen=True)
class Bodies:
    """Things of one kind that rays meet.

    Attributes:
        places: (W, M, 2) [m], the same array all the time.
        radius: of the discs, 0 where they have no size [m], one or (M,).
        stage: (W, M) int64 of each; None: all are there.
        lies: the stage in which a thing is there.

    """

    places: Annotated[Floats, "W M 2", READ]
    radius: Annotated[float | Floats, "M", READ] = 0.0
    stage: Annotated[Ints | None, "W M", READ] = None
    lies: int = 0


class Fan(NamedTuple):
    """The rays of all robots, and where these are."""

    positions: Annotated[Floats, "R 2", READ]  # [m]
    headings: Annotated[Floats, "R", READ]  # [rad]
    extent: Annotated[Floats, "2", READ]  # of the torus of the physics [m]
    ways: Annotated[Floats, "K 2", READ]  # unit vectors along the rays, ahead and to the left of each robot
    lengths: Annotated[Floats, "R K", SCRATCH]  # to what they meet [m]
    robots: int  # N


class Discs(NamedTuple):
    """Discs that rays meet, M in each world one after the other: the robots, or things of one kind."""

    places: Annotated[Floats, "WM 2", READ]  # [m]
    there: Annotated[Flags, "WM", READ]
    radii: Annotated[Floats, "WM", READ]  # [m]
    members: int  # M
    farthest: float  # distance up to which they are met [m]
    robots: int  # 1 if disc m is the robot in row m, whose own rays do not meet it


open_fan, open_discs = opening(Fan), opening(Discs)


class BodiesAround(Surroundings):
    """The bodies of a batch of worlds, and the things that its task shows.

    Attributes:
        physics: bodies and walls, which the worlds give.
        bodies: returns the things, which the task gives.

    """

    physics: Physics
    bodies: Callable[[], Sequence[Bodies]]

    def rays(self, angles: Floats, reach: float, things: float) -> Callable[[Ints], Floats]:
        """Return what casts rays; see `Surroundings`."""
        return Rays(self, angles, reach, things).cast


class Rays:
    """Rays of one length [m] at the same `angles` (K,) [rad] to the headings of all robots.

    Their records are made when they are cast first, because robots are built before the task that knows things.
    """

    angles: Annotated[Floats, "K", READ]

    def __init__(self, around: BodiesAround, angles: Floats, reach: float, things: float) -> None:
        self._around, self.angles, self._reach, self._things = around, angles, reach, things

    @cached_property
    def _fan(self) -> Packed[Fan]:
        physics, settings = self._around.physics, self._around.physics.settings
        return Packed(
            Fan(
                positions=physics.positions,
                headings=physics.headings,
                extent=np.array([settings.width, settings.height]),
                ways=np.column_stack(unit_vectors(self.angles)),
                lengths=np.zeros((len(physics.headings), len(self.angles))),
                robots=settings.robots,
            )
        )

    @cached_property
    def _kinds(self) -> list[tuple[Bodies | None, Packed[Discs]]]:
        """The robots, and the things of each kind."""
        physics, settings = self._around.physics, self._around.physics.settings
        radii = np.full(len(physics.headings), settings.radius, dtype=np.float64)
        far = self._reach + float(radii.max())
        robots = Packed(Discs(physics.positions, physics.present, radii, settings.robots, far, 1))
        kinds: list[tuple[Bodies | None, Packed[Discs]]] = [(None, robots)]
        for bodies in self._around.bodies() if self._things > 0.0 else ():
            worlds, count, _ = bodies.places.shape
            sizes = np.tile(np.maximum(np.broadcast_to(bodies.radius, count), self._things), worlds)
            places, there = np.zeros((worlds * count, 2)), np.ones(worlds * count, np.bool_)
            far = self._reach + float(sizes.max(initial=0.0))
            kinds.append((bodies, Packed(Discs(places, there, sizes, count, far, 0))))
        return kinds

    def cast(self, rows: Ints) -> Floats:
        """Return the lengths (P, K) [m] of the rays of `rows` (P,), all of them different."""
        fan, walls = self._fan, self._around.physics.walls
        fan.record.lengths[rows] = self._reach
        for bodies, discs in self._kinds:
            if bodies is not None:
                discs.record.places[:] = bodies.places.reshape(-1, 2)
                if bodies.stage is not None:
                    np.equal(bodies.stage.reshape(-1), bodies.lies, out=discs.record.there)
            meet_discs(rows, fan.handle, discs.handle)
        if len(walls.record.segments):
            meet_walls(rows, fan.handle, walls.handle)
        return fan.record.lengths[rows]


@kernel
def meet_discs(rows: Ints, fan: Handle[Fan], discs: Handle[Discs]) -> None:
    """Shorten the rays of `rows` (P,) to the discs that they meet, in all their images on the torus."""
    f, d = open_fan(fan), open_discs(discs)
    lines, columns = cells_along(d.members, d.farthest, f.extent)
    cells, links, filled = np.empty((lines, columns), np.int64), np.empty(d.members, np.int64), -1
    over, up = int(d.farthest / f.extent[0] + 0.5), int(d.farthest / f.extent[1] + 0.5)
    for row in rows:
        world, x, y = row // f.robots, f.positions[row, 0], f.positions[row, 1]
        first = world * d.members
        if world != filled:
            fill_cells(d.places, first, d.there[first : first + d.members], f.extent, cells, links)
            filled = world
        sine, cosine = sine_cosine(f.headings[row])
        line, column, walks = 0, 0, 1
        if lines > 0:
            line, column, walks = cell_at(y, lines, f.extent[1]), cell_at(x, columns, f.extent[0]), 9
        for walk in range(walks):
            point = cell_beside(line, column, walk, cells) if lines > 0 else (0 if d.members > 0 else NOBODY)
            while point != NOBODY:
                disc = first + point
                point = links[point] if lines > 0 else (point + 1 if point + 1 < d.members else NOBODY)
                if not d.there[disc]:
                    continue
                dx = nearest_image(d.places[disc, 0] - x, f.extent[0])
                dy = nearest_image(d.places[disc, 1] - y, f.extent[1])
                for right in range(-over, over + 1):
                    for above in range(-up, up + 1):
                        ox, oy = dx + right * f.extent[0], dy + above * f.extent[1]
                        itself = d.robots == 1 and disc == row and right == 0 and above == 0
                        if not itself and ox * ox + oy * oy <= d.farthest * d.farthest:
                            shorten_rays(row, cosine * ox + sine * oy, cosine * oy - sine * ox, d.radii[disc], f)


@inlined
def shorten_rays(row: int, ahead: float, left: float, radius: float, f: Fan) -> None:
    """Shorten the rays of a row that meet a disc whose middle is `ahead` and to the `left` of the robot [m]."""
    outside = ahead * ahead + left * left - radius * radius
    for k in range(f.ways.shape[0]):
        along = ahead * f.ways[k, 0] + left * f.ways[k, 1]
        within = along * along - outside
        if outside <= 0.0:
            f.lengths[row, k] = 0.0
        elif along > 0.0 and within >= 0.0:
            f.lengths[row, k] = min(f.lengths[row, k], along - np.sqrt(within))


@lean_kernel
def meet_walls(rows: Ints, fan: Handle[Fan], walls: Handle[Walls]) -> None:
    """Shorten the rays of `rows` (P,) to the walls that they meet."""
    f, w = open_fan(fan), open_walls(walls)
    for row in rows:
        sine, cosine = sine_cosine(f.headings[row])
        for k in range(f.ways.shape[0]):
            ux, uy = cosine * f.ways[k, 0] - sine * f.ways[k, 1], sine * f.ways[k, 0] + cosine * f.ways[k, 1]
            x, y = f.positions[row, 0], f.positions[row, 1]
            f.lengths[row, k] = wall_along(x, y, ux, uy, f.lengths[row, k], f.extent, w)
