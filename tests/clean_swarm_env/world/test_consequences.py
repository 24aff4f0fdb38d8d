"""Consequences of collisions: who collides stands and loses its cargo; nobody else does."""

import json

import numpy as np
import pytest

from clean_swarm_env.config.load import with_changes
from clean_swarm_env.config.mission import StartConfiguration
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.recording.reader import RecordedMission
from clean_swarm_env.tasks.cleaning.garbage import CARRIED, DONE, LYING, NOTHING
from clean_swarm_env.tasks.cleaning.learning.counts import DUMPINGS
from tests.clean_swarm_env.courses import CROWD, begun, mission, ticked, worlds_at_start
from tests.train.commands import run

STOP = 3.0
FACING = StartConfiguration(id="facing", robots=((5.0, 9.0, 0.0), (6.0, 9.0, np.pi), (1.0, 1.0, 0.0)), items=())


def crowd(**consequences):
    return CROWD.model_validate(with_changes(CROWD.model_dump(), {"task": {"consequences": consequences}}))


def driven(config, start=FACING, speeds=(1.0, -1.0, 0.5)):
    """Return one world whose robots are driven along x at `speeds`."""
    batch = begun(Batch(config, action={"mode": "velocity"}), [1], [start])
    batch.worlds.drive(np.array([[speed, 0.0] for speed in speeds]))
    return batch.worlds


def open_mission(**changes):
    events = [{"at": 900.0, "do": "land", "items": 1}]
    return mission(**{"robots": {"count": 3}, "garbage": {"count": 0}, "events": events, **changes})


def test_two_robots_that_collide_stand_for_the_time_and_then_go_on():
    worlds = driven(open_mission(consequences={"stop": STOP}))
    while not worlds.tick().any():
        pass
    places = worlds.physics.positions.copy()
    worlds.tick()  # brakes act at once, but in the tick of the collision both were still driving
    stopped = worlds.physics.positions.copy()
    for _ in range(round(STOP / worlds.period) - 1):
        worlds.tick()
        moved = np.abs(worlds.physics.positions - stopped).max(axis=1)
        assert moved[:2].max() < 0.03  # the solver moves discs that overlap apart
        assert moved[2] > 0.05
    assert (worlds.task.consequences.standing > 0).tolist() == [True, True, False]
    worlds.drive(np.array([[-1.0, 0.0], [1.0, 0.0], [0.0, 0.0]]))
    ticked(worlds, 20)
    assert np.abs(worlds.physics.positions - places)[:2, 0].min() > 0.3


def test_collisions_are_harmless_in_the_worlds_whose_missions_say_so():
    hard = open_mission(consequences={"stop": STOP, "drop": True})
    soft = open_mission(consequences={"stop": STOP, "drop": True, "harmless": True})
    batch = Batch(hard, worlds=2, action={"mode": "velocity"})
    worlds = batch.worlds
    for turn in range(2):
        for world, own in enumerate((soft, hard) if turn else (hard, soft)):
            worlds.reset(world, FACING, 1, own)
            batch.progress.reset(world)
        worlds.drive(np.array([[speed, 0.0] for speed in (1.0, -1.0, 0.5)] * 2))
        while not (entered := worlds.tick()).any():
            pass
        assert (entered > 0).tolist() == [True, True, False] * 2
        hurt = (worlds.task.consequences.standing > 0).reshape(2, 3)
        assert hurt[turn].tolist() == [True, True, False]
        assert not hurt[1 - turn].any()
        costs = [worlds.task.cost(world, {}) for world in range(2)]
        assert costs[turn] - costs[1 - turn] == pytest.approx(hard.collision_cost)


def test_robots_that_back_off_part_after_they_have_stood_at_half_their_speed():
    robots = {"count": 3, "max_speed": 0.8}
    worlds = driven(open_mission(consequences={"stop": 1.0, "back_off": 3.0}, robots=robots))
    while not worlds.tick().any():
        pass
    for _ in range(20):  # 1 s and 3 s
        held, places = worlds.task.consequences.standing.copy(), worlds.physics.positions.copy()
        worlds.tick()
    assert np.hypot(*(worlds.physics.positions - places)[:2].T) == pytest.approx(0.4 * worlds.period)
    assert held.tolist() == [2, 2, 0]
    first, second = worlds.physics.positions[:2]
    assert np.hypot(*(first - second)) > 1.0


def test_who_stands_decides_nothing_and_handles_nothing():
    worlds = worlds_at_start(crowd(stop=STOP), [5, 6])
    network, garbage, stood = worlds.network, worlds.task.garbage, 0
    for _ in range(200):
        before, cargo = network.state.values.copy(), garbage.cargo.copy()
        held = worlds.task.consequences.standing > 1
        worlds.tick()
        stood += int(held.sum())
        assert np.array_equal(network.state.values[held], before[held])
        assert np.array_equal(garbage.cargo[held], cargo[held])
    assert stood > 100


def test_cargo_that_is_lost_lies_where_the_robot_is_and_is_not_dumped():
    batch = begun(Batch(mission(robots={"count": 10}, consequences={"stop": STOP, "drop": True}), 2), [5, 6])
    worlds, garbage, lost = batch.worlds, batch.worlds.task.garbage, 0
    cargo = garbage.cargo.copy()
    for _ in range(200):
        for _ in batch.ticks(np.ones(batch.rows, dtype=np.int64)):
            hit = worlds.collisions.entered_in_tick > 0
            assert (garbage.cargo[hit] == NOTHING).all()
            for row in np.flatnonzero(hit & (cargo != NOTHING)):
                if garbage.stage[row // 10, cargo[row]] == LYING:
                    assert np.array_equal(garbage.positions[row // 10, cargo[row]], worlds.physics.positions[row])
                    lost += 1
            for world in range(2):
                assert worlds.minds.buffers["items"].count(world, "garbage") == (garbage.stage[world] == LYING).sum()
            cargo = garbage.cargo.copy()
        assert batch.progress.events[DUMPINGS].sum() == batch.progress.team[DUMPINGS].sum()
    assert lost > 10
    assert (garbage.stage == CARRIED).sum() == (garbage.cargo != NOTHING).sum()
    assert (garbage.stage == DONE).sum() == garbage.done.sum() > 0


def test_recordings_and_explanations_say_who_stands_and_how_often_it_collided(tmp_path, capsys):
    experiment = {"name": "x", "mission": {**crowd(stop=STOP).model_dump(mode="json"), "time_limit": 30.0},
                  "conditions": [{"name": "by score"}]}  # fmt: skip
    (tmp_path / "x.yaml").write_text(json.dumps(experiment))
    out = tmp_path / "run"
    assert run("evaluate", tmp_path / "x.yaml", "--scenarios", 1, "--workers", 1, "--record", "--output", out) == 0
    recording = RecordedMission(next((out / "recordings").iterdir()))
    standing, contact = recording["standing"], recording["contact"]
    assert np.array_equal(recording["collisions"], np.cumsum(contact, axis=0))
    assert (standing[contact > 0] == round(STOP * 5) + 1).all()
    assert contact.any()
    frame, robot = np.argwhere(standing > 0)[-1].tolist()
    capsys.readouterr()
    assert run("explain", out, "--robot", robot, "--time", frame * 0.2) == 0
    seconds = standing[frame, robot] * 0.2
    assert f"a collision stops it for {seconds:g} s" in capsys.readouterr().out
