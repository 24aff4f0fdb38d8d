"""Robots as discs on a torus: W worlds of N robots, driven by speed and turn rate.

Pymunk computes the motion while robots touch each other or a wall. A world without contacts needs no solver: compiled
code (motion.py) moves its robots by position += velocity * timestep. Both are the same integrator, cut at different
points. Chipmunk's step moves by the velocity of the step before, finds contacts, then forces and contacts change the
velocity. Here a substep finds contacts, changes velocities and then moves by them. So a world may change between the
two at any substep, and a command acts at once. A world moves freely again three substeps after its last contact: within
a tick Chipmunk remembers contacts for so long.

Robots that touch are put into a new space of pymunk in every control tick. Between ticks the arrays are all there is.

Bodies near the left and the lower seam have copies of their disc, one world size away, so that discs meet across the
seams. Copies meet originals only, so each pair meets exactly once. Pymunk's bodies do not rotate: `headings` does.
"""

from dataclasses import dataclass
from typing import Annotated, Any, Final, Literal

import numpy as np

from clean_swarm_env.physics.cells import cells_along
from clean_swarm_env.physics.collisions import CollisionCounter
from clean_swarm_env.physics.contact_space import ContactSpace, chipmunk_functions
from clean_swarm_env.physics.drive import DifferentialDrive
from clean_swarm_env.physics.motion import (
    ALWAYS_TOUCHING,
    NOBODY_TOUCHES,
    PARTS,
    PERSISTENCE,
    SEARCH_PAIRS,
    SKIN,
    RobotMotion,
    wrapped_angle,
)
from clean_swarm_env.physics.tick import land_and_go_on, start_tick
from selforg.arrays import KEPT, READ, Flags, Floats, Ints
from selforg.commands import Commanded
from selforg.compiler.records import Packed
from selforg.declared import arrays_of
from selforg.program import MOVE, Rows, Step
from selforg.space import wrapped
from selforg.walls.segments import Walls, no_walls

Contacts = Literal["solid", "pass_through"]


@dataclass(frozen=True)
class PhysicsSettings:
    """Sizes of the worlds and their robots, which a mission has checked."""

    worlds: int  # W
    robots: int  # N, in each world
    width: float = 11.0  # [m]
    height: float = 11.0  # [m]
    radius: Annotated[float | Floats, "R", READ] = 0.25  # [m] of all robots' discs, or (R,) of each
    contacts: Contacts = "solid"  # "pass_through": robots drive through each other
    timestep: float = 0.05  # [s] of a substep


FUNCTIONS: Final = chipmunk_functions()
PAIR_SEARCH_LIMIT: Final = 64  # robots; in larger worlds two robots touch nearly always, and the search costs more


