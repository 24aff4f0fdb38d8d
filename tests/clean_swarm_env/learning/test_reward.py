"""The reward is the sum of its parts."""

from types import SimpleNamespace

import numpy as np
import pytest

from clean_swarm_env.config.load import load_family
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.progress import AVOIDINGS, COLLISIONS, CONTACTS, EVENTS, Period
from clean_swarm_env.learning.reward import REWARD_TERMS, RewardConfig, Rewards
from clean_swarm_env.tasks import Cleaning
from clean_swarm_env.tasks.cleaning.cost import cost_terms
from clean_swarm_env.tasks.cleaning.learning.counts import DUMPINGS, PICKINGS, RECYCLINGS
from clean_swarm_env.testing import check_reward_term
from clean_swarm_env.world.mission_end import COMPLETED, RUNNING
from selforg.compiler.records import Packed
from tests.clean_swarm_env.courses import begun

KINDS = (*(achievement.name for achievement in Cleaning.achievements), *EVENTS)


def progress(**events):
    """Return what two worlds of two robots counted in a period: the first dumped an item and was completed by it."""
    counted = np.zeros((len(KINDS), 4), dtype=np.int64)
    for name, values in events.items():
        counted[KINDS.index(name)] = values
    period = Period(
        events=counted,
        team=np.array([[0, 0], [0, 0], [1, 0]]),
        ticks=np.array([5, 2]),
        outcome=np.array([COMPLETED, RUNNING]),
        took_part=np.ones(4, dtype=np.bool_),
        cost=np.array([1.0, 0.4]),
        price=np.array([0.0, 8.0]),
        bumps=np.array([0.0, 0.0, 6.0, 2.0]),
    )
    return SimpleNamespace(period=Packed(period), **period._asdict())


def gained(config, counted):
    out = np.full(4, np.nan)
    Rewards(config, SimpleNamespace(task=Cleaning, worlds=2, period=0.2)).of(SimpleNamespace(progress=counted), out)
    return out.tolist()


def test_the_reward_is_the_weighted_sum_of_its_parts():
    config = RewardConfig(cost=0.0, dumped=2.0, time=-0.5, collision=-0.25)
    assert gained(config, progress(collision=[0, 1, 2, 0])) == pytest.approx([1.5, 1.25, -0.7, -0.2])


@pytest.mark.parametrize(
    ("term", "kind", "amount"),
    [
        ("own_picked", PICKINGS, 1.0), ("own_recycled", RECYCLINGS, 1.0), ("own_dumped", DUMPINGS, 1.0),
        ("collision", COLLISIONS, 1.0), ("contact", CONTACTS, 0.2), ("avoiding", AVOIDINGS, 0.2),
    ],
)  # fmt: skip
def test_each_term_of_its_own_pays_for_its_own_events(term, kind, amount):
    counted = progress(**{KINDS[kind]: [1, 0, 0, 3]})
    config = RewardConfig(**{"cost": 0.0, term: 2.0})
    assert gained(config, counted) == pytest.approx([2 * amount, 0.0, 0.0, 6 * amount])
    others = progress(**{name: [1, 1, 1, 1] for name in KINDS if name != KINDS[kind]})
    assert gained(config, others) == [0.0] * 4
    halved = config.model_copy(update={"shared": 0.5})
    assert gained(halved, counted) == pytest.approx([1.5 * amount, 0.5 * amount, 1.5 * amount, 4.5 * amount])


def test_completing_pays_once():
    config = RewardConfig(cost=0.0, completed=10.0)
    counted = progress()
    assert gained(config, counted) == [10.0, 10.0, 0.0, 0.0]
    counted.ticks[:] = 0  # the mission was over before the period
    assert gained(config, counted) == [0.0] * 4


def test_who_took_no_part_gets_nothing_and_does_not_share():
    counted = progress(collision=[0, 4, 2, 0])
    counted.took_part[3] = False
    config = RewardConfig(cost=0.0, collision=-0.5, shared=1.0)
    assert gained(config, counted) == pytest.approx([-1.0, -1.0, -1.0, 0.0])


def test_the_price_of_collisions_is_shared_by_who_took_part_in_them():
    counted = progress()
    assert gained(RewardConfig(), counted) == pytest.approx([-0.01, -0.01, -0.004 - 0.12, -0.004 - 0.04])
    assert gained(RewardConfig(shared=1.0), counted) == pytest.approx([-0.01, -0.01, -0.084, -0.084])
    counted.bumps[:] = 0.0  # nobody at work took part
    assert gained(RewardConfig(), counted) == pytest.approx([-0.01, -0.01, -0.084, -0.084])


