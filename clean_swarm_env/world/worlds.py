"""W worlds of N robots each with one task, stepped together; `tick` lists the stages of one control period.

Rows are robots, R = W * N. A world depends on its own start and seed only: its course is the same alone and in a
batch.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Final

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
from selector.documents.plain import must_know
from selector.knowledge import must_know_option
from selforg.arrays import OUTSIDE, READ, Flags, Floats, Ints
from selforg.program import (
    AFTER_ACTING,
    AFTER_LEAVING,
    DECIDE,
    FOLLOW,
    LEAD,
    SENSE,
    Program,
    Rows,
    Step,
    bits_of,
)
from selforg.sealing import sealed, unsealed

THOUGHT: Final = bits_of(range(SENSE, AFTER_LEAVING + 1))
"""The stages in which robots sense, decide and do something by themselves,"""
LED: Final = bits_of([LEAD])
"""and that in which the baseline of the task commands them."""


class Worlds:
    """The batch of worlds of one mission.

    Call `reset` for every world, then `tick` as often as you like. Between ticks `hold` sets the options that serve the
    coordinated goals in each robot. With `explained` the robots' networks also note why each behaviour runs or does
    not; the course is the same.

    Attributes:
        mission: mission of the batch; `missions` (W,) are those of the worlds until their next resets.
        worlds, robots, rows: W, N and R.
        period: length of a control period [s]; `clock` counts them.
        program: the steps of a tick.
        floor: the bodies; its `extent`, `physics` and `collisions` are attributes of the worlds too.
        minds: what the robots know and decide; its `network` and `coordinators` are attributes of the worlds too.
        team: which robots are present and at work.
        task: the work in the worlds.
        agendas: the events to come.

    """

    _driven: Annotated[Floats, "R 2", OUTSIDE]  # vectors of a learner [m/s]
    _nothing: Annotated[Floats, "R 2", READ]
    _all: Annotated[Ints, "R", READ]

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
        self.clock = Clock(worlds, self.period)
        self.floor = Floor(mission, worlds)
        kind = task_class(mission)
        self.minds = Minds(mission, models, worlds, kind, directories, explained)
        self.team = Team(mission, self.floor, self.minds)
        self.world = TaskView(self.missions, self.floor, self.minds, self.team, self.clock)
        self.task: Task[Any, Any] = kind(self.world)
        self.minds.known, self.team.task = self.task.known, self.task
        self.agendas = Agendas(self.world, self.task, self.clock)
        around = self.minds.surroundings
        around.physics, around.bodies = self.floor.physics, self._bodies
        self.world.go_round_to(self.task.around)
        self._all = np.arange(self.rows)
        self._driving, self._correcting = (Rows.of(np.arange(self.rows)) for _ in range(2))
        self._nothing = np.zeros((self.rows, 2))
        self._follow_learner(None, driving=False)
        self.program = Program(self.steps)
        self.extent, self.physics, self.collisions = self.floor.extent, self.floor.physics, self.floor.collisions
        self.network, self.coordinators = self.minds.network, self.minds.coordinators
        bind_options(mission, self.coordinators, worlds)
        self._states = self.states_below(self, {})

    @property
    def ticks(self) -> Ints:
        """Control periods (W,) since the reset of each world."""
        return self.clock.ticks

    @property
    def now(self) -> float:
        """Time of the buffers [s]; it goes on through resets."""
        return self.clock.now

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
        self.clock.reset(world)
        self.world.forget_ways(world)
        self.collisions.reset(world)
        rows = self.rows_of(world)
        own = slice(int(rows[0]), int(rows[-1]) + 1)
        self.floor.reset(rows, stream)
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
        return KeptStates(root, self.mission, self.missions, self.clock, {**fits, **alike})

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
        self._follow_learner(vectors, driving=True)

    def correct(self, vectors: Floats | None) -> None:
        """Add vectors (R, 2) [m/s], or nothing, to behaviours' commands from now on; networks decide as before."""
        self._follow_learner(vectors, driving=False)

    def _follow_learner(self, vectors: Floats | None, driving: bool) -> None:
        """Let robots follow vectors (R, 2) [m/s] when `driving`, else add these to their commands; None: neither."""
        self._driven = self._nothing if vectors is None else vectors
        self._driving.length[0] = driving and vectors is not None
        self._correcting.length[0] = not driving and vectors is not None

    def follow_baseline(self, baseline: bool) -> None:
        """Let the baseline of the task command the robots from now on, or what they decide again."""
        self.world.by_baseline = baseline and not self.task.baseline_option

    def tick(self) -> Ints:
        """Run one control period of all worlds; all robots decide at one instant (docs/decisions/0090-one-instant.md).

        Returns the collision events (R,) in which each robot took part, valid until the next tick.
        """
        self.run(self.program, 1)
        return self.collisions.entered_in_tick

    def run(self, program: Program, ticks: int) -> None:
        """Run control periods of all worlds by a program: that of the worlds, or one with further steps."""
        without = THOUGHT if self.world.by_baseline else LED
        if self._driving.length[0] and not self.task.thinks_when_driven:
            without |= THOUGHT
        program.repeat(self.clock.packed.record.ticks, self.clock.length, ticks, without)

    def steps_of(self, first: int, last: int) -> list[Step]:
        """Return the steps of a tick from one stage to another, for those who run parts of it by themselves."""
        return [step for step in self.steps() if first <= step.stage <= last]

    def _bodies(self) -> list[Bodies]:
        """Return what rays meet beside robots and walls."""
        return [one.met for one in self.task.shown() if one.met is not None]

    def steps(self) -> list[Step]:
        """Return the steps of a tick; see ARCHITECTURE.md."""
        minds, task, commands, working = self.minds, self.task, self.minds.commands, self.team.working[:, None]
        return [
            self.agendas.coming(),
            self.team.starting(),
            *minds.beginning(self.physics),
            Step(LEAD, lambda now, _: commands.clear(), Rows.of(self._all)),
            self.clock.advancing(),
            *task.steps(commands),
            *self.world.finding_ways(),
            *minds.robots.steps(commands),
            minds.network.deciding(DECIDE, self.team.able, task.always_acts),
            Step(AFTER_ACTING, lambda now, _: commands.add(self._driven * working), self._correcting),
            Step(FOLLOW, lambda now, _: task.follow(self._driven, self.team.working), self._driving),
            Step(FOLLOW, lambda now, _: minds.follow(self._driven, self.team.working), self._driving),
            *self.floor.moving(commands.packed),
        ]


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
            must_know("coordinated goal", goal, goals, where)
            options = goals[goal].model.options
            must_know_option(goal, option, options, f"{where}.{goal}")
            goals[goal].bind(np.flatnonzero(models == number), options.index(option))
