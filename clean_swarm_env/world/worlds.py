"""W worlds of N robots each with one task, stepped together; `tick` lists the stages of one control period.

Rows are robots, R = W * N. A world depends on its own start and seed only: its course is the same alone and in a
batch.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any

import numpy as np

from clean_swarm_env.config.frames import check_frame
from clean_swarm_env.config.mission import MissionConfig, StartConfiguration
from clean_swarm_env.config.tasks import NO_ITEMS, items_of
from clean_swarm_env.config.types import ConfigurationError
from clean_swarm_env.physics.clock import Clock
from clean_swarm_env.physics.rays import Bodies
from clean_swarm_env.world.agenda import Agendas
from clean_swarm_env.world.floor import Floor
from clean_swarm_env.world.minds import Minds
from clean_swarm_env.world.mission_end import tick_limit
from clean_swarm_env.world.parts.things import WorldStart
from clean_swarm_env.world.states import KeptStates, WorldState
from clean_swarm_env.world.task import Task, task_class
from clean_swarm_env.world.team_changes import Team
from clean_swarm_env.world.view import TaskView
from selector.coordination.coordinator import Coordinator, hold_options
from selector.coordination.model import CoordinatorModel
from selector.documents.errors import DocumentError
from selector.knowledge import unknown_option
from selforg.arrays import OUTSIDE, Flags, Floats, Ints
from selforg.registry import unknown
from selforg.sealing import sealed, unsealed


class Worlds:
    """The batch of worlds of one mission.

    Call `reset` for every world, then `tick` as often as you like. Between ticks `hold` sets the options that serve the
    coordinated goals in each robot. With `explained` the robots' networks also note why each behaviour runs or does
    not; the course is the same.

    Attributes:
        mission: mission of the batch; `missions` (W,) are those of the worlds until their next resets.
        worlds, robots, rows: W, N and R.
        period: length of a control period [s].
        floor: the bodies; its `extent`, `physics` and `collisions` are attributes of the worlds too.
        minds: what the robots know and decide; its `network` and `coordinators` are attributes of the worlds too.
        team: which robots are present and at work.
        task: the work in the worlds.
        agendas: the events to come.

    """

    _driven: Annotated[Floats | None, "R 2", OUTSIDE]  # [m/s]
    _correction: Annotated[Floats | None, "R 2", OUTSIDE]  # [m/s]

    def __init__(
        self,
        mission: MissionConfig,
        coordinators: CoordinatorModel | Sequence[CoordinatorModel],
        worlds: int = 1,
        *,
        directories: Sequence[Path] = (),
        explained: bool = False,
    ) -> None:
        models = (coordinators,) if isinstance(coordinators, CoordinatorModel) else tuple(coordinators)
        self.mission = mission
        self.missions = [mission] * worlds
        self.worlds, self.robots, self.rows = worlds, mission.rows, worlds * mission.rows
        self.period = 1.0 / mission.world.control_rate
        self._clock = Clock(worlds, self.period)
        self.floor = Floor(mission, worlds)
        kind = task_class(mission)
        self.minds = Minds(mission, models, worlds, kind, directories, explained)
        self.team = Team(mission, self.floor, self.minds)
        self.world = TaskView(self.missions, self.floor, self.minds, self.team, self._clock)
        self.task: Task[Any, Any] = kind(self.world)
        self.minds.known, self.team.task = self.task.known, self.task
        self.agendas = Agendas(self.world, self.task)
        around = self.minds.surroundings
        around.physics, around.bodies = self.floor.physics, self._bodies
        self.world.go_round_to(self.task.around)
        self._driven = self._correction = None
        self.extent, self.physics, self.collisions = self.floor.extent, self.floor.physics, self.floor.collisions
        self.network, self.coordinators = self.minds.network, self.minds.coordinators
        bind_options(mission, self.coordinators, worlds)
        self._states = self.states_below(self, {})

    @property
    def ticks(self) -> Ints:
        """Control periods (W,) since the reset of each world."""
        return self._clock.ticks

    @property
    def now(self) -> float:
        """Time of the buffers [s]; it goes on through resets."""
        return self._clock.now

    @property
    def done(self) -> Flags:
        """(W,) whether the task of a world is done, and nothing more will come."""
        return self.task.done()

    def rows_of(self, world: int) -> Ints:
        """Return the rows (N,) of the robots of a world."""
        return self.floor.rows_of(world)

    def reset(
        self, world: int, start: StartConfiguration, seed: int | Sequence[int], mission: MissionConfig | None = None
    ) -> None:
        """Put a world at its start; everything random in it follows from `seed`.

        `mission`, if given, is the mission of this world until its next reset; it must have the frame of the batch's.
        Where the start has no robots the task places them.
        """
        mission, stream = mission or self.mission, np.random.SeedSequence(seed)
        check_frame(mission, self.mission)
        items = np.array(start.items).reshape(-1, 2)
        counts, given = (mission.robots.count, items_of(mission).count), (len(start.robots), len(items))
        if given != counts and (items_of(mission) is not NO_ITEMS or start.robots):
            expected = f"{counts[0]} robots and {counts[1]} items"
            raise ValueError(f"start {start.id!r}: expected {expected}, got {given[0]} and {given[1]}")
        self.missions[world], self.world.limits[world] = mission, tick_limit(mission)
        self._clock.reset(world)
        self.world.forget_ways(world)
        self.collisions.reset(world)
        rows = self.rows_of(world)
        own = slice(int(rows[0]), int(rows[-1]) + 1)
        self.minds.reset(world, mission, rows, stream)
        self.task.state.reset(world, own)
        placed = slice(own.start, own.start + mission.robots.count)
        poses = np.array(start.robots) if start.robots else None
        placing = WorldStart(world, placed, self.floor.ground, stream, poses, items)
        self.task.place(placing)
        self.agendas.reset(world, stream)
        for x, y in placing.places if mission.world.has_walls else ():
            if not self.floor.ground.is_free(np.array([x, y])):
                expected = f"walls that leave {self.task.name} the places at which its robots begin"
                raise ConfigurationError(f"world.walls: expected {expected}, got one at [{x:.2f}, {y:.2f}]")
        self.team.reset(world, placing.poses)
        self.task.reset(world, own)

    def states_below(self, root: object, alike: Mapping[str, object]) -> KeptStates:
        """Return the states of these worlds and of all below `root`; `alike` is what they must have in common, too."""
        fits = {
            "options": tuple((one.model.goal, one.model.options) for one in self.coordinators),
            "behaviours": tuple(behaviour.name for behaviour in self.network.model.behaviours),
        }
        return KeptStates(root, self.mission, self.missions, self._clock, {**fits, **alike})

    def get_state(self, world: int = 0) -> bytes:
        """Return everything that decides how a world continues, except the vectors that a learner drives it with.

        The bytes say their version, and are sealed.
        """
        return sealed("world", self._states.get(world))

    def set_state(self, state: bytes, world: int = 0) -> None:
        """Make a world go on from the bytes of `get_state`; ValueError says what is damaged or does not fit.

        A state that is refused changes nothing.
        """
        whole: WorldState = unsealed("world", state)
        self._states.check(whole)
        self._states.put(world, whole)

    def hold(self, options: Ints, rows: Ints | None = None) -> None:
        """Give the `options` (K, C), or (K,) for one coordinator, to the robots in `rows` (K,) or all.

        Robots whose model always holds an option hold that one.
        """
        hold_options(self.coordinators, options, np.arange(self.rows) if rows is None else rows)

    def drive(self, vectors: Floats | None) -> None:
        """Make robots follow vectors (R, 2) [m/s] from the next tick on; None: their behaviours again.

        The networks of driven robots decide nothing. The robots pick, recycle and dump wherever their sensors allow
        it.
        """
        self._driven, self._correction = vectors, None

    def correct(self, vectors: Floats | None) -> None:
        """Add vectors (R, 2) [m/s], or nothing, to behaviours' commands from now on; networks decide as before."""
        self._driven, self._correction = None, vectors

    def follow_baseline(self, baseline: bool) -> None:
        """Let the baseline of the task command the robots from now on, or what they decide again."""
        self.world.by_baseline = baseline and not self.task.baseline_option

    def tick(self) -> Ints:
        """Run one control period of all worlds; all robots decide at one instant (docs/decisions/0090-one-instant.md).

        Returns the collision events (R,) in which each robot took part, valid until the next tick.
        """
        floor, minds, task, now = self.floor, self.minds, self.task, self._clock.now
        self.agendas.apply_due()
        able = task.start_tick()
        minds.spread_poses(self.physics.positions, self.physics.headings, now)
        minds.receive(now)
        if self.world.by_baseline:
            minds.commands.clear()
            task.command_baseline(minds.commands)
        elif self._driven is None or task.thinks_when_driven:
            self._think(able, now)
        if self._driven is not None:
            task.follow(self._driven, self.team.working)
            minds.follow(self._driven, self.team.working)
        task.before_moving(minds.commands)
        floor.move(minds.commands.packed, now)
        self._clock.advance()
        task.after_moving()
        if minds.facts:
            minds.tell(task.noticed(), now)
        return self.collisions.entered_in_tick

    def _bodies(self) -> list[Bodies]:
        """Return what rays meet beside robots and walls."""
        return [one.met for one in self.task.shown() if one.met is not None]

    def _think(self, able: Ints | None, now: float) -> None:
        """Let the robots that are `able` (K,), all with None, sense, decide and act."""
        minds, task = self.minds, self.task
        task.sense()
        self.world.find_ways()
        minds.robots.sense(now)
        minds.network.step(able, task.always_acts)
        task.after_deciding()
        task.command(minds.commands)
        minds.robots.act(now, minds.commands)
        task.after_acting(minds.commands)
        if self._correction is not None:
            minds.commands.add(self._correction * self.team.working[:, None])
        minds.robots.leave(now)
        task.after_leaving()


def bind_options(mission: MissionConfig, coordinators: Sequence[Coordinator], worlds: int) -> None:
    """Let robots hold the options that their models always hold.

    Raises:
        DocumentError: a model holds an option for a goal that is not there, or an unknown option.

    """
    goals = {coordinator.model.goal: coordinator for coordinator in coordinators}
    models = np.tile(mission.models, worlds)
    for number, group in enumerate(mission.robots.models):
        where = f"mission {mission.name}: robots.groups.{number}.holds" if mission.robots.groups else "robots.holds"
        for goal, option in group.holds.items():
            if goal not in goals:
                raise DocumentError(f"{where}: {unknown('coordinated goal', goal, list(goals))}")
            options = goals[goal].model.options
            if option not in options:
                raise DocumentError(f"{where}.{goal}: {unknown_option(goal, option, options)}")
            goals[goal].bind(np.flatnonzero(models == number), options.index(option))