class Physics:
    """W worlds of N robots; rows w*N .. (w+1)*N - 1 of every array are the robots of world w (R = W * N rows).

    All robots start at the origin: call `place` for each world first. The same calls give the same bits. A world of a
    batch has the bits that it has alone.

    settings: sizes of worlds and robots.
    positions: (R, 2) float64 [m] in [0, width) x [0, height); the same C-contiguous array all the time.
    headings: (R,) float64 [rad] in (-pi, pi]; the same array all the time.
    bodies: (R, 4) float64, x and y where the last substep began [m], and the velocity after contacts [m/s].
    walls: what stops robots; without any, they move freely until they touch each other.
    present: (R,) bool, read only: absent robots touch none and do not move. `place` makes all robots of a world
        present, `add` and `remove` change one.

    >>> from selforg.commands import Commands
    >>> physics = Physics(PhysicsSettings(worlds=1, robots=2))
    >>> physics.place(0, np.array([[1.0, 5.0], [9.0, 5.0]]), np.zeros(2))
    >>> drive, counter = DifferentialDrive(rows=2), CollisionCounter(worlds=1, robots=2, width=11.0, height=11.0)
    >>> commands = Commands(rows=2, dim=2)
    >>> commands.vectors[:, 0], commands.commanded[:] = 1.0, True
    >>> program = Program(lambda: [physics.ticking(4, commands.packed, drive, counter)])
    >>> for tick in range(5):
    ...     program.run(0.2 * tick)
    >>> physics.positions.round(6).tolist()
    [[2.0, 5.0], [10.0, 5.0]]
    """

    present: Annotated[Flags, "R", KEPT]

    def __init__(self, settings: PhysicsSettings, walls: Packed[Walls] | None = None) -> None:
        self.settings = settings
        self.walls = no_walls() if walls is None else walls
        worlds, robots = settings.worlds, settings.robots
        rows = worlds * robots
        radii = np.full(rows, settings.radius, dtype=np.float64)
        largest = float(radii.max())
        self.present = np.ones(rows, np.bool_)
        search = NOBODY_TOUCHES
        if settings.contacts == "solid" and robots > 1:
            search = SEARCH_PAIRS if robots <= PAIR_SEARCH_LIMIT else ALWAYS_TOUCHING
        extent = np.array([settings.width, settings.height], dtype=np.float64)
        lines, columns = np.maximum(cells_along(robots, 2.0 * largest * (1.0 + SKIN), extent), 1).tolist()
        self.motion: Packed[RobotMotion] = Packed(
            RobotMotion(
                present=self.present,
                extent=extent,
                search=search,
                width=float(settings.width),
                height=float(settings.height),
                radii=radii * (1.0 + SKIN),
                reach=2.0 * largest * (1.0 + SKIN),
                zone=4.0 * largest,
                timestep=float(settings.timestep),
                settling=PERSISTENCE + 1,
                stiffness=1.0 / settings.timestep,
                substeps=np.ones(1, dtype=np.int64),
                **arrays_of(
                    RobotMotion,
                    W=worlds,
                    N=robots,
                    R=rows,
                    PARTS=PARTS,
                    K=len(self.walls.record.segments),
                    lines=lines,
                    columns=columns,
                ),
            )
        )
        self.positions, self.headings, self.bodies = self.motion.record[:3]

    def place(self, world: int, positions: Floats, headings: Floats) -> None:
        """Put the robots of one world at places, at rest; nothing of their past is left.

        positions (N, 2) [m] and headings (N,) [rad] are wrapped. Raises ValueError for a world that does not exist,
        another shape or a value that is not finite.
        """
        settings = self.settings
        if not 0 <= world < settings.worlds:
            raise ValueError(f"world: expected 0 to {settings.worlds - 1}, got {world}")
        robots = settings.robots
        for name, array, shape in (("positions", positions, (robots, 2)), ("headings", headings, (robots,))):
            if np.shape(array) != shape or not np.isfinite(array).all():
                raise ValueError(f"{name} of world {world}: expected finite numbers of shape {shape}, got {array!r}")
        first = world * robots
        for offset in range(robots):
            self.add(first + offset, float(positions[offset, 0]), float(positions[offset, 1]), float(headings[offset]))
        self.motion.record.wanted[first : first + robots] = 0.0
        self.motion.record.patience[world] = 0

    def add(self, row: int, x: float, y: float, heading: float) -> None:
        """Put a robot that is absent at a place [m] with a heading [rad], at rest; the others are not affected."""
        self.positions[row, 0] = wrapped(x, self.settings.width)
        self.positions[row, 1] = wrapped(y, self.settings.height)
        self.headings[row] = wrapped_angle(heading)
        self.bodies[row, :2] = self.positions[row]
        self.bodies[row, 2:] = 0.0
        self.present[row] = True

    def remove(self, row: int) -> None:
        """Take a robot away: it touches no robot any more; the others are not affected."""
        self.bodies[row, 2:] = 0.0
        self.motion.record.wanted[row] = 0.0
        self.present[row] = False

    def ticking(
        self, substeps: int, commands: Packed[Commanded], drive: DifferentialDrive, counter: CollisionCounter
    ) -> Step:
        """Return the step of a program that gives `drive` its commands and advances all worlds by `substeps` timesteps.

        It counts after each. In a substep each robot wants to move at the speed of its drive along the heading that it
        has then, and does unless contacts prevent it. Then its heading advances. Where robots touch, each substep of a
        tick starts with the impulses of the previous one.
        """
        motion = self.motion
        motion.record.substeps[0] = substeps
        records: tuple[Packed[Any], ...] = drive.packed, motion, counter.packed, self.walls, FUNCTIONS

        def let_touch(now: float, rows: Ints, result: int) -> None:
            for world in np.flatnonzero(motion.record.left).tolist():
                left, space = int(motion.record.left[world]), ContactSpace(world, motion, self.walls)
                while left:
                    space.touch(last=left == 1)
                    left = land_and_go_on(world, left, *(packed.handle for packed in records))

        return Step(MOVE, let_touch, Rows.of(np.arange(len(self.present))), start_tick, (commands, *records))
