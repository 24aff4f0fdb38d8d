"""Observations against a naive account of each robot, their bounds in crowds and deserts, and the choice of terms."""

from math import atan2, cos, hypot, sin

import numpy as np
import pytest

from clean_swarm_env.config.mission import StartConfiguration
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.observation.config import ObservationConfig
from clean_swarm_env.learning.observation.term import TERMS
from clean_swarm_env.tasks import Cleaning, Task
from clean_swarm_env.tasks.cleaning.garbage import LYING, NOTHING
from clean_swarm_env.tasks.cleaning.learning.around import PHASES
from selector.documents.errors import DocumentError
from selforg.program import STARTING, Rows, Step
from tests.clean_swarm_env.courses import OPTIONS, begun, long_course, mission

RANGES = (1.0, 1.5, 2.5)


def _offset(worlds, place, other):
    half = worlds.extent / 2
    return (np.asarray(other) - place + half) % worlds.extent - half


def _way(worlds, row, other, scale):
    """Distance by `scale` and the direction in the robot's frame."""
    x, y = _offset(worlds, worlds.physics.positions[row], other)
    angle = atan2(y, x) - worlds.physics.headings[row]
    return [min(hypot(x, y) / scale, 1.0), cos(angle), sin(angle)]


def _task(batch, row):
    worlds, garbage = batch.worlds, batch.worlds.task.garbage
    world, stations = row // worlds.robots, worlds.mission.task.stations
    place, diagonal = worlds.physics.positions[row], hypot(*worlds.extent) / 2
    carrying, recycled = garbage.cargo[row] != NOTHING, garbage.recycled[row] == 1
    items = garbage.positions[world][garbage.stage[world] == LYING]
    near = sorted((hypot(*_offset(worlds, place, item)), k) for k, item in enumerate(items))
    seen = bool(near) and near[0][0] <= 2.0
    phase = ("to_dump" if recycled else "to_recycling") if carrying else ("approach" if seen else "patrol")
    ways = [_way(worlds, row, station, diagonal) for station in (stations.recycling, stations.dump)]
    distances = [hypot(*_offset(worlds, place, station)) for station in (stations.recycling, stations.dump)]
    place_name = ("carrying" if carrying else "free") + ("_near" if min(distances) <= 2.0 else "_far")
    return {
        "garbage": [1.0, *_way(worlds, row, items[near[0][1]], 2.0)] if seen else [0.0, 1.0, 0.0, 0.0],
        "cargo": [float(carrying), float(recycled)],
        "phase": [float(phase == name) for name in PHASES],
        "situation": [float(place_name == name) for name in TERMS.find("situation").components],
        "recycling": ways[0],
        "dump": ways[1],
        "nearness": [max(1.0 - distance / 2.0, 0.0) for distance in distances],
        "target": ways[int(recycled)] if carrying else [1.0, 0.0, 0.0],
    }


