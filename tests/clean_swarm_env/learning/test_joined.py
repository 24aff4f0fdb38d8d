"""Batches side by side against each alone, sources of scenarios, shared seeds, wrong use."""

import numpy as np
import pytest

from clean_swarm_env.config.load import load_family
from clean_swarm_env.learning.actions import ActionConfig
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.episodes import episodes_of
from clean_swarm_env.learning.joined import Joined, batches_of
from clean_swarm_env.learning.observation.config import ObservationConfig
from selector.documents.errors import DocumentError
from tests.clean_swarm_env.courses import begun, long_course, mission

SHORT = mission(garbage={"count": 2}, time_limit=30.0)
UNSEEN = ((8.0, 8.0), (16.0, 9.0), (18.0, 18.0))


def mix():
    """Return batches of two missions and a family, with 3, 5 and up to 5 robots a world."""
    small = mission(robots={"count": 3}, garbage={"count": 1}, time_limit=20.0)
    return [Batch(SHORT, 2), Batch(small, 1), *batches_of("random", 1, knowledge="cleaning")]


def options_of(rows, steps):
    return np.random.default_rng(1).integers(0, 2, (steps, rows))


@long_course
def test_rows_and_worlds_are_those_of_the_batches_one_after_the_other():
    joined, alone, ended = Joined(mix()), mix(), []
    assert joined.world_of.tolist() == [0] * 5 + [1] * 5 + [2] * 3 + [3] * alone[2].robots
    assert joined.first_rows.tolist() == [0, 5, 10, 13]
    seeds = [[5, 6], [7], [8]]
    first = joined.reset([5, 6, 7, 8])
    assert np.array_equal(first, np.concatenate([b.reset(s) for b, s in zip(alone, seeds, strict=True)]))
    for options in options_of(joined.rows, 60):
        step = joined.step(options)
        parts = [b.step(own) for b, own in zip(alone, np.split(options, [10, 13]), strict=True)]
        for name in step._fields:
            assert np.array_equal(getattr(step, name), np.concatenate([getattr(part, name) for part in parts])), name
        assert np.array_equal(joined.masks(), np.concatenate([b.masks() for b in alone]))
        firsts = zip((0, 2, 3), alone, strict=True)
        expected = [(first + e.world, e.scenario, e.result) for first, b in firsts for e in b.finished]
        assert [(e.world, e.scenario, e.result) for e in joined.finished] == expected
        ended += [end.world for end in joined.finished]
    assert {0, 1, 2} <= set(ended)
    assert joined.working.all() == all(b.working.all() for b in alone)


def test_a_shared_seed_is_dealt_out_to_the_worlds():
    batch, episodes = Batch(SHORT, 2), episodes_of(SHORT)
    batch.series.share(9)
    for first in (0, 2):
        batch.reset()
        assert batch.doing == [episodes.draw(9, first), episodes.draw(9, first + 1)]
    batch.reset([4, None])
    assert batch.doing == [episodes.draw(4, 0), episodes.draw(9, 5)]


def test_a_family_of_several_tori_makes_a_batch_for_each():
    batches = batches_of("unseen", 5)
    sizes = [(batch.mission.world.width, batch.mission.world.height) for batch in batches]
    assert (tuple(sizes), [batch.worlds.worlds for batch in batches]) == (UNSEEN, [2, 2, 1])
    unlike = {load_family("unseen").scenario(3, k, "train").mission.world.width for k in range(6)}
    assert len(unlike) > 1
    batches[1].reset([3, 4])
    for _ in range(3):
        assert {scenario.mission.world.width for scenario in batches[1].doing} == {16.0}
        batches[1].reset()
    assert [batch.worlds.worlds for batch in batches_of("unseen", 1, sizes=UNSEEN[2:])] == [1]
    assert len(batches_of("crowded", 3)) == 1


