"""Ways to explore: robots tell where they found garbage, return there, and keep apart or not."""

import numpy as np
import pytest

from clean_swarm_env.config.load import load_mission
from clean_swarm_env.config.mission import StartConfiguration
from clean_swarm_env.config.starts import distances as torus_distances
from clean_swarm_env.config.tasks import with_items
from selforg.components.sources import GoalSource
from selforg.gradients.queries import Filter
from tests.clean_swarm_env.courses import begun, coordinated, snapshot, ticked

FIND = np.array([8.0, 8.0])


def exploring(option, robots, items=()):
    """Return a world whose robots explore by an option, and go through each other."""
    mission = load_mission("exploring")
    mission = mission.model_copy(
        update={
            "world": mission.world.model_copy(update={"contacts": "pass_through"}),
            "robots": mission.robots.model_copy(update={"count": len(robots)}),
            "task": with_items(mission.task, count=len(items)),
        }
    )
    worlds = begun(coordinated(mission), 0, StartConfiguration(id="own", robots=robots, items=items), 3)
    goals = [coordinator.model for coordinator in worlds.coordinators]
    held = [goals[0].options.index(option), goals[1].options.index("Off")]
    worlds.hold(np.tile(held, (len(robots), 1)))
    return worlds


def test_who_finds_garbage_tells_where_for_a_while():
    worlds = exploring("Patrol", ((8.0, 7.6, 1.5), (25.0, 25.0, 0.0)), (tuple(FIND),))
    looks = [Filter((channel,), view_distance=30.0) for channel in ("find", "recent find")]
    targets = [GoalSource(worlds.minds.buffers["pheromones"], "most_reach_attractive", look) for look in looks]
    felt, far_robot = np.zeros(2), np.array([1])
    for _ in range(130):
        ticked(worlds, 5)
        for k, target in enumerate(targets):
            target.ask(worlds.now, far_robot)
            felt[k] += target.present[1]
    assert felt.tolist() == pytest.approx([120, 24], abs=3)  # 0.9 ** 12 is below the 0.3 m at which pheromones are gone


@pytest.mark.parametrize(("option", "returns"), [("Finds", True), ("RecentFinds", True), ("Patrol", False)])
def test_explorers_return_to_a_find_while_it_lasts(option, returns):
    worlds = exploring(option, ((8.0, 7.6, 1.5), (20.0, 8.0, 3.0)), (tuple(FIND),))
    ticked(worlds, 90)
    place = worlds.physics.positions[1]
    assert (torus_distances(place, FIND[None], worlds.extent) < 4.0).any() == returns


def test_who_holds_finds_without_one_patrols_with_the_bits_of_patrol():
    parts = []
    for option in ("Patrol", "Finds"):
        worlds = exploring(option, ((8.0, 7.6, 1.5), (20.0, 8.0, 3.0)))
        ticked(worlds, 200)
        parts.append(snapshot(worlds, 0))
    assert np.array_equal(parts[0]["positions"], parts[1]["positions"])


def test_explorers_that_spread_out_are_farther_apart_than_those_that_walk():
    apart = {}
    for option in ("SpreadOut", "RandomWalk", "LevyWalk"):
        worlds = exploring(option, tuple((15.0 + 0.1 * k, 15.0, 0.7 * k) for k in range(8)))
        distances = []
        for _ in range(20):
            ticked(worlds, 15)
            places = worlds.physics.positions
            distances.append(
                [torus_distances(p, np.delete(places, k, 0), worlds.extent).min() for k, p in enumerate(places)]
            )
        apart[option] = np.mean(distances)
    assert apart["SpreadOut"] > 1.15 * max(apart["RandomWalk"], apart["LevyWalk"])