def _heard(batch, row, spread):
    """Return the terms of a robot that has heard `spread`: positions and headings of all robots, oldest first."""
    worlds = batch.worlds
    others = [other for other in worlds.rows_of(row // worlds.robots) if other != row]
    terms = {"neighbour": [1.0, 0.0, 0.0], "encounter": [0.0] * 3, "crowd": [0.0] * 3}
    if not spread:
        return terms
    places, headings = spread[-1]
    offsets = {other: _offset(worlds, places[row], places[other]) for other in others}
    near = sorted((hypot(*offset), other) for other, offset in offsets.items() if hypot(*offset) <= RANGES[-1])
    terms["crowd"] = [sum(distance <= reach for distance, _ in near) / 6 for reach in RANGES]
    if near:
        distance, other = near[0]
        own = worlds.physics.headings[row]
        angle, turned = atan2(*offsets[other][::-1]) - own, headings[other] - own
        before = spread[-2][0] if len(spread) > 1 else places
        own_way, way = (_offset(worlds, before[k], places[k]) / 0.2 for k in (row, other))
        closing = float((own_way - way) @ offsets[other]) / distance / 2.0
        terms["neighbour"] = [distance / RANGES[-1], cos(angle), sin(angle)]
        terms["encounter"] = [cos(turned), sin(turned), closing]
    return terms


def _expected(batch, row, idle, spread):
    worlds, config = batch.worlds, batch.mission
    world, network = row // worlds.robots, worlds.network
    length = network.readings[row, network.model.sensor_index["rep_len"]]
    avoiding = network.executing[row, network.model.behaviour_index["AvoidCollision"]]
    terms = {
        **_task(batch, row),
        **_heard(batch, row, spread),
        "avoidance": [min(length / 1.5, 1.0), float(avoiding)],
        "movement": [worlds.floor.drive.speed[row], worlds.floor.drive.turn_rate[row] / 2.0],
        "time": [1.0 - worlds.ticks[world] * 0.2 / config.time_limit],
        "idle": [min(idle / 60.0, 1.0)],
        "holds": [float(worlds.coordinators[0].held[row] == k) for k in range(3)],
    }
    return np.concatenate([terms[name] for name in Cleaning.terms])


@long_course
@pytest.mark.parametrize("name", ["table1", "reference"])
def test_every_term_is_what_its_name_says(name, monkeypatch):
    batch, rng, idle = Batch(mission(name), 2), np.random.default_rng(1), np.zeros(10)
    spread, own, physics = [], batch.worlds.steps, batch.worlds.physics

    def note(now, rows):
        spread.append((physics.positions.copy(), physics.headings.copy()))

    noting = Step(STARTING, note, Rows.of(np.arange(10)))
    monkeypatch.setattr(batch.worlds, "steps", lambda: [*own(), noting])
    seen = batch.reset([1, 2])
    met = np.zeros(batch.observer.width)
    for _ in range(90):
        for row in range(10):
            np.testing.assert_allclose(seen[row], _expected(batch, row, idle[row], spread), atol=1e-6, err_msg=str(row))
        met += np.abs(seen).max(axis=0) > 0
        seen = batch.step(rng.integers(0, 3, 10)).observations
        assert not batch.finished
        idle = np.where(batch.progress.events[:3].any(axis=0), batch.progress.idle * 0.2, idle + 1.0)
    assert met.all(), [name for name, count in zip(batch.observer.names, met, strict=True) if not count]


@pytest.mark.parametrize(
    ("delivery", "heard"),
    [({"loss": 1.0}, 0), ({"reach": 1.2}, 1), ({}, 2)],
    ids=["lost", "near ones only", "all"],
)
def test_robots_do_not_see_those_of_whom_they_have_heard_nothing(delivery, heard):
    config = mission(robots={"count": 3}, delivery=delivery)
    batch = Batch(config)
    robots = [[3.0, 3.0, 0.0], [4.0, 3.0, 0.0], [3.0, 5.0, 0.0]]
    batch.reset([1], [StartConfiguration(id="near", robots=robots, items=[[9.0, 9.0]] * 10)])
    names, seen = batch.observer.names, batch.step(np.zeros(batch.rows, np.int64)).observations[0]
    component = dict(zip(names, seen.tolist(), strict=True))
    assert component["crowd_2.5m"] == pytest.approx(heard / 6)
    assert (component["neighbour_distance"] < 1.0) == (heard > 0)


def test_who_mistakes_the_own_place_is_heard_there():
    batch, off = begun(Batch(mission(robots={"pose_noise": 0.3})), [1]), []
    heard, extent = batch.observer.names.index("neighbour_distance"), batch.worlds.extent
    for _ in range(40):
        seen = batch.step(np.zeros(batch.rows, np.int64)).observations
        apart = batch.worlds.physics.positions[:, None] - batch.worlds.physics.positions
        distances = np.linalg.norm(apart - extent * np.round(apart / extent), axis=2) + 1e9 * np.eye(batch.rows)
        nearest = distances.min(axis=1) / RANGES[-1]
        off += (seen[:, heard] - nearest)[nearest < 0.6].tolist()
    assert 0.05 < np.std(off) * RANGES[-1] < 1.0  # that of the difference of two places is 0.3 sqrt 2 m


def test_terms_are_chosen_ordered_and_weighted():
    whole = Batch()
    chosen = ["holds", {"name": "time", "weight": -2.0}, "cargo", {"name": "neighbour", "weight": 0.5}]
    batch = Batch(observation=ObservationConfig(terms=chosen))
    full, part = whole.reset([3]), batch.reset([3])
    names = batch.observer.names
    weight = {"time_left": -2.0, **dict.fromkeys(TERMS.find("neighbour").components, 0.5)}
    for k, name in enumerate(names):
        expected = full[:, whole.observer.names.index(name)] * np.float32(weight.get(name, 1.0))
        assert np.array_equal(part[:, k], expected)
        assert batch.observer.bounds[k] == abs(weight.get(name, 1.0))
    assert names[:3] == tuple(f"holds_{option}" for option in OPTIONS)
    assert len(names) == 3 + 1 + 2 + 3


@pytest.mark.parametrize(
    ("given", "message"),
    [
        ({"terms": ["garbag"]}, "unknown observation term 'garbag'.*did you mean 'garbage'"),
        ({"terms": ["cargo", "cargo"]}, "expected unique names, got 'cargo' twice"),
        ({"terms": []}, "at least 1"),
        ({"terms": [{"name": "cargo", "wait": 1.0}]}, "wait"),
        ({"neighbour_ranges": [1.0, 1.0]}, "expected growing distances"),
        ({"terms": [{"name": "idle", "patience": 3.0}]}, "unknown setting 'patience'"),
        ({"full_crowd": 0}, "greater than or equal to 1"),
    ],
)
def test_impossible_choices_are_refused(given, message):
    with pytest.raises(ValueError, match=message):
        ObservationConfig.model_validate(given)


@pytest.mark.parametrize(
    "changes",
    [
        {"robots": {"count": 60}},
        {"robots": {"count": 1}},
        {"robots": {"count": 1}, "garbage": {"count": 0}},
        {"robots": {"pose_diffusion": 0.0, "pose_goal_radius": 0.0}},
        {"world": {"width": 3.0, "height": 40.0}, "stations": {"recycling": [0.0, 0.0], "dump": [3.0, 40.0]}},
    ],
    ids=["crowd", "alone", "nothing to do", "no reach", "narrow"],
)
def test_observations_stay_within_their_bounds(changes):
    batch = Batch(mission(**changes), observation=ObservationConfig(full_crowd=2))
    seen = batch.reset([1])
    for _ in range(40):
        assert (np.abs(seen) <= 1.0).all()
        seen = batch.step(np.full(batch.rows, 1)).observations


@pytest.mark.parametrize("term", ["garbage", "nearness", "finds", "loads", "yards", "true_season"])
def test_a_task_without_items_says_so(term):
    with pytest.raises(ValueError, match=f"^observation: terms: {term}: expected the task Cleaning, got Foraging$"):
        Batch("Foraging", observation={"terms": ["time", term]})


def test_terms_are_those_of_the_task_unless_others_are_chosen():
    assert ObservationConfig().of(Task.terms) == ObservationConfig(terms=Task.terms)
    assert [term.name for term in Batch("Foraging").observer.config.terms] == [*Task.terms]


def test_without_items_nobody_sees_one():
    batch = Batch(mission(garbage={"count": 0}), 2)
    seen = [batch.reset([5, 6]).copy()]
    for _ in range(20):
        step = batch.step(np.zeros(batch.rows, dtype=np.int64))
        seen += [step.observations.copy(), step.final_observations.copy()]
        assert not batch.worlds.task.phase().any()
    assert not np.array(seen)[:, :, batch.observer.names.index("garbage_seen")].any()


def test_what_is_remembered_is_the_largest_value_so_far_of_each_mission_alone_or_beside_others():
    seen = {"terms": ["situation", {"name": "crowd", "weight": -2.0}], "remembers": ["crowd"]}
    batch, alone = (Batch("table1", count, observation=seen, time_limit=30.0) for count in (2, 1))
    names = batch.observer.names
    assert names[-3:] == tuple(f"most_{name}" for name in names[4:7])
    assert batch.observer.bounds.tolist() == [1.0] * 4 + [2.0] * 6
    least, begins = np.zeros((batch.rows, 3)), np.array([True, True])
    batch.reset([5, 6])
    alone.reset([6])
    for period in range(45):
        least[np.repeat(begins, batch.robots)] = 0.0
        least = np.minimum(least, batch.observations[:, 4:7])
        np.testing.assert_array_equal(batch.observations[:, 7:], least)
        np.testing.assert_array_equal(batch.observations[batch.robots :], alone.observations)
        if period == 20:
            state = batch.get_state()
        actions = np.zeros(batch.rows, dtype=np.int64)
        begins = (step := batch.step(actions)).terminated | step.truncated
        alone.step(actions[: alone.rows])
    last = batch.observations.copy()
    batch.set_state(state)
    for _ in range(25):
        batch.step(np.zeros(batch.rows, dtype=np.int64))
    np.testing.assert_array_equal(batch.observations, last)
    with pytest.raises(DocumentError, match="remembers: unknown term 'facts'"):
        Batch("table1", observation=seen | {"remembers": ["facts"]})