@long_course
def test_worlds_do_what_a_source_gives_and_stay_where_it_gives_nothing():
    given = [episodes_of(SHORT).draw(3, number) for number in range(3)]
    waiting, ends = iter(given), {}
    batch, alone = begun(Batch(SHORT, 4, source=lambda world: next(waiting, None))), begun(Batch(SHORT), [3])
    assert batch.doing == [*given, None]
    while len(ends) < 3:
        step = batch.step(np.zeros(20, dtype=np.int64))
        assert not step.rewards[15:].any()
        ends |= {end.world: end for end in batch.finished}
    assert all(end.scenario == given[world] for world, end in ends.items())
    idle = batch.step(np.zeros(20, dtype=np.int64))
    assert (idle.terminated | idle.truncated).all()
    assert not idle.rewards.any()
    assert batch.finished == ()
    while not alone.finished:
        alone.step(np.zeros(5, dtype=np.int64))
    assert ends[0].result == alone.finished[0].result


def twice(batch):
    return Joined([batch, batch])


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: Batch(SHORT, source=lambda world: None).reset([1]), "seeds: expected none, because a source"),
        (lambda: Joined([]), "batches: expected at least one"),
        (lambda: twice(Batch(SHORT)), "batches: expected each one once"),
        (
            lambda: Joined([Batch(SHORT), Batch(SHORT)]).reset(starts=[None]),
            "starts: expected one for each of 2 worlds, got 1",
        ),
        (
            lambda: begun(Joined([Batch(SHORT), Batch(SHORT)])).step(np.zeros(9, dtype=np.int64)),
            r"actions: expected one for each of 10 rows, got shape \(9,\)",
        ),
    ],
)
def test_wrong_use_is_named(call, message):
    with pytest.raises(ValueError, match=message):
        call()


@pytest.mark.parametrize(
    ("settings", "what"),
    [
        ({"action": ActionConfig(mode="velocity")}, "action"),
        ({"observation": ObservationConfig(terms=["crowd"])}, "observations and their bounds"),
    ],
)
def test_batches_that_no_learner_could_decide_for_together_are_refused(settings, what):
    with pytest.raises(DocumentError, match=rf"batches\[1\]: {what}: expected .* as in the first, got"):
        Joined([Batch(SHORT), Batch(SHORT, **settings)])


def test_batches_of_other_goals_and_options_are_joined_by_name():
    seen = {"observation": {"terms": ["situation"]}}
    batches = [Batch("table1", **seen), Batch("exploring", **seen), Batch("table1", knowledge="avoidance", **seen)]
    joined = begun(Joined(batches), [1, 2, 3])
    assert list(joined.options) == ["AvoidCollision", "ExplorationPatrol"]
    avoiding, exploring = joined.options.values()
    assert exploring == batches[1].options["ExplorationPatrol"]
    assert set(avoiding) == {name for batch in batches for name in batch.options["AvoidCollision"]}
    masks, row = joined.masks(), 0
    for batch in batches:
        able = {name for name, mask in zip((*avoiding, *exploring), masks[row], strict=True) if mask}
        first = {exploring[0]} if "ExplorationPatrol" not in batch.options else set()
        assert able == {name for names in batch.options.values() for name in names} | first
        assert (masks[row : row + batch.rows] == masks[row]).all()
        row += batch.rows
    wanted, held = ("Off", "Finds"), [batch.worlds.coordinators for batch in batches]
    joined.step(np.tile([avoiding.index(wanted[0]), exploring.index(wanted[1])], (joined.rows, 1)))
    for batch, coordinators, expected in zip(batches, held, ({}, {1: "Finds", 0: "Off"}, {0: "Off"}), strict=True):
        for coordinator in coordinators:
            goal = list(joined.options).index(coordinator.model.goal)
            options = coordinator.model.options
            default = options[int(np.argmax(coordinator.model.scores))]
            assert {options[k] for k in coordinator.held[: batch.rows]} == {expected.get(goal, default)}
    for wrong in (-1, len(avoiding)):
        with pytest.raises(ValueError, match=rf"options\[0\]: expected 0\.\.2, got {wrong}"):
            joined.step(np.full((joined.rows, 2), wrong))


def test_default_options_are_those_of_the_highest_scores():
    batches = [Batch(name, observation={"terms": ["situation"]}) for name in ("exploring", "transport")]
    joined = Joined(batches)
    defaults = [dict(zip(joined.options, row, strict=True)) for row in (joined.defaults()[0], joined.defaults()[-1])]
    for batch, numbers in zip(batches, defaults, strict=True):
        for (goal, names), best in zip(batch.options.items(), batch.choices.default, strict=True):
            assert joined.options[goal][numbers[goal]] == names[best]
