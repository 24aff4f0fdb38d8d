"""Trainings, families, policies and learned strategies of one's own are found by name in the directories given."""

import shutil

import pytest
import yaml
from rich.console import Console

from clean_swarm_env.learning import warm_up
from selector.documents.errors import DocumentError
from selector.documents.find import find_file
from selector.strategies.policy_file import find_policy
from tests.paths import TRAINED
from tests.train.learning.trainings import written
from train.evaluation.comparing import Comparing
from train.learning import session
from train.learning.bandit import BanditTraining
from train.learning.config import load_training
from train.request import Request

FAMILY = {
    "name": "small",
    "description": "Two to four robots and three items.",
    "mission": {"base": "tiny", "knowledge": "avoidance", "time_limit": 20.0},
    "robots": [2, 4],
    "items": [3, 3],
}


@pytest.fixture
def own(tmp_path):
    """A directory with a mission, a family, a training on it, a policy and a learned strategy."""
    directory = tmp_path / "own"
    for kind in ("missions", "families", "training", "policies", "strategies"):
        (directory / kind).mkdir(parents=True)
    (directory / "missions" / "tiny.yaml").write_text("{task: {garbage: {count: 3}}}")
    (directory / "families" / "small.yaml").write_text(yaml.safe_dump(FAMILY))
    changes = {"tasks": [{"family": "small", "worlds": 2}], "checkpoints": 1, "decisions": 20}
    written(directory / "training", "bandit", **changes).rename(directory / "training" / "mine.yaml")
    shutil.copytree(find_policy("general", (TRAINED,)), directory / "policies" / "mine")
    shutil.copy(find_file("strategies", "rules", (TRAINED,)), directory / "strategies" / "mine.safetensors")
    return directory


def test_a_training_of_ones_own_is_done_and_says_once_that_it_compiles(own, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(warm_up, "compiled_before", lambda: False)
    monkeypatch.setattr(warm_up, "_checked", [])
    request = Request("mine", seed=1, output=tmp_path / "t", directories=(own,))
    assert session.run_training("bandit", request, BanditTraining, Console(quiet=True)) == session.FINISHED
    assert capsys.readouterr().err.count(warm_up.COMPILING) == 1
    assert (tmp_path / "t" / "strategy.safetensors").is_file()
    with pytest.raises(DocumentError, match="unknown training 'mine'"):
        load_training("mine", "bandit")


def test_policies_and_strategies_of_ones_own_take_part(own):
    request = Request("small", ("policy:mine", "learned:mine"), 0, 1, directories=(own,))
    evaluation = Comparing(request)
    kept = evaluation.manifest["identity"]["conditions"]
    own_and_others = ["policy:mine", "learned:mine", "fixed:Off", "Random"]
    assert [kept[name]["members"][0].split()[0] for name in kept] == own_and_others
    records = [record for task in evaluation.tasks(set()) for record in task.run()]
    assert [record.condition for record in records] == own_and_others
    with pytest.raises(DocumentError, match="unknown mission, family, experiment or task 'small'"):
        Comparing(Request("small", ("policy:mine",), 0, 1))


def test_a_training_whose_configuration_is_wrong_leaves_no_directory(own, tmp_path):
    written(own / "training", "bandit", bandit={"strategy": {"name": "UCB1"}, "context": ["weather"]})
    request = Request("bandit", seed=1, output=tmp_path / "t", directories=(own,))
    with pytest.raises(DocumentError, match="weather"):
        session.run_training("bandit", request, BanditTraining, Console(quiet=True))
    assert not (tmp_path / "t").exists()
