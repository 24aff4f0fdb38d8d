"""A term about how busy stations are, as far as a robot has heard of others: what `ApproachLeastBusy` counts, too."""

from __future__ import annotations

import numpy as np

from clean_swarm_env.learning.observation.around import Around, open_around
from clean_swarm_env.learning.observation.term import TERMS, Observed, Term
from clean_swarm_env.tasks.cleaning.garbage import NOTHING
from clean_swarm_env.tasks.cleaning.learning.around import cleaning_in
from clean_swarm_env.tasks.cleaning.records import FloorRecord, open_floor
from selforg.arrays import Floats, Ints
from selforg.compiler.decorators import kernel
from selforg.compiler.records import Handle
from selforg.gradients.store import columns as c
from selforg.gradients.store.records import Poses, open_poses
from selforg.mechanisms.steering.approach_least_busy import others_before
from selforg.mechanisms.steering.base import OTHER_COLUMNS, note_others
from selforg.space import nearest_image


@TERMS.register
class LoadsTerm(Term):
    """With cargo: others heard that are nearer than the robot to the nearest station that it needs, and to the next
    one, within `near` [m] of them, by `full_crowd`; and how much longer the way to the next one is.
    """  # noqa: D205

    name = "loads"
    components = ("load_nearest", "load_next", "next_farther")

    def __init__(self, observed: Observed, *, near: float = 3.0) -> None:
        super().__init__(observed)
        self.near = near
        self._floor = cleaning_in(observed, self.name).site.packed

    def write(self, rows: Ints, out: Floats) -> None:
        """Write the numbers and the way."""
        around, poses = self.observed.around.handle, self.observed.worlds.minds.poses.packed.handle
        count_loads(around, self._floor.handle, poses, rows, self.near, out)


@kernel
def count_loads(
    around: Handle[Around], floor: Handle[FloorRecord], poses: Handle[Poses], rows: Ints, near: float, out: Floats
) -> None:
    """Write the components of `LoadsTerm` for `rows` (P,) into `out` (components, R)."""
    a, f, p = open_around(around), open_floor(floor), open_poses(poses)
    others, goals = np.empty((a.robots, OTHER_COLUMNS)), np.zeros((2, c.PAIR_COLUMNS))
    for row in rows:
        if f.cargo[row] == NOTHING or p.rows[row, c.ROW_POSES] == 0:
            continue
        goals[:, c.PAIR_DISTANCE] = np.inf
        for station in range(f.kinds.shape[0]):
            if f.kinds[station] != f.recycled[row]:
                continue
            place = f.stations[row // a.robots, station]
            dx = nearest_image(place[0] - p.own[row, 0, c.X], a.extent[0])
            dy = nearest_image(place[1] - p.own[row, 0, c.Y], a.extent[1])
            distance = np.sqrt(dx * dx + dy * dy)
            for rank in range(2):
                if distance < goals[rank, c.PAIR_DISTANCE]:
                    if rank == 0:
                        goals[1] = goals[0]
                    goals[rank, c.PAIR_DX], goals[rank, c.PAIR_DY] = dx, dy
                    goals[rank, c.PAIR_DISTANCE] = distance
                    break
        count = note_others(row, p.own[row, 0, c.POSE_STAMP], np.inf, others, poses)
        for rank in range(2):
            if goals[rank, c.PAIR_DISTANCE] < np.inf:
                out[rank, row] = min(others_before(goals[rank], near, count, others, poses) / a.full_crowd, 1.0)
        farther = goals[1, c.PAIR_DISTANCE] - goals[0, c.PAIR_DISTANCE]
        out[2, row] = min(farther / a.longest, 1.0)  # 1 without another station
