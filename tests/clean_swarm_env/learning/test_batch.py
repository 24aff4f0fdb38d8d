"""The batch: whole trajectories beside the world alone, ends of missions, statistics, wrong use."""

import numpy as np
import pytest

from clean_swarm_env.config.starts import random_start
from clean_swarm_env.learning.batch import Batch
from tests.clean_swarm_env.courses import begun, long_course, mission


def short(**changes):
    """Return missions that end soon, some completed and some not."""
    return mission(garbage={"count": 2}, **{"time_limit": 50.0, **changes})


def policy(seed: int, episode: int, step: int, robots: int) -> np.ndarray:
    """Return options (N,) that depend only on the state of the world."""
    return np.random.default_rng((seed, episode, step)).integers(0, 3, robots)


def trajectory(batch: Batch, seeds: list[int], steps: int) -> list[list[tuple]]:
    """Return the course of each world of the batch, step by step, as bytes."""
    worlds, robots = batch.worlds.worlds, batch.robots
    observations = batch.reset(seeds)
    courses = [[observations[batch.worlds.rows_of(w)].tobytes()] for w in range(worlds)]
    episodes, ages = [0] * worlds, [0] * worlds
    for _ in range(steps):
        options = np.concatenate([policy(seeds[w], episodes[w], ages[w], robots) for w in range(worlds)])
        step = batch.step(options)
        ends = {end.world: end for end in batch.finished}
        for w in range(worlds):
            rows = batch.worlds.rows_of(w)
            over = bool(step.terminated[w] or step.truncated[w])
            assert over == (w in ends)
            ages[w] += 1
            final = ()
            if over:
                final = (step.final_observations[rows].tobytes(), ends[w].scenario, ends[w].result)
                assert ends[w].scenario.id.rpartition("-")[2] == str(episodes[w] + 1)
                episodes[w], ages[w] = episodes[w] + 1, 0
            courses[w].append(
                (
                    step.observations[rows].tobytes(), step.rewards[rows].tobytes(), step.terminated[w],
                    step.truncated[w], batch.progress.events[:, rows].tobytes(),
                    batch.worlds.physics.positions[rows].tobytes(), final,
                )
            )  # fmt: skip
    return courses


@long_course
@pytest.mark.parametrize("name", ["table1", "reference"])
def test_a_world_of_a_batch_goes_through_what_it_goes_through_alone(name):
    config = short().model_copy(update={"world": mission(name).world})
    alone = [trajectory(Batch(config), [seed], 300)[0] for seed in (5, 6, 7)]
    batch = trajectory(Batch(config, 3), [5, 6, 7], 300)
    assert alone == batch
    ends = [step[-1] for course in alone for step in course[1:] if step[-1]]
    assert {result.completed for _, _, result in ends} == {True, False}
    assert len({scenario.id for _, scenario, _ in ends}) > 2
    assert batch[0] != batch[1]


@long_course
def test_seeds_begin_the_series_anew_and_without_them_it_goes_on():
    batch = Batch(short(), 2)
    first = trajectory(batch, [5, 6], 40)
    assert trajectory(batch, [5, 6], 40) == first
    assert trajectory(batch, [6, 5], 40) == first[::-1]
    begun = batch.reset([5, 6]).copy()
    later = batch.reset().copy()
    assert not np.array_equal(begun, later)
    batch.reset([5, None])
    assert batch.reset([5, None])[:5].tobytes() == begun[:5].tobytes()


def test_without_seeds_every_batch_is_another():
    assert not np.array_equal(Batch(short()).reset(), Batch(short()).reset())


