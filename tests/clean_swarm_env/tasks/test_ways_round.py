"""Things of any task lead robots round walls: their gradients seem to lie where the way there begins."""

import numpy as np
import pytest

from clean_swarm_env.config.load import load_mission
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.learning.batch import Batch
from selforg.gradients.queries import Filter, Queries
from selforg.gradients.store import columns as c
from tests.clean_swarm_env.courses import begun

CUP = [{"corners": [[7.0, 7.0], [13.0, 7.0], [13.0, 13.0], [7.0, 13.0]]}]  # open to the left, round the goal
GOALS = Filter(("goal", "nest", "food"), view_distance=20.0)


def behind_walls(task="ReachGoal", ground="walled", walls=CUP, **further):
    return MissionConfig.model_validate({"task": task, "world": {"ground": ground, "walls": walls}, **further})


def of_seeds(config, seeds):
    return begun(Batch(config, len(seeds)), seeds)


def places(batch, world, periods):
    """Return where the robots of a world are after each period."""
    rows, options = batch.worlds.rows_of(world), np.zeros(batch.rows, np.int64)
    return [(batch.step(options), batch.worlds.physics.positions[rows].tolist())[1] for _ in range(periods)]


@pytest.mark.parametrize("ground", ["walled", "torus", "open"])
def test_a_goal_in_sight_lies_where_it_is_and_one_behind_a_wall_where_the_way_begins(ground):
    worlds = of_seeds(behind_walls(ground=ground), [1]).worlds
    worlds.tick()
    corner, positions = worlds.world.ground.corner, worlds.physics.positions
    positions[:2] = corner + np.array([[4.0, 10.0], [15.0, 10.5]])
    worlds.minds.spread_poses(positions, worlds.physics.headings, worlds.now)
    for row, round_it in ((0, False), (1, True)):
        (pair,) = Queries(worlds.minds.buffers["gradients"]).gather(worlds.now, [row], GOALS).pairs
        straight = worlds.world.ground.offsets(positions[row], corner + 10.0)
        assert pair[c.PAIR_DISTANCE] == pytest.approx(np.linalg.norm(straight))
        assert np.hypot(*pair[[c.PAIR_DX, c.PAIR_DY]]) == pytest.approx(pair[c.PAIR_DISTANCE])
        turned = np.abs(pair[[c.PAIR_DX, c.PAIR_DY]] - straight).max()
        assert bool(turned > 2.0) is round_it


@pytest.mark.parametrize("found", [True, False])
def test_robots_reach_a_goal_behind_walls_by_the_ways_round_only(found, monkeypatch):
    if not found:
        monkeypatch.setattr("clean_swarm_env.world.view.TaskView.find_ways", lambda self: None)
    batch = of_seeds(behind_walls(task={"name": "ReachGoal", "obstacles": 1}, time_limit=120.0), [1, 2])
    places(batch, 0, 110)
    x, y = batch.worlds.physics.positions.T
    see_the_goal = (x < 7.0) | ((x < 13.0) & (y > 7.0) & (y < 13.0))  # the others press against the cup from outside
    assert see_the_goal.mean() > 0.9 if found else see_the_goal.mean() < 0.7


@pytest.mark.parametrize("task", ["ReachGoal", "Foraging"])
def test_a_world_has_the_same_bits_alone_in_a_batch_and_from_a_state(task):
    cup = behind_walls(task)
    alone, batch = of_seeds(cup, [6]), of_seeds(cup, [5, 6, 7])
    assert places(alone, 0, 6) == places(batch, 1, 6)
    other = of_seeds(cup, [8])
    places(other, 0, 1)
    other.set_state(batch.get_state([1]))
    assert places(other, 0, 6) == places(batch, 1, 6)


def test_new_missions_take_the_places_of_old_fields():
    batch, fields = Batch(behind_walls("Foraging"), 1), []
    for seed in range(5):
        batch.reset([seed])
        places(batch, 0, 1)
        fields.append(len(batch.worlds.minds.poses.packed.record.fields))
    assert 3 <= max(fields) <= 8  # two patches and the nest


def test_worlds_without_walls_or_things_know_no_ways():
    for config in (behind_walls(ground="torus", walls=()), load_mission("three-rooms")):
        batch = of_seeds(config, [1])
        places(batch, 0, 1)
        assert batch.worlds.minds.poses.packed.record.aims.shape[1] == 0
