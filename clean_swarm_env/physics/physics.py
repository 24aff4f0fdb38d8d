"""Robots as discs on a torus: W worlds of N robots, driven by speed and turn rate.

In a substep all robots take the velocities that they want, contacts change those of robots that touch, and all move by
them. So a command acts at once. Pairs meet by the shortest way, so that the seams are like any other place. Discs do
not turn: `headings` does.

All that a world hands on to its next substep lies in arrays.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from clean_swarm_env.physics.collisions import CollisionCounter
from clean_swarm_env.physics.contacts import CONTACTS, Contacts, no_contacts
from clean_swarm_env.physics.drive import DifferentialDrive, Orders
from clean_swarm_env.physics.motion import ROBOT_MOTION, RobotMotion, wrapped_angle
from clean_swarm_env.physics.settings import PhysicsSettings
from clean_swarm_env.physics.tick import run_period, substep_worlds
from selforg.arrays import Flags, Floats, Lasting
from selforg.compiler.records import Packed
from selforg.space import wrapped


class Physics:
    """W worlds of N robots; rows w*N .. (w+1)*N - 1 of every array are the robots of world w (R = W * N rows).

    All robots start at the origin: call `place` for each world first. The same calls give the same bits. A world of a
    batch has the bits that it has alone.

    settings: sizes of worlds and robots.
    positions: (R, 2) float64 [m] in [0, width) x [0, height).
    headings: (R,) float64 [rad] in (-pi, pi].
    velocities: (R, 2) float64 [m/s], after contacts.
    present: (R,) bool, read only: absent robots touch none and do not move. `place` makes all robots of a world
        present, `add` and `remove` change one.
    All four are the same C-contiguous arrays all the time.

    >>> physics = Physics(PhysicsSettings(worlds=1, robots=2))
    >>> physics.place(0, np.array([[1.0, 5.0], [9.0, 5.0]]), np.zeros(2))
    >>> for _ in range(20):
    ...     physics.substep(speed=np.ones(2), turn_rate=np.zeros(2))
    >>> physics.positions.round(6).tolist()
    [[2.0, 5.0], [10.0, 5.0]]
    """

    def __init__(self, settings: PhysicsSettings) -> None:
        self.settings = settings
        rows = settings.worlds * settings.robots
        self.positions: Floats = np.zeros((rows, 2))
        self.headings: Floats = np.zeros(rows)
        self.velocities: Floats = np.zeros((rows, 2))
        self.present: Flags = np.ones(rows, np.bool_)
        width, height = float(settings.width), float(settings.height)
        self._motion: Packed[RobotMotion] = ROBOT_MOTION.pack(
            RobotMotion(
                positions=self.positions,
                headings=self.headings,
                velocities=self.velocities,
                present=self.present,
                extent=np.array([width, height]),
                width=width,
                height=height,
                timestep=float(settings.timestep),
            )
        )
        self._contacts: Packed[Contacts] = CONTACTS.pack(no_contacts(settings))

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
        for offset in range(settings.robots):
            row = world * settings.robots + offset
            self.positions[row, 0] = wrapped(float(positions[offset, 0]), settings.width)
            self.positions[row, 1] = wrapped(float(positions[offset, 1]), settings.height)
            self.headings[row] = wrapped_angle(float(headings[offset]))
        rows = slice(world * robots, (world + 1) * robots)
        self.velocities[rows] = 0.0
        self.present[rows] = True
        self._contacts.record.touching[world] = 0

    def lasting(self) -> Lasting:
        """Return what robots hand on to the next substep."""
        return Lasting((self.positions, self.headings, self.velocities, self.present))

    def of_worlds(self) -> tuple[NDArray[Any], ...]:
        """Return what worlds hand on to the next substep: arrays (W, ...)."""
        contacts = self._contacts.record
        return contacts.touching, contacts.pairs, contacts.impulses

    def add(self, row: int, x: float, y: float, heading: float) -> None:
        """Put a robot that is absent at a place [m] with a heading [rad], at rest; the others are not affected."""
        self.positions[row, 0] = wrapped(x, self.settings.width)
        self.positions[row, 1] = wrapped(y, self.settings.height)
        self.headings[row] = wrapped_angle(heading)
        self.velocities[row] = 0.0
        self.present[row] = True

    def remove(self, row: int) -> None:
        """Take a robot away: it touches no robot any more; the others are not affected."""
        self.velocities[row] = 0.0
        self.present[row] = False
        contacts, (world, robot) = self._contacts.record, divmod(row, self.settings.robots)
        touching = (contacts.pairs[world] // self.settings.robots == robot) | (
            contacts.pairs[world] % self.settings.robots == robot
        )
        contacts.impulses[world, touching] = 0.0  # it may come back before the next substep

    def substep(self, speed: Floats, turn_rate: Floats) -> None:
        """Advance all worlds by one timestep.

        Each robot wants to move at `speed` (R,) [m/s] along the heading it has at the beginning of the substep, and
        does unless contacts prevent it; then its heading advances by `turn_rate` (R,) [rad/s] * timestep.
        """
        substep_worlds(speed, turn_rate, self._motion.words, self._contacts.words)

    def tick(
        self, now: float, substeps: int, orders: Packed[Orders], drive: DifferentialDrive, counter: CollisionCounter
    ) -> None:
        """Give `drive` its orders at `now` [s], advance all worlds by `substeps` timesteps and count after each.

        This equals `DifferentialDrive.command`, then `substep` and `CollisionCounter.count` in turn.
        """
        run_period(
            now,
            substeps,
            orders.words,
            drive.packed.words,
            self._motion.words,
            self._contacts.words,
            counter.packed.words,
        )
