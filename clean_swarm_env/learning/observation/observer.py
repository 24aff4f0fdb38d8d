"""What a selector sees of each robot: the chosen terms of `observation_terms`, computed for all rows at once."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from clean_swarm_env.learning.observation.kernels import see
from clean_swarm_env.learning.observation.terms import TERMS, ObservationConfig, components
from clean_swarm_env.learning.progress import Progress, avoidance_column
from clean_swarm_env.world.worlds import Worlds
from selforg.compiler.decorators import kernel

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
Observations = NDArray[np.float32]


class Observer:
    """Observations (R, F) of a batch of worlds.

    Attributes:
        names: (F,) of the components.
        width: F.
        bounds: (F,) float32, largest amount of each component.
        phases: (R,) int64, number of the phase each robot was in when it was last observed (`PHASES`).

    """

    def __init__(self, worlds: Worlds, progress: Progress, config: ObservationConfig | None = None) -> None:
        self.config = config or ObservationConfig()
        self._worlds, self._progress = worlds, progress
        options = {coordinator.model.goal: coordinator.model.options for coordinator in worlds.coordinators}
        known = {term: components(term, self.config.neighbour_ranges, options) for term in TERMS}
        catalogue = [name for names in known.values() for name in names]
        self.names = tuple(name for term in self.config.terms for name in known[term.name])
        self.width = len(self.names)
        self._columns = np.array([catalogue.index(name) for name in self.names], dtype=np.int64)
        weights = [term.weight for term in self.config.terms for _ in known[term.name]]
        self._weights = np.array(weights, dtype=np.float32)
        self.bounds: Observations = np.abs(self._weights)
        self.phases: Ints = np.zeros(worlds.rows, dtype=np.int64)
        self._seen: Floats = np.zeros((worlds.rows, len(catalogue)))
        self._all = np.arange(worlds.worlds)
        self._scales = self._make_scales(worlds)
        self._ranges = np.square(self.config.neighbour_ranges)
        self._held_columns = np.cumsum([0, *(len(names) for names in options.values())])[:-1] + len(catalogue)
        self._held_columns -= sum(len(names) for names in options.values())
        self._held: Ints = np.zeros((worlds.rows, len(worlds.coordinators)), dtype=np.int64)
        self._length_column = worlds.network.model.sensor_index.get("rep_len", -1)
        self._avoiding = avoidance_column(worlds)

    def _make_scales(self, worlds: Worlds) -> Floats:
        mission, config = worlds.mission, self.config
        robots, garbage = mission.robots, mission.garbage
        return np.array(
            [
                garbage.diffusion + garbage.goal_radius + garbage.view_distance,  # range of sight [m]
                0.5 * float(np.hypot(*worlds.extent)),  # longest way on the torus [m]
                config.neighbour_ranges[-1],
                max(robots.pose_diffusion + robots.pose_goal_radius, 1e-9),  # reach of a pose [m]
                robots.max_speed,
                robots.max_turn_rate,
                config.station_range,
                float(config.full_crowd),
                max(config.patience / worlds.period, 1.0),  # [ticks]
                float(np.pi / np.prod(worlds.extent)),  # share of the torus within 1 m of a point
            ]
        )

    def observe(self, observations: Observations, chosen: Ints | None = None) -> None:
        """Fill `observations` (R, F) with what is so now, of all worlds or of the `chosen` (K,)."""
        worlds, garbage, physics = self._worlds, self._worlds.garbage, self._worlds.physics
        picked = self._all if chosen is None else chosen
        for k, coordinator in enumerate(worlds.coordinators):
            self._held[:, k] = coordinator.held
        see(
            picked, physics.positions, physics.headings, physics.velocities, physics.present, worlds.drive.speed,
            worlds.drive.turn_rate, worlds.extent, worlds.stations, self._scales, self._ranges, garbage.positions,
            garbage.stage, garbage.cargo, garbage.recycled, garbage.done, garbage.arrived, worlds.ticks,
            self._progress.limits, self._progress.idle, worlds.network.readings, self._length_column,
            worlds.network.executing, self._avoiding, self._held, self._held_columns, self.phases, self._seen,
        )  # fmt: skip
        weigh(picked, worlds.robots, self._seen, self._columns, self._weights, observations)


@kernel
def weigh(
    chosen: Ints, robots: int, seen: Floats, columns: Ints, weights: Observations, observations: Observations
) -> None:
    """Write `columns` (F,) of `seen` (R, A), times `weights` (F,), into the rows of the worlds `chosen` (K,)."""
    for index in range(chosen.shape[0] * robots):
        row = chosen[index // robots] * robots + index % robots
        for k in range(columns.shape[0]):
            observations[row, k] = np.float32(seen[row, columns[k]]) * weights[k]
