"""The reward is the sum of its parts."""

from types import SimpleNamespace

import numpy as np
import pytest

from clean_swarm_env.learning.progress import (
    AVOIDINGS,
    COLLISIONS,
    CONTACTS,
    DUMPINGS,
    EVENTS,
    PERIOD_RECORD,
    PICKINGS,
    RECYCLINGS,
    Period,
)
from clean_swarm_env.learning.reward import RewardConfig, Rewards
from clean_swarm_env.world.mission_end import COMPLETED, RUNNING


def progress(**events):
    """Return what two worlds of two robots counted in a period: the first dumped an item and was completed by it."""
    counted = np.zeros((len(EVENTS), 4), dtype=np.int64)
    for name, values in events.items():
        counted[EVENTS.index(name)] = values
    period = Period(
        counted, np.array([5, 2]), np.array([1, 0]), np.array([COMPLETED, RUNNING]), np.ones(4, dtype=np.bool_)
    )
    return SimpleNamespace(period=PERIOD_RECORD.pack(period), **period._asdict())


def gained(config, counted):
    out = np.full(4, np.nan)
    Rewards(config, 0.2).of(counted, out)
    return out.tolist()


def test_the_reward_is_the_weighted_sum_of_its_parts():
    config = RewardConfig(dumped=2.0, time=-0.5, collision=-0.25)
    assert gained(config, progress(collision=[0, 1, 2, 0])) == pytest.approx([1.5, 1.25, -0.7, -0.2])


@pytest.mark.parametrize(
    ("term", "kind", "amount"),
    [
        ("own_picked", PICKINGS, 1.0), ("own_recycled", RECYCLINGS, 1.0), ("own_dumped", DUMPINGS, 1.0),
        ("collision", COLLISIONS, 1.0), ("contact", CONTACTS, 0.2), ("avoiding", AVOIDINGS, 0.2),
    ],
)  # fmt: skip
def test_each_term_of_its_own_pays_for_its_own_events(term, kind, amount):
    nothing = {"dumped": 0.0, "time": 0.0, "collision": 0.0}
    counted = progress(**{EVENTS[kind]: [1, 0, 0, 3]})
    config = RewardConfig(**{**nothing, term: 2.0})
    assert gained(config, counted) == pytest.approx([2 * amount, 0.0, 0.0, 6 * amount])
    others = progress(**{name: [1, 1, 1, 1] for k, name in enumerate(EVENTS) if k != kind})
    assert gained(config, others) == [0.0] * 4
    halved = config.model_copy(update={"shared": 0.5})
    assert gained(halved, counted) == pytest.approx([1.5 * amount, 0.5 * amount, 1.5 * amount, 4.5 * amount])


def test_completing_pays_once():
    config = RewardConfig(dumped=0.0, time=0.0, completed=10.0)
    counted = progress()
    assert gained(config, counted) == [10.0, 10.0, 0.0, 0.0]
    counted.ticks[:] = 0  # the mission was over before the period
    assert gained(config, counted) == [0.0] * 4


def test_who_took_no_part_gets_nothing_and_does_not_share():
    counted = progress(collision=[0, 4, 2, 0])
    counted.took_part[3] = False
    assert gained(RewardConfig(collision=-0.5, shared=1.0), counted) == pytest.approx([-0.01, -0.01, -1.004, 0.0])


def test_misspelt_weights_are_refused():
    with pytest.raises(ValueError, match="colision"):
        RewardConfig(colision=1.0)
