"""Several stations of a kind, and robots that choose among them."""

import itertools

import numpy as np
import pytest

from clean_swarm_env.clean_swarm_v0 import parallel_env
from clean_swarm_env.config.load import load_mission, with_changes
from clean_swarm_env.config.mission import MissionConfig, StartConfiguration
from clean_swarm_env.config.starts import distances as torus_distances
from clean_swarm_env.config.starts import random_start
from clean_swarm_env.physics.cells import nearest_of_kind
from clean_swarm_env.tasks.cleaning.garbage import DONE
from clean_swarm_env.tasks.cleaning.settings import DUMP, RECYCLING
from selforg.compiler.decorators import kernel
from selforg.gradients.queries import Queries
from selforg.space import Torus
from tests.clean_swarm_env.courses import begun, coordinated, ticked

STATIONS = {"recycling": [3.0, 10.0], "dump": [13.0, 10.0], "further_recycling": [[9.0, 10.0]]}


def mission_of(robots, items=0, **changes):
    base = load_mission("transport").model_dump()
    base["world"]["contacts"], base["task"]["consequences"] = "pass_through", {}
    base["robots"]["count"], base["task"]["garbage"]["count"] = robots, items
    base["task"]["stations"] |= {"further_dumps": [], **STATIONS}
    return MissionConfig.model_validate(with_changes(base, changes))


def carrying(option, places, avoidance="Off", **changes):
    """Return a world whose robots, at `places` (N, 3), carry by an option: the first ones have cargo."""
    items = ((5.9, 10.0),)
    mission = mission_of(len(places), len(items), **changes)
    worlds = begun(coordinated(mission), 0, StartConfiguration(id="own", robots=places, items=items), 3)
    goals = [coordinator.model for coordinator in worlds.coordinators]
    assert [goal.goal for goal in goals] == ["ExplorationPatrol", "Transport", "AvoidCollision"]
    held = [0, goals[1].options.index(option), goals[2].options.index(avoidance)]
    worlds.hold(np.tile(held, (len(places), 1)))
    return worlds


def run(worlds, seconds):
    ticked(worlds, round(5 * seconds))


@kernel
def found_nearest(x, y, kind, places, kinds, extent):
    return nearest_of_kind(x, y, kind, places, kinds, extent)


def test_the_nearest_of_a_kind_is_that_of_the_smallest_offset():
    rng, size = np.random.default_rng(1), np.array([7.0, 11.0])
    for _ in range(50):
        places, kinds, own = rng.uniform(size=(9, 2)) * size, rng.integers(0, 2, 9), rng.uniform(size=2) * size
        away = np.linalg.norm(Torus(7.0, 11.0).offsets(own, places), axis=1)
        for kind in (0, 1):
            number, distance = found_nearest(*own, kind, places, kinds, size)
            expected = min((k for k in range(9) if kinds[k] == kind), key=lambda k: away[k], default=-1)
            assert number == expected
            assert distance == (pytest.approx(away[number]) if number >= 0 else np.inf)


def test_a_mission_with_three_stations_of_a_kind_uses_all_of_them_and_no_other_place():
    mission = load_mission("transport")
    worlds = begun(coordinated(mission), 0, random_start(mission, 1, 0), 1)
    used = {RECYCLING: set(), DUMP: set()}
    kinds, places = np.array(mission.task.stations.kinds), np.array(mission.task.stations.places)
    assert kinds.tolist() == [RECYCLING, DUMP, RECYCLING, RECYCLING, DUMP, DUMP]
    worlds.hold(np.tile([0, 0, worlds.coordinators[2].model.options.index("ORCA")], (worlds.rows, 1)))
    while not worlds.done[0] and worlds.ticks[0] < 5 * 300:
        recycled, done = worlds.task.garbage.recycled.copy(), worlds.task.garbage.stage[0] == DONE
        cargo, standing = worlds.task.garbage.cargo.copy(), worlds.physics.positions.copy()
        worlds.tick()
        dumped = np.flatnonzero((worlds.task.garbage.stage[0] == DONE) & ~done)
        rows = {RECYCLING: (recycled == 0) & (worlds.task.garbage.recycled == 1), DUMP: np.isin(cargo, dumped)}
        for kind, chosen in rows.items():
            for place in standing[chosen]:
                away = [torus_distances(place, station[None], worlds.extent).min() for station in places]
                at = [k for k in np.flatnonzero(kinds == kind) if away[k] <= mission.task.stations.reach]
                assert at
                used[kind].update(at)
    assert worlds.done[0]
    assert used[RECYCLING] == {0, 2, 3}
    assert len(used[DUMP]) > 1


def test_the_first_stations_of_a_mission_may_move_and_robots_that_choose_know_it():
    moved = {"at": 2.0, "do": "move_stations", "recycling": [1.0, 1.0], "dump": [6.0, 1.0]}
    worlds = carrying("Nearest", ((5.0, 5.0, 0.0),), events=[moved])
    run(worlds, 3.0)
    assert worlds.task.stations[0].tolist() == [[1.0, 1.0], [6.0, 1.0], [9.0, 10.0]]
    pairs = Queries(worlds.minds.buffers["stations"]).gather(worlds.now, [0]).pairs
    known = (worlds.minds.poses.positions[0] + pairs[:, :2]) % worlds.extent
    assert sorted(known.round(1).tolist()) == [[1.0, 1.0], [6.0, 1.0], [9.0, 10.0]]


