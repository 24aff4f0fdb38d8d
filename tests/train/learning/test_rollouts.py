"""Rollouts of robots that come and go, beside a naive list of each robot's decisions."""

import numpy as np
import pytest

pytest.importorskip("stable_baselines3")

import torch
from gymnasium.spaces import Box, Discrete, MultiDiscrete

from train.learning.ppo.rollouts import MomentsOfRobots, RobotRollouts

pytestmark = pytest.mark.extra

PERIODS, ROWS, GAMMA, TRACE = 7, 40, 0.9, 0.8
COUNTS, PARTS = (5, 3), torch.tensor([[0.25, 0.5]])  # options of two goals; logarithms of their probabilities


class Course:
    """What happens to rows in many periods: who works, whose decision counts, payments, ends of episodes, values."""

    def __init__(self, rollouts, *, working=0.8, effective=0.4, over=0.05):
        random, shape = np.random.default_rng(5), (rollouts * PERIODS + 1, ROWS)
        self.working, self.goals = random.random(shape) < working, random.random((*shape, 2)) < effective / 2
        self.effective = self.goals.any(axis=2)
        self.over, self.values = random.random(shape) < over, random.normal(size=shape).astype(np.float32)
        self.paid = random.normal(size=shape).astype(np.float32)

    def expected(self, row, periods):
        """Return period -> advantage and return of the decisions of a row within some periods, by definition."""
        counted = [t for t in range(periods) if self.working[t, row] and self.effective[t, row]]
        found = {}
        for t in reversed(counted):
            gain, after, now = 0.0, 1.0, t
            while True:
                gain, after = gain + after * self.paid[now, row], after * GAMMA
                ended = self.over[now, row] or (now + 1 < periods + 1 and not self.working[now + 1, row])
                now += 1
                if ended or now in counted or now == periods:
                    break
            if now == periods and not ended:
                continue  # what comes of it is not known yet
            value, advantage = (0.0, 0.0) if ended else (self.values[now, row], found.get(now, (0.0,))[0])
            difference = gain + after * value - self.values[t, row]
            found[t] = (
                difference + after * TRACE * advantage,
                difference + after * TRACE * advantage + self.values[t, row],
            )
        return found


def filled(course, rollouts):
    """Yield the buffer after each rollout of a course."""
    now = {"t": 0}
    buffer = RobotRollouts(
        PERIODS, Box(-1e9, 1e9, (10,)), MultiDiscrete(COUNTS), device="cpu", gae_lambda=TRACE, gamma=GAMMA,
        n_envs=ROWS, deciding=lambda: course.working[now["t"]], effective=lambda: course.goals[now["t"] - 1],
        parts=lambda: PARTS.expand(ROWS, -1), counts=COUNTS,
    )  # fmt: skip
    starts = np.ones(ROWS)
    for rollout in range(rollouts):
        buffer.reset()
        for t in range(rollout * PERIODS, (rollout + 1) * PERIODS):
            now["t"] = t + 1
            seen = np.hstack([np.full((ROWS, 1), t), np.arange(ROWS)[:, None], np.ones((ROWS, 8))])
            values, chances = torch.tensor(course.values[t]), torch.full((ROWS,), float(t))
            buffer.add(seen, np.tile([t % 5, t % 3], (ROWS, 1)), course.paid[t], starts, values, chances)
            starts = course.over[t]
        buffer.compute_returns_and_advantage(torch.full((ROWS, 1), 1e6), starts)
        yield buffer


def learned(buffer, course):
    """Return (period, row) -> advantage and return of what PPO gets, and check what stands beside it.

    A goal whose option had no effect could have had no other.
    """
    found = {}
    for batch in buffer.get(16):
        for seen, action, chance, advantage, gain in zip(
            batch.observations, batch.actions, batch.old_log_prob, batch.advantages, batch.returns, strict=True
        ):
            t, row = (int(number) for number in seen[:2])
            assert (t, row) not in found
            assert action.tolist() == [t % 5, t % 3]
            effective = course.goals[t, row]
            assert float(chance) == t - float((PARTS[0] * torch.tensor(~effective)).sum())
            for able, taken, counts in zip(seen[2:].split(COUNTS), action, effective, strict=True):
                assert able.tolist() == [1.0 if counts or k == taken else 0.0 for k in range(len(able))]
            found[t, row] = float(advantage), float(gain)
    return found


def test_a_decision_is_compared_with_the_next_that_counts_by_a_naive_list():
    rollouts = 6
    course, got = Course(rollouts), {}
    for number, buffer in enumerate(filled(course, rollouts)):
        own = learned(buffer, course)
        assert not own.keys() & got.keys()
        got |= own
        periods = (number + 1) * PERIODS
        known = {(t, row) for row in range(ROWS) for t in course.expected(row, periods)}
        assert set(got) == known  # each decision once, as soon as it is known what came of it
        for t, row in own:  # the trace ends with the last decision of the rollout
            np.testing.assert_allclose(own[t, row], course.expected(row, periods)[t], rtol=1e-4, atol=1e-4)
    assert len(got) > 300


def test_where_everybody_works_and_all_counts_advantages_are_those_of_stable_baselines3():
    from stable_baselines3.common.buffers import RolloutBuffer

    course = Course(1, working=2.0, effective=2.0)
    course.over[PERIODS - 1] = False  # the last decision waits, and its value is that of what follows
    (buffer,) = filled(course, 1)
    usual = RolloutBuffer(
        PERIODS - 1, Box(-1e9, 1e9, (2,)), Discrete(5), device="cpu", gae_lambda=TRACE, gamma=GAMMA, n_envs=ROWS
    )
    starts = np.ones(ROWS)
    for t in range(PERIODS - 1):
        usual.add(np.zeros((ROWS, 2)), np.zeros((ROWS, 1)), course.paid[t], starts, torch.tensor(course.values[t]),
                  torch.zeros(ROWS))  # fmt: skip
        starts = course.over[t]
    usual.compute_returns_and_advantage(torch.tensor(course.values[PERIODS - 1]), starts)
    assert buffer.known[1:-1].all()
    np.testing.assert_allclose(buffer.advantages[1:-1], usual.advantages, rtol=1e-5, atol=1e-5)


def test_what_waits_is_dropped_where_all_worlds_begin_anew():
    course = Course(2, working=2.0, effective=2.0, over=0.0)
    rollouts = filled(course, 2)
    first = next(rollouts)
    assert first.known.sum() == (PERIODS - 1) * ROWS
    course.over[PERIODS - 1] = True  # the worlds are reset before the next rollout
    second = next(rollouts)
    assert not second.known[0].any()
    assert second.known.sum() == (PERIODS - 1) * ROWS


def test_rows_without_a_robot_do_not_enter_the_moments():
    rows = np.array([True, False, True, False])
    moments = MomentsOfRobots(lambda: rows, (2,))
    moments.update(np.array([[1.0, 2.0], [0.0, 0.0], [3.0, 6.0], [0.0, 0.0]]))
    np.testing.assert_allclose(moments.mean, [2.0, 4.0], rtol=1e-4)
    rows[:] = False
    moments.update(np.zeros((4, 2)))
    np.testing.assert_allclose(moments.mean, [2.0, 4.0], rtol=1e-4)
