"""The command behind docs/choosing.md: what is there is kept, tables say what runs say, and a lost claim is noticed."""

import json
from pathlib import Path

import numpy as np
import pytest

import docs.comparison.pairs
from clean_swarm_env.config.load import load_family
from docs.comparison import runs, write_choosing
from docs.comparison.manifest import Manifest
from docs.comparison.tables import Results
from selector.documents.find import load_file
from selector.documents.reading import read_mapping
from tests.train.learning.trainings import written
from train.analysis.family_report import excesses_of
from train.evaluation.claims import family_runs
from train.learning.config import TrainingConfig


def test_the_tables_come_from_trainings_and_evaluations_which_are_kept(tmp_path, monkeypatch):
    training = written(tmp_path, "es", validation={"scenarios": 1})
    manifest = Manifest(
        name="tried",
        goal="AvoidCollision",
        knowledge="avoidance",
        learners={"ES": {"training": str(training), "seeds": (1, 2)}},
        families={"random": {"scenarios": 2, "looked_ahead": 2}},
        rule="MaxScore",
        ablations={
            "seeds": (1,),
            "of": {
                "no crowd": {"changes": {"observation": {"terms": ["situation"]}}},
                "never off": {"without": "Off"},
                "one option": {"learner": "ES", "only": "ORCA"},
            },
        },
    )
    folder = tmp_path / "results"
    runs.make(manifest, folder)
    results = Results(manifest, folder)
    tables = results.tables()
    assert list(tables) == ["main", "limits", "statistics", "learners", "looking", "ablations"]
    means = json.loads((folder / "random" / "summary.json").read_text())["strategies"]
    best_fixed, excesses = results.best["random"], excesses_of(family_runs(folder / "random"))
    judged = [excesses[label][0, k, 0] for k, label in enumerate(best_fixed.labels)]  # the other one chose
    best, own = float(np.mean(judged)), means["ES"]["excess_s"]["mean"]
    assert "| best fixed | 0% |" in tables["limits"]
    assert f"| {best:.1f} |" in tables["main"]
    assert f"{own / best:.3f}" in tables["main"]
    assert f"{own / best:.3f}" in tables["learners"]
    full, no_crowd, never_off, one_option = (
        json.loads((folder / name / "policy" / "policy.json").read_text())
        for name in ("ES-1", "no crowd-1", "never off-1", "one option-1")
    )
    assert set(full["observations"]) - set(no_crowd["observations"]) == {"crowd_1m", "crowd_1.5m", "crowd_2.5m"}
    goal = "AvoidCollision"
    assert set(full["goals"][goal]) - set(never_off["goals"][goal]) == {"Off"}
    assert one_option["goals"] == {goal: ["ORCA"]}
    assert means["one option"]["excess_s"]["mean"] == means["fixed:ORCA"]["excess_s"]["mean"]
    for label in manifest.ablations.of:
        assert f"{means[label]['excess_s']['mean'] / own:.3f}" in tables["ablations"]
    wrong = results.broken()
    rivals = {best_fixed.label: best} | {name: means[name]["excess_s"]["mean"] for name in ("MaxScore", "Random")}
    assert [line.split(" of ")[1].split(",")[0] for line in wrong] == [name for name in rivals if own >= rivals[name]]
    results.draw_curves(tmp_path / "curves.png")
    assert (tmp_path / "curves.png").stat().st_size > 10_000

    before = {file: file.read_bytes() for file in folder.glob("*/runs.csv")}
    times = (folder / runs.CPU_TIMES).read_bytes()
    runs.make(manifest, folder)
    assert {file: file.read_bytes() for file in folder.glob("*/runs.csv")} == before
    assert (folder / runs.CPU_TIMES).read_bytes() == times


def test_strategies_are_judged_beside_the_best_pair_of_options_on_all_seeds(tmp_path, monkeypatch):
    asked, excess = [], {"ORCA": {"fixed:Patrol": 4.0, "Random": 8.0}, "Off": {"Random": 20.0}}
    judged = {"strategies": {"Random": ("ORCA", "Off")}, "seeds": (3, 4)}
    judged["families"] = {"rare": {"best": "ORCA+Patrol", "scenarios": 10}}
    manifest = Manifest(
        name="tried",
        goal="ExplorationPatrol",
        knowledge="exploring",
        learners={"ES": {"training": "exploring", "seeds": (1,)}},
        families={"rare": {"scenarios": 10}},
        pairs={"goal": "AvoidCollision", **judged},
    )
    monkeypatch.setattr(runs, "run", lambda *words: asked.append(list(map(str, words))))
    runs._pair(tmp_path, manifest, manifest.pairs)
    named = {Path(words[-2]).name: words for words in asked}
    assert list(named) == ["rare-ORCA-3", "rare-ORCA-4", "rare-Off-3", "rare-Off-4"]
    assert named["rare-Off-4"].count("--strategy") == 1
    assert {"fixed:Patrol", "Random", "3"} <= set(named["rare-ORCA-3"])
    (serves,) = read_mapping(tmp_path / "Off.knowledge.yaml")["goals"]["AvoidCollision"]
    assert serves["name"] == "Off"

    def measured(folder):
        _, option, seed = folder.name.split("-")
        spread = np.linspace(-1.0, 1.0, 10)[None, :, None]
        return {label: mean + spread + int(seed) - 3.5 for label, mean in excess[option].items()}

    monkeypatch.setattr(docs.comparison.pairs, "family_runs", lambda folder: folder)
    monkeypatch.setattr(docs.comparison.pairs, "excesses_of", measured)
    table = docs.comparison.pairs.pairs_table(manifest.pairs, tmp_path, lambda claim: f"{claim.ratio:.2f}")
    assert "| `rare` | ORCA, Patrol | 4.0 | 2.00 | 5.00 |" in table


@pytest.mark.parametrize("file", [write_choosing.OWN.with_name(f"{name}.yaml") for name in ("choosing", "learning")])
def test_manifests_that_ship_name_what_there_is(file):
    manifest = Manifest(**read_mapping(file))
    assert (manifest.name, manifest.page) == (file.stem, file.stem != "learning")
    if manifest.page:
        page = (write_choosing.DOCS / f"{manifest.name}.md").read_text(encoding="utf-8")
        assert (f"pictures/{manifest.name}.png" in page) == manifest.drawn
        for label in manifest.learners:
            assert f"| `{label}` |" in page
    for learner in manifest.learners.values():
        config = load_file("training", learner.training, TrainingConfig)
        assert config.goal in (manifest.goal, None)
    for family in manifest.families:
        load_family(family)
