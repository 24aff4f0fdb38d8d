"""The command behind docs/choosing.md: what is there is kept, tables say what runs say, and a lost claim is noticed."""

import json

import pytest

from clean_swarm_env.config.load import load_family
from docs.comparison import runs, write_choosing
from docs.comparison.manifest import Manifest
from docs.comparison.tables import Results
from selector.documents.find import load_file
from selector.documents.reading import read_mapping
from tests.train.learning.trainings import written
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
    assert list(tables) == ["main", "statistics", "learners", "looking", "ablations"]
    means = json.loads((folder / "random" / "summary.json").read_text())["strategies"]
    best, own = means[results.best["random"]]["excess_s"]["mean"], means["ES"]["excess_s"]["mean"]
    assert f"| {best:.1f} |" in tables["main"]
    assert f"{own / best:.3f}" in tables["main"]
    assert f"{own / best:.3f}" in tables["learners"]
    full, no_crowd, never_off, one_option = (
        json.loads((folder / name / "policy" / "policy.json").read_text())
        for name in ("ES-1", "no crowd-1", "never off-1", "one option-1")
    )
    assert set(full["observations"]) - set(no_crowd["observations"]) == {"crowd_1m", "crowd_1.5m", "crowd_2.5m"}
    assert set(full["options"]) - set(never_off["options"]) == {"Off"}
    assert one_option["options"] == ["ORCA"]
    assert means["one option"]["excess_s"]["mean"] == means["fixed:ORCA"]["excess_s"]["mean"]
    for label in manifest.ablations.of:
        assert f"{means[label]['excess_s']['mean'] / own:.3f}" in tables["ablations"]
    wrong = results.broken()
    rivals = {results.best["random"]: best} | {name: means[name]["excess_s"]["mean"] for name in ("MaxScore", "Random")}
    assert [line.split(" of ")[1].split(",")[0] for line in wrong] == [name for name in rivals if own >= rivals[name]]
    results.draw_curves(tmp_path / "curves.png")
    assert (tmp_path / "curves.png").stat().st_size > 10_000

    before = {file: file.read_bytes() for file in folder.glob("*/runs.csv")}
    times = (folder / runs.CPU_TIMES).read_bytes()
    runs.make(manifest, folder)
    assert {file: file.read_bytes() for file in folder.glob("*/runs.csv")} == before
    assert (folder / runs.CPU_TIMES).read_bytes() == times


@pytest.mark.parametrize("file", sorted(write_choosing.OWN.parent.glob("*.yaml")), ids=lambda file: file.stem)
def test_manifests_that_ship_name_what_there_is(file):
    manifest = Manifest(**read_mapping(file))
    assert (manifest.name, manifest.page) == (file.stem, file.stem != "learning")
    if manifest.page:
        page = (write_choosing.DOCS / f"{manifest.name}.md").read_text(encoding="utf-8")
        assert f"pictures/{manifest.name}.png" in page
        for label in manifest.learners:
            assert f"| `{label}` |" in page
    for learner in manifest.learners.values():
        config = load_file("training", learner.training, TrainingConfig)
        assert config.goal in (manifest.goal, None)
    for family in manifest.families:
        load_family(family)
