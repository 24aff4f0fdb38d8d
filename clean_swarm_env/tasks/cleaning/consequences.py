"""Consequences of collisions for the robots that take part: they stand and lose their cargo (compiled).

A robot that stands is held by its bumper: it does not move, decides nothing and handles no cargo. At the end of that
time it may drive off from whom it met. Rows are robots, R = W * N. `ConsequencesConfig` has the settings.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.physics.collisions import Counts, open_counts
from clean_swarm_env.physics.motion import RobotMotion, open_robot_motion
from clean_swarm_env.tasks.cleaning.garbage import LYING, NOTHING
from clean_swarm_env.tasks.cleaning.records import FloorRecord, open_floor
from clean_swarm_env.tasks.cleaning.settings import settings_of
from clean_swarm_env.world.parts.shown import ROBOT, Shown
from clean_swarm_env.world.team_changes import AtWork, open_team
from selforg.arrays import KEPT, READ, SCRATCH, Flags, Floats, Ints
from selforg.commands import Commanded, open_commanded
from selforg.compiler.decorators import inlined, lean_kernel
from selforg.compiler.records import Handle, Packed, Written, opening
from selforg.space import nearest_image

NOTICED = "stopped_by_collision", "collision_was_harmless", "nothing_found_here"
"""Facts that robots notice: when they collide, and when they have looked for garbage in vain."""
IN_VAIN = 20.0
"""Time for which they have looked then [s]."""


class Consequence(NamedTuple):
    """What collisions have done to the robots, and what they do."""

    standing: Annotated[Ints, "R", KEPT]  # ticks for which the robot stands, that of the collision included
    collisions: Annotated[Ints, "R", KEPT]  # of each robot
    away: Annotated[Floats, "R 2", KEPT]  # where the robot drives off [m/s]
    harmless: Annotated[Ints, "W", READ]  # 1 where collisions have none of these consequences
    lost: Annotated[Ints, "R", SCRATCH]  # rows whose cargo was lost in this tick, the first ones
    stop: int  # ticks for which a robot that collides stands
    back_off: int  # ticks for which it then drives off, the last ones of `standing`
    back_speed: Annotated[Floats, "R", READ]  # its speed then [m/s]
    drop: int  # 1 where it loses its cargo
    active: int  # 1 where collisions have any of these consequences
    counted: Annotated[Ints, "R 4", KEPT]  # collisions that stopped the row, or not, which it did not tell yet; ticks
    # without garbage; ticks since it could tell anything
    noticed: Annotated[Flags, "3 R", SCRATCH]  # which of NOTICED the row tells now
    found: Annotated[Ints, "1", SCRATCH]  # the sum of 2^k over those that any row tells
    second: int  # ticks after which robots tell what they have noticed
    long: int  # ticks without garbage of which they tell


open_consequence = opening(Consequence)


class Consequences:
    """The effects of collisions on the robots of a batch of worlds.

    Attributes:
        active: whether collisions have any consequence in this mission.
        standing: (R,) int64, ticks for which a robot stands, that of the collision included; 0 for others.
        collisions: (R,) int64, collisions of each robot.
        harmless: (W,) int64, 1 where collisions have no consequences in the mission of a world.

    """

    harmless: Annotated[Ints, "W", KEPT]

    def __init__(self, mission: MissionConfig, worlds: int, rows: int) -> None:
        config, rate = settings_of(mission).consequences, mission.world.control_rate
        self.active = config.stop > 0.0 or config.back_off > 0.0 or config.drop
        self.harmless = np.zeros(worlds, dtype=np.int64)
        self.packed: Packed[Consequence] = Packed(
            Consequence(
                standing=np.zeros(rows, dtype=np.int64),
                collisions=np.zeros(rows, dtype=np.int64),
                away=np.zeros((rows, 2)),
                harmless=self.harmless,
                lost=np.zeros(rows, dtype=np.int64),
                stop=round(config.stop * rate),
                back_off=round(config.back_off * rate),
                back_speed=0.5 * np.tile(mission.of_each("max_speed"), worlds),
                drop=int(config.drop),
                active=int(self.active),
                counted=np.zeros((rows, 4), dtype=np.int64),
                noticed=np.zeros((3, rows), dtype=np.bool_),
                found=np.zeros(1, dtype=np.int64),
                second=max(round(rate), 1),
                long=round(IN_VAIN * rate),
            )
        )
        self.standing, self.collisions = self.packed.record.standing, self.packed.record.collisions

    def shown(self) -> tuple[Shown, ...]:
        """Return what there is to show of robots; nothing where collisions have no consequences."""
        if not self.active:
            return ()
        stands = "frames for which a collision stops the robot, this one too"
        return (
            Shown("standing", ROBOT, self.standing, stands, event="stopped by a collision"),
            Shown("collisions", ROBOT, self.collisions, "collisions of the robot"),
        )

    def noticed(self) -> dict[str, Flags]:
        """Return once a second which robots (R,) have noticed something in it, by the names in NOTICED."""
        c = self.packed.record
        return {name: c.noticed[k] for k, name in enumerate(NOTICED) if c.found[0] >> k & 1} if c.found[0] else {}

    def reset(self, rows: Ints) -> None:
        """Reset `rows` (K,)."""
        self.standing[rows] = self.collisions[rows] = self.packed.record.counted[rows] = 0


@lean_kernel
def let_stand(now: float, rows: Ints, team: Handle[AtWork], consequence: Written[Consequence]) -> int:
    """Let robots that stand do so for a tick less, and keep them from deciding; a step, see `selforg.program`."""
    t, c = open_team(team), open_consequence(consequence)
    able, t.length[0] = t.length[0], 0
    for row in range(c.standing.shape[0]):
        c.standing[row] = max(c.standing[row] - 1, 0)
    for index in range(able):
        row = t.able[index]
        if c.standing[row] == 0:
            t.able[t.length[0]] = row
            t.length[0] += 1
    return 0


@lean_kernel
def has_noticed(now: float, rows: Ints, consequence: Handle[Consequence]) -> int:
    """Return more than 0 if any robot tells what it has noticed; a step, see `selforg.program`."""
    return int(open_consequence(consequence).found[0])


@lean_kernel
def hold_back(now: float, rows: Ints, commands: Handle[Commanded], consequence: Handle[Consequence]) -> int:
    """Command robots that stand not to move, or to drive off; a step, see `selforg.program`."""
    given, c = open_commanded(commands), open_consequence(consequence)
    for row in range(c.standing.shape[0]):
        if c.standing[row] > 0:
            driving = c.standing[row] <= c.back_off
            given.vectors[row, 0] = c.away[row, 0] if driving else 0.0
            given.vectors[row, 1] = c.away[row, 1] if driving else 0.0
            given.commanded[row], given.in_place[row] = True, False
    return 0


@inlined
def turn_away(row: int, present: Flags, f: FloorRecord, c: Consequence) -> None:
    """Note where a robot will drive off: away from the nearest other one, which it has met."""
    per_world, nearest = f.robots.shape[0] // f.stations.shape[0], np.inf
    first = row // per_world * per_world
    for other in range(first, first + per_world):
        if other != row and present[other]:
            x = nearest_image(f.robots[row, 0] - f.robots[other, 0], f.extent[0])
            y = nearest_image(f.robots[row, 1] - f.robots[other, 1], f.extent[1])
            length = np.sqrt(x * x + y * y)
            if length < nearest and length > 0.0:
                nearest = length
                speed = c.back_speed[row]
                c.away[row, 0], c.away[row, 1] = speed * x / length, speed * y / length


@inlined
def notice(row: int, entered: int, works: bool, f: FloorRecord, c: Consequence) -> None:
    """Count what a row notices in a tick, once it has suffered, and mark once a second what it tells."""
    harmless = c.active == 0 or c.harmless[row // (f.robots.shape[0] // f.stations.shape[0])] == 1
    counted, looks = c.counted[row], f.cargo[row] == NOTHING and f.nearest[row] == NOTHING
    counted[0] += entered > 0 and works and not harmless and c.standing[row] > 0
    counted[1] += entered > 0 and works and harmless
    counted[2] = counted[2] + 1 if works and looks and c.standing[row] == 0 else 0
    counted[3] = (counted[3] + 1) % c.second
    for k in range(3):
        c.noticed[k, row] = works and counted[3] == 0 and counted[k] >= (c.long if k == 2 else 1)
        c.found[0] |= int(c.noticed[k, row]) << k
        counted[k] = counted[k] if works and not c.noticed[k, row] else 0


@lean_kernel
def suffer(
    now: float,
    rows: Ints,
    counts: Handle[Counts],
    team: Handle[AtWork],
    motion: Handle[RobotMotion],
    floor: Written[FloorRecord],
    consequence: Written[Consequence],
) -> int:
    """Let the collisions of a tick have their consequences; a step, see `selforg.program`.

    They matter to robots that work, who may have met all that are present. Returns how many robots lost their cargo,
    which lies on the floor now.
    """
    f, c, working = open_floor(floor), open_consequence(consequence), open_team(team).working
    entered, present = open_counts(counts).entered_in_tick, open_robot_motion(motion).present
    count, per_world, c.found[0] = 0, f.robots.shape[0] // f.stations.shape[0], 0
    for row in range(entered.shape[0]):
        world, x, y = row // per_world, f.robots[row, 0], f.robots[row, 1]
        if entered[row] > 0 and working[row] and c.harmless[world] == 0 and c.active == 1:
            c.collisions[row] += entered[row]
            c.standing[row] = max(c.standing[row], c.stop + c.back_off + 1)
            turn_away(row, present, f, c)
            if c.drop == 1 and f.cargo[row] != NOTHING:
                while f.cargo[row] != NOTHING:
                    item = f.cargo[row]
                    f.items[world, item, 0], f.items[world, item, 1] = x, y
                    f.stage[world, item], f.leftover[world, item] = LYING, f.recycled[row]
                    f.cargo[row], f.found[world, item] = f.under[world, item], 0
                f.recycled[row] = 0
                c.lost[count] = row
                count += 1
        notice(row, entered[row], working[row], f, c)
    return count
