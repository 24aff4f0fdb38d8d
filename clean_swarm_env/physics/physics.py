"""Robots as discs on a torus: W worlds of N robots, driven by speed and turn rate.

Pymunk decides what happens while robots touch; a world in which nobody touches needs no solver and moves by
position += velocity * timestep, in compiled code (physics_motion.py). Both are one integrator, read at one point:
Chipmunk's step moves by the velocity of the step before, finds contacts, then lets forces and contacts change the
velocity; here a substep finds contacts, changes velocities and then moves by them. So a world may change between the
two at any substep, and a command shows at once. A world is given back to free motion when its last contact is so
long gone that Chipmunk has forgotten it.

The seams are closed by copies of a disc on the same body, one world size away, for the bodies near the left and the
lower seam; copies meet originals only, so each pair meets exactly once. Bodies do not rotate: headings are ours.
"""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from clean_swarm_env.physics import chipmunk_calls as calls
from clean_swarm_env.physics import motion as motion
from clean_swarm_env.physics import tick as ticking
from clean_swarm_env.physics.collisions import CollisionCounter, Flags, Floats, Ints
from clean_swarm_env.physics.contact_space import PERSISTENCE, SKIN, ContactSpace
from clean_swarm_env.physics.drive import DifferentialDrive
from clean_swarm_env.physics.settings import Contacts, PhysicsSettings
from selforg.compiler.bundles import Bundle

PAIR_SEARCH_LIMIT: Final = 64  # robots; in larger worlds somebody touches nearly always, and all pairs cost more


