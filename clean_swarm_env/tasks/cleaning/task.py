"""Cleaning: robots find garbage, carry it to a recycling station, then the leftovers to a dump.

Items and stations are in `site`; behaviours carry out what compiled stages of the tick do with them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property
from typing import ClassVar

import numpy as np

from clean_swarm_env.config.events import Event
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.tasks import TASKS, items_keep_coming
from clean_swarm_env.physics.rays import Bodies
from clean_swarm_env.tasks.cleaning import missions
from clean_swarm_env.tasks.cleaning.cargo import (
    handle_cargo_as_decided,
    handle_cargo_in_reach,
    read_sensors,
    reset_commands,
)
from clean_swarm_env.tasks.cleaning.coming import Comings
from clean_swarm_env.tasks.cleaning.consequences import (
    NOTICED,
    Consequences,
    has_noticed,
    hold_back,
    let_stand,
    suffer,
)
from clean_swarm_env.tasks.cleaning.cost import collisions_cost, cost_terms, mission_cost, unavoidable_cost
from clean_swarm_env.tasks.cleaning.garbage import DONE, LYING
from clean_swarm_env.tasks.cleaning.learning.around import PHASES
from clean_swarm_env.tasks.cleaning.learning.counts import ACHIEVEMENTS, CleaningCounts
from clean_swarm_env.tasks.cleaning.movers import Movers
from clean_swarm_env.tasks.cleaning.robot import CargoMemory, coordinating_more, goals_of, network_of_robots
from clean_swarm_env.tasks.cleaning.rounds import Rounds
from clean_swarm_env.tasks.cleaning.settings import CleaningSettings, settings_of
from clean_swarm_env.tasks.cleaning.site import STATION_CHANNELS, Site
from clean_swarm_env.world.parts.shown import NO_END, ROBOT, WORLD, Destination, Drawn, Shown
from clean_swarm_env.world.parts.things import TaskState, WorldStart
from clean_swarm_env.world.reception import Reception
from clean_swarm_env.world.task import Task
from clean_swarm_env.world.view import TaskView
from selforg.arrays import Flags, Floats, Ints
from selforg.commands import Commanded, Commands
from selforg.compiler.records import Packed
from selforg.components.facts import FactRule
from selforg.gradients.buffer import SoBuffer
from selforg.gradients.poses import OwnPoses
from selforg.gradients.settings import BufferSettings
from selforg.program import (
    AFTER_DECIDING,
    AFTER_LEAVING,
    AFTER_MOVING,
    COMMANDING,
    LEAD,
    MOVE,
    SENSE,
    STARTING,
    TELLING,
    Rows,
    Step,
)


@TASKS.register
class Cleaning(Task[CleaningSettings, TaskState]):
    """All garbage has to be recycled and dumped; see `docs/environment.md` for what a mission costs.

    Attributes:
        site: items and stations; its `garbage` and `stations` are attributes here, too.
        consequences: what collisions have done to the robots.
        comings: the garbage that comes.
        movers: mechanisms that move robots by themselves.
        rounds: leads robots round walls, if there are any.
        cargo_memory: what configurations know of the robots' cargo, and ask for.

    """

    story = "robots find garbage, carry it to the station and leftovers to the dump, and keep clear of each other"
    baseline = ""
    changes = priced = True
    notices: ClassVar[Mapping[str, FactRule]] = {
        NOTICED[0]: FactRule(means="that collisions stop"),
        NOTICED[1]: FactRule(means="that collisions are free"),
        NOTICED[2]: FactRule(
            view_distance=2.0, evaporation_factor=0.9, evaporation_period=5.0, means="that it found nothing near"
        ),
    }
    best_score = 1.0  # the share of the time limit that is left
    terms = (
        "garbage", "cargo", "phase", "situation", "recycling", "dump", "nearness", "target", "neighbour", "encounter",
        "crowd", "avoidance", "movement", "time", "idle", "holds",
    )  # fmt: skip
    achievements, phases, Counts = ACHIEVEMENTS, PHASES, CleaningCounts
    Starts = missions.CleaningStarts
    doing = {"PickGarbage": "picks an item", "Recycle": "recycles its item", "Dump": "dumps its leftovers"}
    searching = {"Patrol": "patrol", "ExplorationPatrol": "patrol"}
    sees = "garbage_seen"
    missed = ("unfinished", "left unfinished")
    excess = "the cost less the time until items arrive, which no strategy can avoid"
    yardsticks = ("fixed:Off", "Random")  # never to avoid, and any option in each decision period
    thinks_when_driven = always_acts = False
    mission = {"name": "cleaning", "knowledge": "cleaning"}
    check, frame_settings = staticmethod(missions.check), staticmethod(missions.frame_settings)
    draw_scenario, opened = staticmethod(missions.draw_scenario), staticmethod(coordinating_more)
    goals, robot = staticmethod(goals_of), staticmethod(network_of_robots)

    def __init__(self, world: TaskView) -> None:
        super().__init__(world)
        self.consequences = Consequences(world.mission, world.worlds, world.rows)
        self.site = Site(world, self.consequences)
        self.garbage, self.stations = self.site.garbage, self.site.stations
        self.comings, self.movers = Comings(world, self.site), Movers(world, self.site)
        self.rounds = Rounds(world, self.site, self.movers) if world.mission.world.has_walls else None
        self.cargo_memory = CargoMemory(world.memory)
        self.standing = self.consequences.standing

    @classmethod
    def buffers(cls, mission: MissionConfig, poses: OwnPoses, reception: Reception) -> dict[str, SoBuffer]:
        """Return the buffers of garbage, of traces of the patrol, of stations, and of everything else."""
        space, task = poses.space, settings_of(mission)
        newest = BufferSettings(task.garbage.view_distance, {"DEFAULT": "new"}, aggregation_distance=0.0)
        items = SoBuffer(newest, space, poses)
        patrol, strongest = task.patrol, {"DEFAULT": "max"}
        merged = patrol.aggregation_distance * mission.slowest
        trails = BufferSettings(patrol.view_distance, strongest, merged, patrol.min_diffusion)
        trails = replace(trails, hidden=mission.world.blocks("pheromones"))
        pheromones = SoBuffer(trails, space, poses, reception.delivery())
        return {
            "gradients": SoBuffer(BufferSettings(), space, poses),
            "items": items,
            "pheromones": pheromones,
            "stations": SoBuffer(replace(newest, view_distance=np.inf), space, poses),
        }

    def place(self, start: WorldStart) -> None:
        """Put the items where the start has them, as it has the robots."""
        self.garbage.place(start.world, start.items % self.world.ground.extent)
        self.comings.reset(start.world, start.seed)

    def reset(self, world: int, rows: slice) -> None:
        """Show items and stations of a world, whose mission may have harmless collisions."""
        self.consequences.harmless[world] = settings_of(self.world.missions[world]).consequences.harmless
        self.site.show(world)

    def come(self, world: int, tick: int) -> int:
        """Let garbage come that arrives up to a tick; return the tick of the next arrival."""
        return self.comings.come(world, tick)

    def happen(self, world: int, event: Event) -> None:
        """Let an event of garbage or stations happen."""
        self.comings.happen(world, event)

    def lose(self, rows: Ints) -> None:
        """Let the cargo of robots in `rows` (K,) lie where they are."""
        self.site.drop(rows)

    def renew(self, rows: Ints) -> None:
        """Mend the robots in `rows` (K,)."""
        self.consequences.reset(rows)

    def steps(self, commands: Commands) -> list[Step]:
        """Return the steps of a tick; only those that few missions need are in Python."""
        everyone, given, site = Rows.of(self.world.every_row), commands.packed, self.site
        records = floor, minds, _ = site.packed, self.movers.packed, self.world.floor.walls
        steps = [
            Step(SENSE, read_sensors, everyone, read_sensors, records),
            Step(AFTER_DECIDING, lambda now, _, n: site.hide_picked(n), everyone, handle_cargo_as_decided, records),
            Step(COMMANDING, reset_commands, everyone, reset_commands, (floor, minds, given)),
            *self.movers.steps(commands),
        ]
        if self.cargo_memory.tells:
            told = self.garbage.recycled, self.garbage.leg, self.world.minds.network.readings
            steps.append(Step(SENSE, lambda now, _: self.cargo_memory.tell(*told), everyone))
        if self.rounds is not None:
            command_ways = self.rounds.command_ways
            steps.append(Step(COMMANDING, lambda now, _: command_ways(commands), everyone))
        if self.cargo_memory.handed is not None:
            asked = self.cargo_memory.handed
            steps.append(Step(AFTER_LEAVING, lambda now, _: self._hand_over(asked), everyone))
        if type(self).after_moving is not Task.after_moving:
            steps.append(Step(AFTER_MOVING, lambda now, _: self.after_moving(), everyone))
        steps.append(Step(LEAD, lambda now, _: self.command_baseline(commands), everyone))
        collisions_count = self.consequences.active or self.world.minds.facts
        return [*steps, *(self._colliding(everyone, given) if collisions_count else ())]

    def _colliding(self, everyone: Rows, commands: Packed[Commanded]) -> list[Step]:
        """Return the steps of collisions: robots that they stop, and what robots notice of them."""
        consequences, floor, team, minds = self.consequences, self.world.floor, self.world.team, self.world.minds
        records = floor.collisions.packed, team.packed, floor.physics.motion, self.site.packed, consequences.packed

        def show_lost(now: float, rows: Ints, count: int) -> None:
            lost = consequences.packed.record.lost[:count]
            self.site.show_items(lost // self.world.robots, floor.physics.positions[lost])

        def tell(now: float, rows: Ints, found: int = 0) -> None:
            minds.tell(self.noticed(), now)

        steps = [Step(AFTER_MOVING, show_lost, everyone, suffer, records)]
        if minds.facts:
            as_here = type(self).noticed is Cleaning.noticed
            kernel = (has_noticed, (consequences.packed,)) if as_here else ()
            steps.append(Step(TELLING, tell, everyone, *kernel))
        if consequences.active:
            steps.append(Step(STARTING, let_stand, everyone, let_stand, (team.packed, consequences.packed)))
            steps.append(Step(MOVE, hold_back, everyone, hold_back, (commands, consequences.packed)))
        return steps

    def follow(self, vectors: Floats, working: Flags) -> None:
        """Drive robots by vectors (R, 2) [m/s]; those `working` (R,) pick, recycle and dump wherever they can."""
        floor, minds, walls = self.site.packed.handle, self.movers.packed.handle, self.world.floor.walls.handle
        read_sensors(self.world.now, self.world.every_row, floor, minds, walls)
        self.site.hide_picked(handle_cargo_in_reach(floor, minds, working, walls))

    def _hand_over(self, asked: Floats) -> None:
        """Put down the cargo for which options have `asked` (R,), unless the robot stands after a collision."""
        positions = self.world.floor.physics.positions
        for row in np.flatnonzero(asked).tolist():
            blind = max(round(asked[row] / self.world.period), 1)
            if not self.consequences.standing[row] and self.garbage.hand_over(row, positions[row], blind):
                self.site.show_items(row // self.world.robots, positions[row][None])
        asked[:] = 0.0

    def noticed(self) -> Mapping[str, Flags]:
        """Return who was stopped by a collision, whom one did nothing, and who looked for garbage in vain."""
        return self.consequences.noticed()

    def done(self) -> Flags:
        """Return where all garbage that has come is dumped, and no more will come."""
        done: Flags = self.comings.over & (self.garbage.done == self.garbage.arrived)
        return done

    def result(self) -> dict[str, Floats]:
        """Return nothing: cost and items dumped are the figures of cleaning."""
        return {}

    def completed(self, values: Mapping[str, Floats]) -> Flags:
        """Return where all garbage has come and is dumped."""
        return self.done()

    def cost(self, world: int, values: Mapping[str, Floats]) -> float:
        """Return what the mission of a world costs [s]; see `docs/environment.md`."""
        counts, done = self.world.floor.collisions, int(self.garbage.done[world])
        events, samples = int(counts.events[world, 0]), int(counts.samples[world, 0])
        return mission_cost(self.world.missions[world], self.duration(world), events, samples, done)

    def unavoidable(self, world: int) -> float:
        """Return the part of the cost that no team could avoid [s], because garbage comes when it comes."""
        return unavoidable_cost(self.world.missions[world], self.comings.came(world))

    def destinations(self) -> tuple[Destination, ...]:
        """Return the nearest station for a robot with an item, else the nearest item, if it sees any."""
        moved = any(one.model.goal == "Transport" for one in self.world.minds.coordinators)
        stations = [
            Destination(
                word, "station", {"carrying": True, "recycled": bool(kind)}, {}, numbers, len(numbers) == 1 or not moved
            )
            for kind, (word, numbers) in enumerate(zip(("recycling", "a dump"), self.site.of_kind, strict=True))
        ]
        item = Destination("an item", "item", {"carrying": False, self.sees: True}, {"item_stage": (LYING, LYING)})
        return (*stations, item)

    def totals(self) -> dict[str, Ints]:
        """Return the items dumped."""
        return {"garbage_done": self.garbage.done}

    def cost_so_far(self, world: int, values: Mapping[str, Floats]) -> float:
        """Return the time and the price of the collisions [s]."""
        counts = self.world.floor.collisions
        events, samples = int(counts.events[world, 0]), int(counts.samples[world, 0])
        return float(self.world.seconds[world]) + collisions_cost(self.world.missions[world], events, samples)

    @classmethod
    def kind_of(cls, mission: MissionConfig) -> str:
        """Return the kind of a mission within its family: by spots, places of stations, and what collisions do."""
        task = settings_of(mission)
        places, dropped = len(set(task.stations.places)), " drop" * task.consequences.drop
        harm = " harmless" if task.consequences.harmless else dropped
        return f"spots {len(task.garbage.spots)} stations {places}{harm}"

    @classmethod
    def prices(cls, mission: MissionConfig) -> dict[str, float]:
        """Return the prices by the names of `CostTerms`."""
        return cost_terms(mission)._asdict()

    @classmethod
    def cost_words(cls, mission: MissionConfig) -> str:
        """Return the prices of a mission."""
        left, coming = cost_terms(mission).left, items_keep_coming(mission)
        contact = f" + {mission.contact_cost:g} s a second in contact" if mission.contact_cost else ""
        event = f"seconds + {mission.collision_cost:g} s a collision event{contact}"
        return f"for each item done, {event}" if coming else f"{event} + {left:g} s an item left"

    def phase(self) -> Ints:
        """Return the phase in which each robot (R,) was when it was last observed; see `learning.terms`."""
        return self.site.packed.record.phases

    def shown(self) -> tuple[Shown, ...]:
        """Return cargo, items and stations, and how many items are dumped."""
        share = {"garbage_done": self.garbage.done / np.maximum(self.garbage.arrived, 1)}
        dumped = Shown("dumped", WORLD, self.garbage.done, "items dumped", share)
        return (*self._shown, dumped, Shown("came", WORLD, self.garbage.arrived, "items came"))

    @cached_property
    def _shown(self) -> tuple[Shown, ...]:
        """Cargo, items and stations."""
        garbage, stage, stations = self.garbage, self.garbage.stage, self.settings.stations
        kinds, about = (
            zip(stations.kinds, stations.earlier, strict=True),
            "recycling, dump, further recycling, further dumps",
        )
        names = [STATION_CHANNELS[kind] + (f"_{earlier + 1}" if earlier else "") for kind, earlier in kinds]
        stages = {name: (number, number) for number, name in enumerate(("lying", "carried", "done"))}
        some, once, there = {"carrying": (0, NO_END)}, {"recycled": (1, 1)}, {"item_stage": (LYING, DONE)}
        lying, met = Bodies(garbage.positions, stage=stage, lies=LYING), Bodies(self.stations)
        return (
            *self.consequences.shown(),
            Shown("cargo", ROBOT, garbage.cargo, "the item that the robot carries, -1 for none", some),
            Shown("recycled", ROBOT, garbage.recycled, "1 where the cargo has been recycled", once),
            Shown("item_stage", "item", stage, "0 lying, 1 carried, 2 dumped, 3 absent", stages),
            Shown("item_leftover", "item", garbage.leftover, "1 where what lies has been recycled already"),
            Shown("item", "item", garbage.positions, "where the item lies or was picked", where=there, met=lying),
            Shown("station", "station", self.stations, about, names=names, met=met),
        )

    def drawn(self) -> tuple[Drawn, ...]:
        """Return the signs of stations, of items that lie, and of cargo."""
        recycling, dump = self.site.of_kind
        fresh, left, some, lies = (0, 0), (1, 1), (0, NO_END), (LYING, LYING)
        reach = self.settings.stations.reach
        return (
            Drawn("station", "recycling", numbers=recycling, radius=reach),
            Drawn("station", "dump", numbers=dump, radius=reach),
            Drawn("item", "item", {"item_stage": lies, "item_leftover": fresh}),
            Drawn("item", "leftovers", {"item_stage": lies, "item_leftover": left}),
            Drawn(ROBOT, "item", {"cargo": some, "recycled": fresh}),
            Drawn(ROBOT, "leftovers", {"cargo": some, "recycled": left}),
        )