@pytest.mark.parametrize(
    ("option", "others", "delivery", "left"),
    [
        ("Nearest", 4, {}, True),
        ("LeastBusy", 4, {}, False),
        ("LeastBusy", 0, {}, True),
        ("LeastBusy", 4, {"reach": 1.0}, True),  # until it knows of them
    ],
)
def test_cargo_goes_past_a_busy_station_if_its_robot_knows_of_the_others(option, others, delivery, left):
    crowd = tuple((3.0 + 0.1 * k, 10.0, 3.0) for k in range(others))
    worlds = carrying(option, ((5.9, 10.0, 3.0), *crowd), delivery=delivery)
    rows = np.arange(1, 1 + others)
    worlds.team.fail(rows)  # they stand at the left station
    worlds.minds.poses.silence(rows, False)
    way = []
    for _ in range(25):
        worlds.tick()
        way.append(worlds.physics.positions[0, 0])
    assert bool(min(way) < 4.5) is left
    assert bool(max(way) > 8.0) is not left


def test_who_queues_waits_before_a_station_and_goes_on_when_it_is_free():
    distances = {}
    for option in ("Nearest", "Queue"):
        worlds = carrying(option, ((5.9, 10.0, 3.0), (3.1, 10.0, 3.0)))
        worlds.team.fail(np.array([1]))
        worlds.minds.poses.silence(np.array([1]), False)
        run(worlds, 10.0)
        distances[option] = torus_distances(worlds.physics.positions[0], np.array([[3.0, 10.0]]), worlds.extent).min()
        assert bool(worlds.task.garbage.recycled[0]) is (option == "Nearest")
    assert 2.8 < distances["Queue"] < 2.91  # it was nearer than 4 m at the start
    worlds.minds.poses.silence(np.array([1]))
    run(worlds, 4.0)
    assert worlds.task.garbage.recycled[0]


def test_transport_steers_no_robot_that_avoids_another():
    """Where the repulsion takes its turn, its vector is commanded, and not the way to a station."""
    worlds = carrying("LeastBusy", ((5.9, 10.0, 3.0), (5.0, 10.2, 0.0)), avoidance="RepulsionFernandez-view0.5")
    network, seen = worlds.network, []
    index = network.model.behaviour_index
    for _ in range(30):
        worlds.tick()
        vector = worlds.minds.commands.vectors[0]
        if network.executing[0, index["AvoidCollision"]] and worlds.task.garbage.cargo[0] >= 0:
            avoided = worlds.coordinators[2].contents[0].mechanisms["avoidance"].move(worlds.now - 0.2)[0][0]
            seen.append(np.allclose(vector, avoided))
    assert len(seen) > 3
    assert all(seen)


def test_worlds_of_one_batch_may_have_their_stations_at_different_places():
    base = mission_of(1, 3)
    places = {**base.model_dump()["task"]["stations"], "further_recycling": ((9.0, 3.0),)}
    other = MissionConfig.model_validate(with_changes(base.model_dump(), {"task": {"stations": places}}))
    worlds = coordinated(base, 2)
    for world, mission in enumerate((base, other)):
        worlds.reset(world, random_start(mission, 2, 0), 3, mission)
    assert worlds.task.stations[:, 2].tolist() == [[9.0, 10.0], [9.0, 3.0]]
    places["further_recycling"] = ()
    fewer = MissionConfig.model_validate(with_changes(base.model_dump(), {"task": {"stations": places}}))
    with pytest.raises(ValueError, match=r"task\.stations: expected"):
        worlds.reset(0, random_start(fewer, 2, 0), 3, fewer)


def test_an_environment_has_actions_for_all_goals_and_a_state_with_all_stations():
    env = parallel_env("transport")
    observations, _ = env.reset(seed=1)
    assert env.action_space("robot_0").nvec.tolist() == [2, 6, 5]
    kinds = [name for name in env.state_names if name.startswith(("recycling", "dump"))]
    expected = ("recycling", "dump", "recycling_2", "recycling_3", "dump_2", "dump_3")
    assert kinds == [f"{station}_{axis}" for station, axis in itertools.product(expected, "xy")]
    stations = [2 * place / 20.0 - 1 for point in load_mission("transport").task.stations.places for place in point]
    np.testing.assert_allclose(env.state()[[env.state_names.index(name) for name in kinds]], stations, atol=1e-6)
    world = env.unwrapped.batch.worlds
    own = world.physics.positions[0]
    away = min(torus_distances(own, np.array([p]), world.extent).min() for p in world.task.stations[0, [0, 2, 3]])
    seen = observations["robot_0"][env.observation_names.index("recycling_distance")]
    assert seen == pytest.approx(away / (10.0 * np.sqrt(2.0)), abs=1e-6)
