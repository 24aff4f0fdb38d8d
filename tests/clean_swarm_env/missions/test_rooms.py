"""The mission of three rooms: walls stop robots, its bits are repeatable, and it is recorded, drawn and played back."""

import numpy as np
import pytest

from clean_swarm_env import clean_swarm_v0
from clean_swarm_env.config.load import load_mission
from clean_swarm_env.config.mission import StartConfiguration
from clean_swarm_env.config.starts import random_start
from clean_swarm_env.config.types import AVOIDANCE, ConfigurationError
from clean_swarm_env.tasks import TASKS
from clean_swarm_env.tasks.cleaning.robot import GARBAGE_AT
from clean_swarm_env.world.worlds import Worlds
from selector.configurations.library import Library
from selector.coordination.model import CoordinatorModel
from selector.knowledge import load_knowledge
from tests.clean_swarm_env.courses import (
    avoidance,
    begun,
    mission,
    ticked,
    worlds_at_start,
)

ROOMS = load_mission("three-rooms")
FEW, OTHERS = ("Foraging", "FormationControl"), [name for name in TASKS.names() if name != "Cleaning"]


def test_no_robot_leaves_the_field_or_crosses_a_wall_but_for_the_doors():
    worlds = worlds_at_start(ROOMS, [1, 2])
    before, crossed = worlds.physics.positions.copy(), 0
    for _ in range(1500):
        worlds.tick()
        now = worlds.physics.positions
        assert (now > 0.2).all()
        assert (now < ROOMS.size - 0.2).all()
        for x in (8.0, 16.0):
            through = (before[:, 0] < x) != (now[:, 0] < x)
            assert (np.abs(now[through, 1] - 6.0) < 1.0).all()
            crossed += through.sum()
        before = now.copy()
    assert crossed > 5


@pytest.mark.parametrize("option", ["ORCA", "PredictiveSteering", "RepulsionGradient-view0.5"])
def test_a_robot_that_knows_the_way_goes_round_a_long_wall_another_one_does_not(option):
    wall, world = {"corners": [[8.0, 0.0], [8.0, 10.5]]}, {"width": 16.0, "ground": "walled"}
    config = mission("three-rooms", world={**world, "walls": [wall]}, robots={"count": 1}, garbage={"count": 1},
                     stations={"recycling": [4.0, 2.0], "dump": [12.0, 2.0]})  # fmt: skip
    start = StartConfiguration(id="s", robots=((4.0, 4.0, 0.0),), items=((5.0, 3.5),))
    model = CoordinatorModel(AVOIDANCE, load_knowledge("avoidance"), Library())
    done = []
    for rounds in (True, False):
        worlds = begun(Worlds(config, model, 1), 0, start, 5)
        worlds.hold(np.full(1, model.options.index(option)))
        worlds.task.rounds = worlds.task.rounds if rounds else None
        ticked(worlds, 300)
        done.append(int(worlds.task.garbage.done[0]))
    assert done == [1, 0]


@pytest.mark.parametrize("sight", [True, False])
def test_an_item_behind_a_wall_is_seen_unless_walls_block_sight_and_never_picked(sight):
    start = StartConfiguration(id="s", robots=((7.74, 3.0, 0.0),), items=((8.26, 3.0), (7.0, 4.5)))
    changes = {"world": {"walls_block": ["sight"] if sight else []}, "robots": {"count": 1}, "garbage": {"count": 2}}
    worlds = begun(Worlds(mission("three-rooms", **changes), avoidance(), 1), 0, start, 1)
    worlds.tick()
    assert worlds.task.site.packed.record.nearest[0] == (1 if sight else 0)
    assert worlds.network.readings[0, GARBAGE_AT] == 0.0
    assert (worlds.task.garbage.cargo == -1).all()


def test_a_robot_placed_in_a_wall_is_one_line():
    worlds, start = worlds_at_start(ROOMS, [1]), random_start(ROOMS, 1, 0)
    with pytest.raises(ConfigurationError, match=r"world.walls: expected .* got one at \[8.10, 3.00\]"):
        worlds.reset(0, start.model_copy(update={"robots": ((8.1, 3.0, 0.0), *start.robots[1:])}), 5)


@pytest.mark.parametrize("name", [pytest.param(name, marks=[] if name in FEW else pytest.mark.long) for name in OTHERS])
@pytest.mark.parametrize("ground", ["walled", "open"])
def test_any_task_runs_among_walls(name, ground):
    wall = {"corners": [[3.0, 3.0], [3.0, 9.0], [9.0, 9.0]]}
    world = {"ground": ground, "width": 30.0, "height": 30.0, "walls": [wall]}
    env = begun(clean_swarm_v0.parallel_env({"task": name, "world": world}), seed=1)
    for _ in range(3):
        env.step({agent: env.action_space(agent).sample() for agent in env.agents})