def test_collisions_that_cost_nothing_have_no_price():
    config = RewardConfig(cost=0.0, price=-0.5)
    counted = progress(collision=[1, 1, 3, 1])
    assert gained(config, counted) == [0.0, 0.0, -3.0, -1.0]
    assert gained(config.model_copy(update={"shared": 1.0}), counted) == [0.0, 0.0, -2.0, -2.0]


LUCK = np.random.default_rng(1)
"""Random numbers that no seed decides, for classes that break their promises."""


def eastward(batch):
    """Return how far east each robot is, as a share of the ground."""
    return batch.worlds.physics.positions[:, 0] / batch.worlds.extent[0]


@pytest.fixture
def registered():
    REWARD_TERMS.register(eastward)
    yield "eastward"
    REWARD_TERMS._classes.pop("eastward")


def test_a_reward_term_of_ones_own_has_a_weight_beside_others(registered):
    check_reward_term(eastward)
    for mission, usual in (("table1", {"cost": 0.0, "time": -0.5}), ("Foraging", {"collision": -0.25})):
        plain, own = (Batch(mission, 2, reward=usual | more) for more in ({}, {registered: 2.0}))
        for batch in (plain, own):
            batch.reset([1, 2])
        for _ in range(3):
            paid, more = (batch.step(np.tile(batch.choices.default, (batch.rows, 1))).rewards for batch in (plain, own))
            np.testing.assert_allclose(more, paid + 2.0 * eastward(own))
    with pytest.raises(ValueError, match=r"reward: eastwards: unknown key 'eastwards' .*did you mean 'eastward'"):
        Batch(reward={"eastwards": 1.0})


@pytest.mark.parametrize(
    ("function", "said"),
    [
        (lambda batch: np.zeros(3), "mine: expected finite numbers"),
        (lambda batch: np.full(batch.rows, np.inf), "mine: expected finite numbers"),
        (lambda batch: batch.luck, "AttributeError: 'Batch' object has no attribute 'luck'"),
        (lambda batch: batch.observations.fill(0) or np.zeros(batch.rows), "expected to change no array that it reads"),
        (lambda batch: LUCK.random(batch.rows), "the same if it is asked twice"),
        (lambda batch: np.full(batch.rows, batch.rows), "the same in a world alone and among others"),
    ],
)
def test_a_reward_term_that_breaks_its_contract_is_one_line(function, said, monkeypatch):
    function.__name__ = "mine"
    monkeypatch.setitem(REWARD_TERMS._classes, "mine", function)
    with pytest.raises(ValueError, match=said) as raised:
        check_reward_term(function)
    assert "\n" not in str(raised.value)


SCENARIOS = 3


def check_paid(family, option):
    """Compare the mean payment of the robots with the cost, for each scenario of a fixed option."""
    scenarios = iter([family.scenario(0, k, "test") for k in range(SCENARIOS)])
    batch = begun(
        Batch(family=family, worlds=SCENARIOS, source=lambda _: next(scenarios, None), reward=RewardConfig(cost=-1))
    )
    paid, costs, scales = np.zeros(SCENARIOS), np.zeros(SCENARIOS), np.ones(SCENARIOS)
    while not batch.progress.outcome.all():
        rewards = batch.step(np.full(batch.rows, option)).rewards.reshape(SCENARIOS, -1)
        took_part = batch.progress.took_part.reshape(SCENARIOS, -1)
        paid += rewards.sum(axis=1) / np.maximum(took_part.sum(axis=1), 1)
        for end in batch.finished:
            costs[end.world], terms = end.result.cost_s, cost_terms(end.scenario.mission)
            scales[end.world] = terms.limit / terms.worth if terms.worth else 1.0
    # a tick more where the mission was completed; for all items that were expected where garbage keeps coming
    np.testing.assert_allclose(-paid, scales * costs, atol=0.2 + 1e-9)
    assert (costs > 0.0).all()


def brief(name, limit):
    """Return a family whose missions end soon."""
    family = load_family(name)
    mission = family.mission.model_copy(update={"time_limit": min(family.mission.time_limit, limit)})
    return family.model_copy(update={"mission": mission})


@pytest.mark.parametrize(
    ("name", "limit", "most"),
    [
        ("crowded-bumpers", 60.0, 1),
        *(
            pytest.param(name, 300.0, 99, marks=pytest.mark.long)
            for name in ("crowded-bumpers", "random-bumpers", "shifting-bumpers", "crowded")
        ),
    ],
)
def test_a_team_is_paid_what_its_mission_costs_by_every_option(name, limit, most):
    family = brief(name, limit)
    for option in range(min(most, Batch(family=family).choices.counts[0])):
        check_paid(family, option)
