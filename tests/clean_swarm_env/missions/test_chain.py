"""Cargo that robots put down on the way to a station, for others to carry on."""

import numpy as np
import pytest

from clean_swarm_env.config.load import load_mission
from clean_swarm_env.config.mission import MissionConfig, StartConfiguration
from clean_swarm_env.config.starts import random_start
from clean_swarm_env.learning.progress import MissionProgress
from clean_swarm_env.tasks.cleaning.garbage import LYING, NOTHING
from clean_swarm_env.tasks.cleaning.learning.counts import PICKINGS, RECYCLINGS
from clean_swarm_env.tasks.cleaning.robot import GARBAGE_AT, GARBAGE_FOUND, GARBAGE_SEEN
from selector.configurations.library import Library
from selector.documents.errors import DocumentError
from selforg.program import Program
from tests.clean_swarm_env.courses import begun, coordinated, long_course, ticked

SPAN, NEAR, BLIND = 4.0, 4.0, 50  # of the option Chain: [m], [m], [ticks]
RECYCLING, DUMP = np.array([[10.0, 10.0]]), np.array([[10.0, 1.0]])


def mission_of(robots, items, **settings):
    """Return a mission with one station of each kind, 9 m apart, on a torus of 20 m x 20 m."""
    base = load_mission("transport").model_dump()
    base["robots"]["count"], base["task"]["garbage"]["count"] = robots, items
    places = {"recycling": RECYCLING[0].tolist(), "dump": DUMP[0].tolist()}
    base["task"]["stations"] |= {**places, "further_recycling": [], "further_dumps": []}
    return MissionConfig.model_validate({**base, "task": base["task"] | settings})


def worlds_of(mission, count=1):
    """Return worlds in which all robots explore by Patrol, carry by Chain, and avoid by ORCA."""
    worlds = coordinated(mission, count)
    _, carry, avoid = (coordinator.model for coordinator in worlds.coordinators)
    worlds.hold(np.tile([0, carry.options.index("Chain"), avoid.options.index("ORCA")], (worlds.rows, 1)))
    return worlds


def one_robot(item):
    """Return a world with one robot that stands at the one item."""
    return begun(
        worlds_of(mission_of(1, 1, consequences={})),
        0,
        StartConfiguration(id="own", robots=((*item, 0.0),), items=(item,)),
        3,
    )


def ways(places, others):
    """Return the distances (N, M) [m] between places (N, 2) and others (M, 2) on the torus."""
    apart = np.abs(places[:, None] - others[None])
    return np.hypot(*np.minimum(apart, 20.0 - apart).T).T


class Followed:
    """One world whose every tick is compared with plain rules for who puts down what, and who sees garbage."""

    def __init__(self, worlds):
        self.worlds, self.legs, self.blind = worlds, np.zeros(worlds.rows), np.zeros(worlds.rows, int)
        index = worlds.network.model.behaviour_index
        self.carriers = [index["MoveToRecycling"], index["MoveToDump"]]
        self.put_down = 0

    def tick(self):
        worlds, task, garbage = self.worlds, self.worlds.task, self.worlds.task.garbage
        places, items = worlds.physics.positions.copy(), garbage.positions[0].copy()
        lying = items[garbage.stage[0] == LYING]
        cargo, recycled = garbage.cargo.copy(), garbage.recycled.copy()
        standing = task.consequences.standing > 1
        left = np.where(recycled, ways(places, DUMP)[:, 0], ways(places, RECYCLING)[:, 0])
        worlds.tick()

        seen = (ways(places, lying) <= task.site.packed.record.sight[:, None]).any(axis=1) & (self.blind == 0)
        readings = worlds.network.readings
        assert np.array_equal(readings[:, GARBAGE_SEEN], seen)
        assert np.array_equal(readings[:, GARBAGE_FOUND], seen | (cargo != NOTHING))
        assert not readings[self.blind > 0, GARBAGE_AT].any()
        self.blind = np.maximum(self.blind - 1, 0)

        carries = worlds.network.executing[:, self.carriers].any(axis=1) & (cargo != NOTHING) & ~standing
        expected = carries & (self.legs - left >= SPAN) & (left > NEAR)
        dropped = np.flatnonzero(expected)
        assert np.array_equal(expected, (cargo != NOTHING) & (garbage.cargo == NOTHING) & ~self.dumped(cargo))
        for row in dropped:
            assert np.array_equal(garbage.positions[0, cargo[row]], places[row])
            assert garbage.leftover[0, cargo[row]] == recycled[row]
            assert garbage.paid[0, cargo[row]] == 1
        assert worlds.minds.buffers["items"].count(0, "garbage") == (garbage.stage[0] == LYING).sum()
        self.blind[dropped] = BLIND
        self.put_down += len(dropped)

        picked = (cargo == NOTHING) & (garbage.cargo != NOTHING)
        began = picked | (garbage.recycled > recycled)
        places[picked] = items[garbage.cargo[picked]]
        self.legs[began] = np.where(garbage.recycled, ways(places, DUMP)[:, 0], ways(places, RECYCLING)[:, 0])[began]

    def dumped(self, cargo):
        """Return where the cargo (R,) before a tick was dumped in it."""
        garbage = self.worlds.task.garbage
        return (cargo != NOTHING) & (garbage.stage[0, cargo] != LYING) & (garbage.cargo < 0)