class Physics:
    """W worlds of N robots; rows w*N .. (w+1)*N - 1 of every array are the robots of world w (R = W * N rows).

    Starts with all robots at the origin: `place` each world first. Same calls, same bits; a world of a batch has the
    bits it would have alone.

    settings: sizes of worlds and robots.
    positions: (R, 2) float64 [m] in [0, width) x [0, height); the same C-contiguous array all the time.
    headings: (R,) float64 [rad] in (-pi, pi]; the same array all the time.
    velocities: (R, 2) float64 [m/s] of the last substep, after contacts (a strided view).
    present: (R,) bool, read only: robots that are not there touch nobody and do not move. `place` makes all robots of a
        world present, `add` and `remove` change one.

    Impossible settings raise ValueError (see PhysicsSettings).

    >>> physics = Physics(worlds=1, robots=2)
    >>> physics.place(0, np.array([[1.0, 5.0], [9.0, 5.0]]), np.zeros(2))
    >>> for _ in range(20):
    ...     physics.substep(speed=np.ones(2), turn_rate=np.zeros(2))
    >>> physics.positions.round(6).tolist()
    [[2.0, 5.0], [10.0, 5.0]]
    """

    def __init__(
        self,
        worlds: int,
        robots: int,
        width: float = 11.0,
        height: float = 11.0,
        radius: float = 0.25,
        contacts: Contacts = "solid",
        timestep: float = 0.05,
        mass: float = 1.0,
    ) -> None:
        self.settings = PhysicsSettings(worlds, robots, width, height, radius, contacts, timestep, mass)
        rows = worlds * robots
        self.positions = np.zeros((rows, 2))
        self.headings = np.zeros(rows)
        self._bodies = np.zeros((rows, 4))  # see physics_motion.py
        self.velocities = self._bodies[:, 2:]
        self.present = np.ones(rows, np.bool_)
        self._wanted = np.zeros((rows, 2))  # [m/s]
        self._forces = np.zeros((rows, 2))  # [N]
        self._copies = np.zeros(rows, np.uint8)
        self._copied = np.zeros(rows, np.uint8)  # the copies that pymunk has
        self._handles = np.zeros((worlds, calls.HANDLES), np.int64)
        self._patience = np.zeros(worlds, np.int64)  # (W,) substeps until a world is free of contacts
        self._spaces: list[ContactSpace | None] = [None] * worlds  # built at the first contact
        self._current = np.zeros(worlds, np.bool_)  # (W,) does pymunk hold the rows of `_bodies` as they are?
        self._left = np.zeros(worlds, np.int64)  # (W,) substeps of this tick that a world still has to do
        self._blocks = [slice(world * robots, (world + 1) * robots) for world in range(worlds)]
        search = motion.ALONE
        if contacts == "solid" and robots > 1:
            search = motion.PAIRS if robots <= PAIR_SEARCH_LIMIT else motion.ALWAYS
        reach, zone = 2.0 * radius * (1.0 + SKIN), 4.0 * radius
        self._sizes: ticking.Sizes = (
            search, float(width), float(height), reach, zone, float(timestep), PERSISTENCE + 1, mass / timestep
        )  # fmt: skip
        self._size_table: Bundle = ticking.SIZE_TABLE.bundle(*self._sizes)
        self._motion: Bundle = ticking.MOTION_TABLES.bundle(
            self.positions, self.headings, self._bodies, self._wanted, self._forces, self._copies, self.present,
            self._patience, self._handles, self._copied, self._current,
        )  # fmt: skip

    def place(self, world: int, positions: NDArray[np.float64], headings: NDArray[np.float64]) -> None:
        """Put the robots of one world, at rest; nothing of what was before is left.

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
        for offset in range(settings.robots):
            row = world * settings.robots + offset
            self.positions[row, 0] = motion.wrapped(float(positions[offset, 0]), settings.width)
            self.positions[row, 1] = motion.wrapped(float(positions[offset, 1]), settings.height)
            self.headings[row] = motion.wrapped_angle(float(headings[offset]))
        rows = self._blocks[world]
        self._bodies[rows, :2] = self.positions[rows]
        self._bodies[rows, 2:] = 0.0
        self._wanted[rows] = 0.0
        self.present[rows] = True
        self._patience[world] = 0
        self._spaces[world] = None
        self._handles[world] = 0
        self._current[world] = False

    def add(self, row: int, x: float, y: float, heading: float) -> None:
        """Put a robot that is absent at a place [m] with a heading [rad], at rest; the others go on undisturbed."""
        world = row // self.settings.robots
        self.positions[row, 0] = motion.wrapped(x, self.settings.width)
        self.positions[row, 1] = motion.wrapped(y, self.settings.height)
        self.headings[row] = motion.wrapped_angle(heading)
        self._bodies[row, :2] = self.positions[row]
        self._bodies[row, 2:] = 0.0
        self._set_present(world, row, True)

    def remove(self, row: int) -> None:
        """Take a robot away: it touches nobody any more; the others go on undisturbed."""
        self._bodies[row, 2:] = 0.0
        self._wanted[row] = 0.0
        self._set_present(row // self.settings.robots, row, False)

    def _set_present(self, world: int, row: int, present: bool) -> None:
        self.present[row] = present
        self._current[world] = False
        space = self._spaces[world]
        if space is not None:
            space.let_touch(row - world * self.settings.robots, present)

    def substep(self, speed: NDArray[np.float64], turn_rate: NDArray[np.float64]) -> None:
        """Advance all worlds by one timestep.

        Each robot wants to move at `speed` (R,) [m/s] along the heading it has at the beginning of the substep, and
        does unless contacts prevent it; then its heading advances by `turn_rate` (R,) [rad/s] * timestep.
        """
        search, width, height, reach, _, timestep, settling, _ = self._sizes
        engaged = motion.fly(
            self.positions, self.headings, self._bodies, self._wanted, self.present, self._patience, speed, turn_rate,
            search, width, height, reach, timestep, settling,
        )  # fmt: skip
        if engaged:
            for world in np.flatnonzero(self._patience).tolist():
                self._substep_in_contact(world)

    def tick(
        self,
        substeps: int,
        speed: NDArray[np.float64],
        turn_rate: NDArray[np.float64],
        counter: CollisionCounter,
        entered: NDArray[np.int64],
    ) -> None:
        """Advance all worlds by `substeps` timesteps and let `counter` count after each; the same as by turns.

        entered (R,) int64 gets the events of the counter's first distance in which each robot took part.
        """
        counts = counter.bundle
        if ticking.begin_tick(
            substeps, self._motion, self._size_table, speed, turn_rate, counts, entered, self._left
        ):  # fmt: skip
            self._finish_tick(speed, turn_rate, counts, entered)

    def obey(
        self,
        substeps: int,
        commands: tuple[Floats, Flags, Flags, float],
        drive: DifferentialDrive,
        counter: CollisionCounter,
        entered: Ints,
    ) -> None:
        """Let `drive` take commands, and advance as `tick` does with what it makes of them; the same in one call.

        commands: vectors (R, 2), has_command (R,), in_place (R,) and now, see `DifferentialDrive.command`.
        """
        counts = counter.bundle
        if ticking.drive_and_begin_tick(
            *commands, drive.bundle, substeps, self._motion, self._size_table, counts, entered, self._left
        ):  # fmt: skip
            self._finish_tick(drive.speed, drive.turn_rate, counts, entered)

    def _finish_tick(self, speed: Floats, turn_rate: Floats, counts: Bundle, entered: Ints) -> None:
        """Let worlds that have been handed back go through the rest of their tick."""
        for world in np.flatnonzero(self._left).tolist():
            left = int(self._left[world])
            while left:
                self._touch(world)
                left = ticking.settle_and_go_on(
                    world, left, self._motion, self._size_table, speed, turn_rate, counts, entered
                )

    def _touch(self, world: int) -> None:
        """Let pymunk do a substep of a world whose forces and copies are set."""
        space, rows = self._spaces[world], self._blocks[world]
        if space is None:
            space = ContactSpace(self.settings, self._bodies[rows], self._forces[rows])
            for robot in np.flatnonzero(~self.present[rows]).tolist():
                space.let_touch(robot, False)
            self._spaces[world] = space
            self._handles[world] = space.handles()
        if not self._current[world]:
            space.load()
        space.set_copies(self._copies[rows])
        self._copied[rows] = self._copies[rows]
        space.step(self.settings.timestep)

    def _substep_in_contact(self, world: int) -> None:
        rows = self._blocks[world]
        _, width, height, _, zone, timestep, _, stiffness = self._sizes
        motion.push(
            self._forces, self._copies, self.positions, self._bodies, self._wanted, self.present, rows.start,
            rows.stop, height, zone, stiffness,
        )  # fmt: skip
        self._touch(world)
        crossed = motion.land(self.positions, self._bodies, rows.start, rows.stop, width, height, timestep)
        # A seam crossed moves the body by a world size; and in free motion pymunk is not asked at all.
        self._current[world] = not crossed and self._patience[world] > 1
