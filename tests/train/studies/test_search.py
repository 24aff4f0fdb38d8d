"""The methods find a planted optimum through noise, which random search does not."""

from typing import get_args

import numpy as np
import pytest

from clean_swarm_env.config.known import knowledge_of
from clean_swarm_env.config.load import load_family
from selector.documents.errors import DocumentError
from selector.documents.find import load_file
from train.running.engine import in_turn
from train.running.finished_runs import Results
from train.running.run_folder import RunFolder
from train.studies.config import Method, StudyConfig

pytest.importorskip("optuna", reason="optuna is not installed (extra tune)")

from tests.train.studies.synthetic import regret, synthetic
from train.studies.missions import Candidate, MissionField
from train.studies.search import CandidateSearch
from train.studies.space import StudySpace

pytestmark = pytest.mark.extra


def search_of(configs, folder, make=synthetic, **changes):
    """Return the search of a study without missions, and its field."""
    study = load_file("studies", "planted", StudyConfig, [configs]).model_copy(update=changes)
    family = load_family("small", [configs])
    space = StudySpace(study, knowledge_of(family.mission, [configs]), (configs,))
    results = Results(RunFolder(folder, {"identity": {}}, resume=False))
    field = MissionField(make, results, in_turn, family.mission)
    return CandidateSearch(study, space, field, Candidate("unchanged", space.unchanged())), field


def planted_regret(configs, folder, method, seed):
    """Return the regret of the winner after 60 trials, and how many missions they took."""
    search, field = search_of(configs, folder, trials=60)
    arm = search.arm(method, seed, lambda trials: None)
    assert len(arm.trials) == 60
    return regret(search.winner(arm).goals["AvoidCollision"][0]), len(field.results.runs)


@pytest.mark.long
@pytest.mark.parametrize("method", ["TPE", "CMA-ES"])
def test_a_planted_optimum_is_found(configs, tmp_path, method):
    found = [planted_regret(configs, tmp_path / str(seed), method, seed) for seed in range(10)]
    assert sum(regret < 0.05 for regret, _ in found) >= 9
    assert all(missions <= 0.6 * 60 * 50 for _, missions in found)  # races spare the others


@pytest.mark.parametrize("method", get_args(Method))
def test_every_method_stays_in_the_space_and_repeats_itself(configs, tmp_path, method):
    found = []
    for number, seed in enumerate((1, 1, 2)):
        search, _ = search_of(configs, tmp_path / str(number), method=method, trials=15)
        found.append([trial.candidate.values for trial in search.arm(method, seed, lambda trials: None).trials])
    assert found[0] == found[1] != found[2]
    low, high = np.array([(0.1, 0.001, 0.2), (2.5, 1.0, 5.0)])
    assert ((np.array(found[0]) >= low) & (np.array(found[0]) <= high)).all()


def test_what_the_library_refuses_is_a_trial_that_failed(configs, tmp_path, monkeypatch):
    def far(space, goals):
        return "too far" if goals["AvoidCollision"][0]["parameters"]["view_distance"] > 1.2 else ""

    search, _ = search_of(configs, tmp_path / "some", trials=12)
    monkeypatch.setattr(StudySpace, "mistake", far)
    arm = search.arm("TPE", 0, lambda trials: None)
    assert {bool(trial.means) for trial in arm.trials} == {True, False}
    assert all(bool(trial.means) == (trial.candidate.values[0] <= 1.2) for trial in arm.trials)
    monkeypatch.setattr(StudySpace, "mistake", lambda space, goals: "never")
    with pytest.raises(DocumentError, match="planted: TPE: the library refused all 12 candidates"):
        search.arm("TPE", 0, lambda trials: None)