@long_course
def test_statistics_of_a_finished_mission_are_what_was_counted_on_the_way():
    batch = begun(Batch(short(), 3), [1, 2, 3])
    events, seconds, ends = np.zeros((6, batch.rows)), np.zeros(3), 0
    paid, steps = np.zeros(batch.rows), np.zeros(3, dtype=np.int64)
    for _ in range(250):
        step = batch.step(np.zeros(batch.rows, dtype=np.int64))
        events += batch.progress.events
        seconds += batch.progress.ticks * batch.worlds.period
        paid, steps = paid + step.rewards, steps + 1
        for end in batch.finished:
            rows = batch.worlds.rows_of(end.world)
            result = end.result
            assert seconds[end.world] == pytest.approx(result.ticks * 0.2)
            assert events[2, rows].sum() == result.garbage_done
            assert events[0, rows].sum() >= events[1, rows].sum() >= events[2, rows].sum()
            assert events[3, rows].sum() / 2 == pytest.approx(result.collision_events_per_s[0] * result.ticks * 0.2)
            assert result.completed == step.terminated[end.world] == (not step.truncated[end.world])
            assert (end.returns, end.steps) == (paid[rows].tolist(), steps[end.world])
            events[:, rows], seconds[end.world] = 0.0, 0.0
            paid[rows], steps[end.world] = 0.0, 0
            ends += 1
    assert ends > 6


def test_without_beginning_anew_a_world_stays_at_its_end_and_counts_no_more():
    batch = begun(Batch(short(time_limit=2.4), 2, begin_anew=False), [1, 2])
    options = np.zeros(batch.rows, dtype=np.int64)
    for _ in range(3):
        last = batch.step(options)
    assert last.truncated.tolist() == [True, True]
    assert [end.world for end in batch.finished] == [0, 1]
    assert batch.progress.elapsed.tolist() == [12, 12]
    seen = last.observations.copy()
    again = batch.step(options)
    assert again.truncated.tolist() == [True, True]
    assert batch.finished == ()
    assert not again.rewards.any()
    assert np.array_equal(again.observations, seen)


def test_a_start_can_be_given():
    batch = begun(Batch(short(), 2), [1, 2], [random_start(short(), 77, 4)] * 2)
    positions = batch.worlds.physics.positions
    assert np.array_equal(positions[:5], positions[5:])


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        (lambda batch: Batch(short()).step(np.zeros(5, dtype=np.int64)), RuntimeError, "call reset first"),
        (lambda batch: batch.reset([1, 2, 3]), ValueError, "seeds: expected one for each of 2 worlds, got 3"),
        (
            lambda batch: batch.step(np.zeros(9, dtype=np.int64)),
            ValueError,
            r"options: expected shape \(10, 1\), got \(9,\)",
        ),
        (lambda batch: batch.step(np.full(10, 3)), ValueError, r"options\[0\]: expected 0\.\.2, got 3"),
        (lambda batch: Batch(famly="crowded"), TypeError, "unknown setting 'famly' .* did you mean 'family'"),
    ],
)
def test_wrong_use_is_an_error_that_says_what_was_expected(call, error, message):
    with pytest.raises(error, match=message):
        call(begun(Batch(short(), 2), [1, 2]))


@long_course
@pytest.mark.parametrize("family", ["shifting", "random"])
def test_episodes_may_be_the_scenarios_of_a_family(family):
    """Teams and garbage change: a world is the same alone and in a batch, and absent robots see and get nothing."""
    alone = trajectory(Batch(family=family, knowledge="avoidance"), [5], 60)[0]
    batch = Batch(family=family, knowledge="avoidance", worlds=3)
    assert trajectory(batch, [4, 5, 6], 60)[1] == alone
    assert len(batch.options["AvoidCollision"]) == 10
    step = batch.step(np.zeros(batch.rows, dtype=np.int64))
    absent = ~batch.progress.took_part
    assert family == "random" or absent.any()
    assert not step.rewards[absent].any()
    assert not step.observations[~batch.working].any()


def test_splits_of_a_family_have_other_scenarios_and_unfit_families_are_refused():
    first, second = (Batch(family="crowded", split=split).reset([1]).tobytes() for split in ("train", "test"))
    assert first != second
    assert Batch("crowded").reset([1]).tobytes() == first, "a family's name does in place of a mission's"
    for size in (None, (9.0, 9.0)):
        with pytest.raises(ValueError, match=r"size: expected one of .* 'unseen', \(8.0, 8.0\), .*, got"):
            Batch(family="unseen", size=size)
