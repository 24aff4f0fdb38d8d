"""Counts of a period: "avoiding" is that of the coordinator of AvoidCollision, and an item is picked once."""

import numpy as np
import pytest

from clean_swarm_env.config.types import AVOIDANCE
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.progress import AVOIDINGS, PICKINGS
from clean_swarm_env.learning.reward import RewardConfig
from tests.clean_swarm_env.courses import begun, mission

PERIODS = 30


def counted(batch, monkeypatch):
    """Return the ticks (P, R) of each period in which a robot's coordinator of avoidance ran, and those counted."""
    network, tick = batch.worlds.network, batch.worlds.tick
    ran = np.zeros(batch.rows, dtype=np.int64)

    def counting():
        entered = tick()
        ran[:] += network.executing[:, network.model.behaviour_index[AVOIDANCE]]
        return entered

    monkeypatch.setattr(batch.worlds, "tick", counting)
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
