"""Learners learn from the excess, by which tables judge, and not from the cost that nobody could avoid."""

from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest

from clean_swarm_env.deciders.machines import FixedDecider
from tests.train.learning.trainings import job, written
from train.learning.config import load_training
from train.learning.es import EsTraining
from train.learning.training import LEAST_EXCESS, judged, score_of

UNAVOIDABLE = 20.0


def result(excess):
    return SimpleNamespace(cost_s=UNAVOIDABLE + excess, excess_s=excess)


def test_the_best_checkpoint_is_that_of_the_lowest_excess():
    still = {"still/cost_s": 100.0, "still/excess_s": 100.0}
    best = score_of(still | {"arrivals/cost_s": 22.0, "arrivals/excess_s": 2.0})
    worse = {"still/cost_s": 80.0, "still/excess_s": 80.0, "arrivals/cost_s": 24.0, "arrivals/excess_s": 4.0}
    assert score_of(worse) > best == pytest.approx(np.log([100.0, 2.0]).mean())  # its costs are lower, by the product
    assert score_of({}) is None


def test_members_are_compared_by_their_excess(tmp_path):
    def done(tasks):
        for task in tasks:
            for run in task.each():
                run.result.__dict__.update(cost_s=UNAVOIDABLE + 3.0, unavoidable_s=UNAVOIDABLE)
                yield run

    training = EsTraining(job(load_training(str(written(tmp_path, "es")), "es"), tmp_path / "run", done=done))
    scenario = next(training.curriculum.scenarios(0)[0])
    assert training.costs([partial(FixedDecider, 0)], [scenario])[0].tolist() == [[3.0]]


def test_an_excess_that_has_no_logarithm_is_the_least():
    assert judged(result(0.0)) == judged(result(-1e-12)) == LEAST_EXCESS
