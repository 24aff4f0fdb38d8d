"""Statistics against plain formulas and the paper's own figures."""

import statistics

import numpy as np
import pytest
import scipy.stats

from clean_swarm_env.config.load import load_experiment
from clean_swarm_env.config.mission import MissionConfig
from tests.train.records import experiment, record
from train.analysis.runs import Runs, distance_metrics
from train.analysis.statistics import summarise


def test_the_summary_of_the_papers_figures_is_the_papers_summary():
    reference = load_experiment("table1").reference
    assert reference is not None
    expected = {
        ("RepulsionFernandez-view2.0", "duration_s"): (846.72, 952.40, 465.39),
        ("RepulsionFernandez-view2.0", "collision_samples_per_s"): (1.70, 1.60, 0.38),
        ("RepulsionGradient-view1.5", "duration_s"): (266.43, 267.02, 130.32),
        ("RepulsionGradient-view1.5", "collision_samples_per_s"): (2.16, 2.08, 0.64),
    }
    for (condition, metric), figures in expected.items():
        summary = summarise(np.array(reference.figures[condition][metric]))
        assert (summary.mean, summary.median, summary.std) == pytest.approx(figures, abs=0.006)


def test_the_interval_of_a_mean_is_students():
    values = [3.0, 4.5, 8.0, 1.0]
    summary = summarise(np.array(values))
    half = scipy.stats.t.ppf(0.975, 3) * statistics.stdev(values) / 2.0
    assert summary.ci95 == pytest.approx((statistics.mean(values) - half, statistics.mean(values) + half))
    assert summary.std == pytest.approx(statistics.pstdev(values))


def test_figures_take_every_record_to_its_place():
    records = [record(s, c, 10.0 * k + int(s)) for k, c in enumerate(("a", "b")) for s in ("10", "2", "1")]
    mission = MissionConfig(collision_distances=(0.5, 1.0))
    names = {name: (name,) for name in ("b", "a")}
    runs = Runs(experiment(mission=mission), "", 3, (("1",), ("2",), ("10",)), names, records)
    assert {name: own.tolist() for name, own in runs.values("duration_s").items()} == {
        "b": [11.0, 12.0, 20.0],
        "a": [1.0, 2.0, 10.0],
    }
    for name, durations in runs.values("duration_s").items():
        of = {figure: own[name] for figure in runs.figures["1", "a"] for own in [runs.values(figure)]}
        assert of["collision_samples_per_s"].tolist() == of["samples_per_s_at_0.5m"].tolist()
        assert of["samples_per_s_at_1.0m"] == pytest.approx(durations / 5)
        assert of["events_per_s_at_1.0m"] == pytest.approx(durations / 50)
    assert distance_metrics([0.5, 1.0])[3] == "events_per_s_at_1.0m"