def test_robots_put_down_what_has_gained_its_span_and_see_nothing_for_a_time():
    items = ((19.0, 10.0), (1.5, 4.0), (10.0, 18.6), (15.0, 10.0))  # the last one has not gained enough when it is near
    worlds = begun(
        worlds_of(mission_of(4, 4)),
        0,
        StartConfiguration(id="own", robots=tuple((*item, 0.0) for item in items), items=items),
        3,
    )
    followed = Followed(worlds)
    for handed in ([1, 1, 1, 0], [1, 1, 1, 1]):  # on its way to the dump
        ticked(followed, 45)
        assert worlds.task.garbage.paid[0].tolist() == handed


@long_course
def test_a_crowd_hands_all_garbage_over_and_cleans_its_world():
    mission = mission_of(30, 30)
    worlds = begun(worlds_of(mission), 0, random_start(mission, 1, 0), 1)
    followed = Followed(worlds)
    while not worlds.done[0]:
        followed.tick()
        assert worlds.ticks[0] < 5 * 600
    assert followed.put_down > 30


def test_who_has_put_cargo_down_picks_it_again_after_the_time_and_is_paid_for_it_once():
    worlds = one_robot((1.0, 10.0))
    progress = begun(MissionProgress(worlds), 0)
    progress.reset_period()
    counted = Program(lambda: [*worlds.steps(), *progress.steps()])
    while not worlds.task.garbage.blind[0]:
        worlds.run(counted, 1)
    worlds.drive(np.zeros((1, 2)))  # it stays beside the item
    blind = 0
    while worlds.task.garbage.cargo[0] == NOTHING:
        worlds.run(counted, 1)
        blind += 1
    assert blind == BLIND + 1
    assert worlds.physics.positions[0, 0] < 5.4
    worlds.drive(None)
    while worlds.task.garbage.cargo[0] != NOTHING:  # it brings what is near to the station, and puts down leftovers
        worlds.run(counted, 1)
    assert worlds.task.garbage.leftover[0, 0] == 1
    assert progress.events[[PICKINGS, RECYCLINGS], 0].tolist() == [1, 1]


@pytest.mark.parametrize(
    ("parameters", "message"),
    [
        ({"span": -1.0}, r"ToRecycling.action.1.HandOver.span: expected greater than or equal to 0, got -1"),
        ({"span": 4.0, "near": -2.0}, r"HandOver.near: expected greater than or equal to 0, got -2"),
        ({"span": 4.0, "blind": 0.0}, r"behaviours.ToRecycling.action: HandOver: blind must be at least 1e-06, got 0"),
        ({"spam": 4.0}, r"unknown parameter 'spam' \(known: .*span"),
    ],
)
def test_numbers_without_sense_are_refused(parameters, message):
    with pytest.raises(DocumentError, match=message):
        Library().configuration("ToStation", parameters)
