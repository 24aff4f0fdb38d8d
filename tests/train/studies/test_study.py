"""Whole studies: the same trials and knowledge whatever happens, marks, storage, store and errors."""

import json
import shutil

import pytest
from rich.console import Console

pytest.importorskip("optuna", reason="optuna is not installed (extra tune)")

from clean_swarm_env.config.types import ConfigurationError
from selector.documents.find import load_file
from selector.knowledge import load_knowledge
from selector.store import KnowledgeStore
from tests.train.studies.synthetic import SyntheticTask, regret, synthetic
from train.memory import StoreRequest
from train.request import Request
from train.running.commands import FINISHED, INTERRUPTED
from train.running.needs import Machine
from train.studies.config import StudyConfig
from train.studies.study import run_study

pytestmark = pytest.mark.extra

CONSOLE = Console(quiet=True)
SAME = ("trials.csv", "summary.json", "table.md", "knowledge/planted.yaml")


def request_of(configs, output, **more):
    words = ("clean-swarm", "tune", "planted", "--seed", "3")
    return Request("planted", seed=3, output=output, directories=(configs,), words=words, **more)


def studied(request, make, **changes):
    """Do the planted study with some changes; return the exit code."""
    study = load_file("studies", "planted", StudyConfig, request.directories).model_copy(update=changes)
    return run_study(study, request, CONSOLE, make)


def contents(folder):
    return {name: (folder / name).read_bytes() for name in SAME}


@pytest.fixture(scope="module")
def whole(configs, tmp_path_factory):
    """The directory of a study that nothing disturbed."""
    folder = tmp_path_factory.mktemp("whole") / "results"
    assert studied(request_of(configs, folder), synthetic) == FINISHED
    return folder


@pytest.mark.long
def test_four_workers_come_to_the_same(configs, tmp_path, whole):
    request = request_of(configs, tmp_path / "four", machine=Machine(4))
    assert studied(request, synthetic) == FINISHED
    assert contents(tmp_path / "four") == contents(whole)


class Stopping(SyntheticTask):
    """A task during which the user presses Ctrl-C."""

    def each(self):
        yield from list(super().each())[:4]
        raise KeyboardInterrupt


def test_an_interrupted_study_goes_on_where_it_was(configs, tmp_path, whole, capsys):
    folder, log, stops = tmp_path / "stopped", tmp_path / "log", {"TPE-9", "random-3"}

    def make(stage, candidate, numbers):
        kind = Stopping if candidate.name in stops else SyntheticTask
        stops.discard(candidate.name)
        return kind(stage, candidate.name, regret(candidate.goals["AvoidCollision"][0]), numbers, str(log))

    assert studied(request_of(configs, folder), make) == INTERRUPTED
    assert "to go on:\n  clean-swarm tune planted --seed 3" in capsys.readouterr().err
    assert studied(request_of(configs, folder, resume=True), make) == INTERRUPTED
    assert studied(request_of(configs, folder, resume=True), make) == FINISHED
    assert contents(folder) == contents(whole)
    missions = log.read_text().splitlines()
    assert len(missions) - len(set(missions)) == 2 * 6  # of ten missions of each stopped task four were kept


@pytest.mark.parametrize("share", [0.01, 0.4, 0.9])
def test_a_killed_study_goes_on_where_it_was(configs, tmp_path, whole, share):
    killed = tmp_path / "killed"
    shutil.copytree(whole, killed)
    journal = killed / "missions.jsonl"
    kept = journal.read_text()
    journal.write_text(kept[: int(share * len(kept))])  # as a kill leaves it, in the middle of a line
    for name in SAME:
        (killed / name).unlink()
    assert studied(request_of(configs, killed, resume=True), synthetic) == FINISHED
    assert contents(killed) == contents(whole)
    assert sorted(journal.read_text().splitlines()) == sorted(kept.splitlines())


def test_the_result_is_knowledge_with_scores_and_their_source(configs, tmp_path, whole):
    store, folder = tmp_path / "store.sqlite", tmp_path / "kept"
    shutil.copytree(whole, folder)
    for _ in range(2):  # nothing counts twice
        request = request_of(configs, folder, resume=True, store=StoreRequest(str(store), learn=True))
        assert studied(request, synthetic) == FINISHED
    known = load_knowledge("planted", [folder])
    assert [option.name for option in known.options("AvoidCollision")] == ["planted", "Near", "Off"]
    assert known.rewards("AvoidCollision")[0].tolist() == [40.0] * 3
    assert known.scores("AvoidCollision") == pytest.approx(known.rewards("AvoidCollision")[1], abs=1e-6)
    learned = KnowledgeStore(store, create=False).contents().learned
    assert {(key.option, key.context, key.source) for key in learned} == {
        (name, "mission small", "study planted, seed 3") for name in ("planted", "Near", "Off")
    }
    assert all(entry.count == 40 for entry in learned.values())


def test_a_result_that_beats_neither_off_nor_random_search_is_marked(configs, tmp_path):
    def flat(stage, candidate, numbers):
        return SyntheticTask(stage, candidate.name, 0.0, numbers)

    assert studied(request_of(configs, tmp_path / "flat"), flat) == FINISHED
    assert "NOT SHOWN TO BEAT Off AND random search" in load_text(tmp_path / "flat")
    result = json.loads((tmp_path / "flat" / "summary.json").read_text())["result"]
    assert result["not_shown_to_beat"] == ["Off", "random search"]

    def good(stage, candidate, numbers):
        return SyntheticTask(stage, candidate.name, 0.0 if "TPE" in candidate.name else 0.5, numbers)

    assert studied(request_of(configs, tmp_path / "good"), good) == FINISHED
    assert "NOT SHOWN" not in load_text(tmp_path / "good")


def load_text(folder):
    return " ".join((folder / "knowledge" / "planted.yaml").read_text().split())


def test_a_kept_mission_of_another_study_is_refused_in_one_line(configs, tmp_path, whole):
    folder = tmp_path / "damaged"
    shutil.copytree(whole, folder)
    journal = folder / "missions.jsonl"
    kept = journal.read_text().splitlines()
    for key, value in {
        "seed": 4,
        "experiment": "large",
        "condition": "race - TPE-1",
        "counts": {},
        "ticks": -1,
    }.items():
        journal.write_text("\n".join([*kept[:-1], json.dumps({**json.loads(kept[-1]), key: value})]) + "\n")
        with pytest.raises(ConfigurationError, match=rf"missions\.jsonl: line {len(kept)}: .*expected"):
            studied(request_of(configs, folder, resume=True), synthetic)


def test_missions_of_the_world_give_an_option_its_costs(configs, tmp_path):
    folder = tmp_path / "real"
    assert studied(request_of(configs, folder, machine=Machine(1)), None, trials=4, method="random") == FINISHED
    summary = json.loads((folder / "summary.json").read_text())
    off = next(one for one in summary["yardsticks"] if one["name"] == "Off")
    assert off["figures"]["avoiding"]["mean"] == 0.0
    assert 0.0 < off["figures"]["cost_s"]["mean"] <= 200.0
    assert load_knowledge("planted", [folder]).options("AvoidCollision")[0].name == "planted"
