"""Counts of a period: "avoiding" is that of the coordinator of AvoidCollision, and an item is picked once."""

import numpy as np
import pytest

from clean_swarm_env.borders.infos import own_infos, team_infos
from clean_swarm_env.config.types import AVOIDANCE
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.progress import AVOIDINGS
from clean_swarm_env.learning.reward import RewardConfig
from clean_swarm_env.tasks import TASKS
from clean_swarm_env.tasks.cleaning.learning.counts import PICKINGS
from clean_swarm_env.tasks.foraging import Foraging
from selforg.program import AFTER_MOVING, Rows, Step
from tests.clean_swarm_env.courses import begun, mission

PERIODS = 30


def counted(batch, monkeypatch):
    """Return the ticks (P, R) of each period in which a robot's coordinator of avoidance ran, and those counted."""
    network, steps = batch.worlds.network, batch.worlds.steps
    ran = np.zeros(batch.rows, dtype=np.int64)

    def count(now, rows):
        ran[:] += network.executing[:, network.model.behaviour_index[AVOIDANCE]]

    counting = Step(AFTER_MOVING, count, Rows.of(np.arange(batch.rows)))
    monkeypatch.setattr(batch.worlds, "steps", lambda: [*steps(), counting])
    batch.reset([1, 2])
    expected, given, rewards = [], [], []
    for _ in range(PERIODS):
        ran[:] = 0
        step = batch.step(np.tile(batch.choices.default, (batch.rows, 1)))
        expected.append(ran.copy())
        given.append(batch.progress.events[AVOIDINGS].copy())
        rewards.append(step.rewards.copy())
    return np.array(expected), np.array(given), np.array(rewards)


@pytest.mark.parametrize("name", ["table1", "cleaning-patrol"])
def test_avoiding_is_that_of_the_coordinator_of_avoidance(name, monkeypatch):
    batch = Batch(name, 2, reward=RewardConfig(cost=0.0, avoiding=-1.0))
    expected, given, rewards = counted(batch, monkeypatch)
    assert expected.any()
    assert given.tolist() == expected.tolist()
    np.testing.assert_allclose(rewards, -0.2 * expected)


def test_without_a_coordinator_of_avoidance_nobody_avoids():
    batch = begun(Batch("Foraging", observation={"terms": ["avoidance"]}), [1])
    for _ in range(PERIODS):
        seen = batch.step(np.tile(batch.choices.default, (batch.rows, 1))).observations
        assert not batch.progress.events[AVOIDINGS].any()
        assert not seen.any()


def test_an_item_is_paid_for_once_whoever_picks_it_again():
    crowded = mission(
        "bumpers", robots={"count": 16}, garbage={"count": 16}, consequences={"drop": True}, knowledge="avoidance",
        time_limit=240.0,
    )  # fmt: skip
    batch = begun(Batch(crowded), [1])
    off = np.full(batch.rows, batch.options[AVOIDANCE].index("Off"))
    paid = picked = 0
    carried = batch.worlds.task.garbage.cargo >= 0
    while not batch.finished:
        for worlds in batch.ticks(off):
            picked += int((worlds.task.garbage.cargo[~carried] >= 0).sum())
            carried = worlds.task.garbage.cargo >= 0
        paid += int(batch.progress.events[PICKINGS].sum())
        batch.end_period()
    assert picked > 2 * 16  # robots collide, and what they lose is picked again
    assert 0 < paid <= 16


def test_what_robots_of_any_task_achieve_is_counted_told_and_paid():
    weights = {"own_brought": 2.0, "brought": 0.5, "items_brought_per_minute": 0.0}
    batch = begun(Batch("Foraging", 2, reward=weights, observation={"terms": ["idle"]}), [1, 2])
    before, total = np.zeros(2, dtype=np.int64), 0
    for _ in range(60):
        step = batch.step(np.tile(batch.choices.default, (batch.rows, 1)))
        own, (team,) = batch.progress.events[0], batch.progress.team
        assert own.reshape(2, -1).sum(axis=1).tolist() == team.tolist()
        np.testing.assert_allclose(step.rewards, 2.0 * own + 0.5 * np.repeat(team, batch.robots))
        assert (step.observations[own > 0, 0] < 1.0 / 60.0).all()
        told, robots = team_infos(batch), own_infos(batch)
        assert (told["brought"], robots["own_brought"]) == (team.tolist(), own.tolist())
        assert told["items_brought"] == (before := before + team).tolist()
        total += int(own.sum())
    assert total > 0
    assert batch.progress.idle.max() == 300


def test_a_task_with_a_cost_pays_what_its_cost_grew_by(monkeypatch):
    members = {"name": "Costly", "goal": "Foraging", "priced": True, "__module__": __name__}
    members["cost"] = lambda self, world, values: 3.0 * float(self.state.brought[world])
    monkeypatch.setitem(TASKS._classes, "Costly", type("Costly", (Foraging,), members))
    batch = begun(Batch({"task": "Costly", "time_limit": 30.0}, 2, reward={"cost": 1.0}), [1, 2])
    paid = np.zeros(2)
    for _ in range(30):
        step = batch.step(np.tile(batch.choices.default, (batch.rows, 1)))
        paid += step.rewards.reshape(2, -1)[:, 0]
    assert paid.tolist() == [end.result.cost_s for end in batch.finished]
    assert paid.any()
