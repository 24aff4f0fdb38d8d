"""The command behind docs/choosing.md: what is there is kept, tables say what runs say, and a lost claim is noticed."""

import json
import shutil

import numpy as np
import pytest

from clean_swarm_env.config.load import load_family
from docs.comparison import runs, write_choosing
from docs.comparison.claims import family_runs
from docs.comparison.frequencies import frequencies_table
from docs.comparison.manifest import Manifest, Numbers
from docs.comparison.raced_numbers import Won, numbers_table, race_numbers
from docs.comparison.shuffled import ShuffledDecider
from docs.comparison.tables import Results
from selector.documents.find import load_file
from selector.documents.reading import read_mapping
from selector.knowledge import load_knowledge
from selector.strategies.policy_file import find_policy
from selector.strategies.problem import Problem
from tests.train.learning.trainings import written
from train.analysis.family_report import excesses_of
from train.analysis.intervals import Ratio
from train.deciders.decider import OptionDecider
from train.learning.config import TrainingConfig

TRIED = {
    "name": "tried",
    "goal": "AvoidCollision",
    "seeds": (3, 4),
    "race": {"searched": 2, "finalists": 2, "seed": 1},
    "families": {"random": {"scenarios": 2, "headroom": True, "told": {"free_far": "Off", "free_near": "ORCA"}}},
    "variants": {"three robots": {"family": "random", "robots": (3, 3), "loss": 0.5}},
}


@pytest.mark.long
@pytest.mark.extra
def test_the_tables_come_from_races_trainings_and_evaluations_which_are_kept(tmp_path):
    pytest.importorskip("torch")
    training = str(written(tmp_path, "ppo", validation={"scenarios": 1}))
    ablations = {"seeds": (1,), "families": ("random",), "knowledge": "avoidance"}
    ablations["of"] = {"never off": {"without": ("Off",), "changes": {"ppo": {"entropy": 0.0}}}}
    learners = {"one": {"training": training, "seeds": (1, 2)}, "other": {"training": training, "seeds": (3,)}}
    manifest = Manifest(**TRIED, learners=learners, rules={"hold": "MaxScore"}, ablations=ablations)
    folder = tmp_path / "results"
    runs.make(manifest, folder)
    results = Results(manifest, folder)
    tables = results.tables()
    assert list(tables) == ["main", "learners", "told", "variants", "ablations", "unfinished"]
    raced = json.loads((folder / "race-of-random" / "summary.json").read_text())["notes"]
    assert f"best single choice: {results.best['random']}" in raced
    found = [excesses_of(family_runs(folder / f"random-{seed}")) for seed in (3, 4)]
    mean = {label: np.mean([own[label].mean() for own in found]) for label in found[0]}
    best = mean[f"fixed:{results.best['random']}"]
    assert f"| {best:.1f} |" in tables["main"]
    for label, table in {
        "one": "main",
        "Random": "main",
        "other": "learners",
        "hold": "learners",
        "told": "told",
    }.items():
        assert f"{mean[label] / best:.3f}" in tables[table]
    assert f"{mean['never off'] / mean['one']:.3f}" in tables["ablations"]
    policy = json.loads((folder / "never off-1" / "policy" / "policy.json").read_text())
    assert "Off" not in policy["goals"]["AvoidCollision"]
    (lost,) = [line for line in results.broken() if line.startswith("not shown to be better than `other`")]
    assert "`random`" in lost
    assert "| `random` |" in frequencies_table(manifest, folder)

    before = {file: file.read_bytes() for file in folder.glob("*/runs.csv")}
    times = (folder / runs.CPU_TIMES).read_bytes()
    runs.make(manifest, folder)
    assert {file: file.read_bytes() for file in folder.glob("*/runs.csv")} == before
    assert (folder / runs.CPU_TIMES).read_bytes() == times


def trained(folder, **scores):
    """Write two trainings of a policy that ships, with these scores on validation scenarios."""
    for name, score in scores.items():
        shutil.copytree(find_policy("one"), folder / name / "policy")
        entry = {"decisions": 1, "score": score, "random/excess_s": 100.0 * score}
        lines = [json.dumps(entry | {"score": 9.0}), json.dumps(entry)]
        (folder / name / "history.jsonl").write_text("\n".join(lines))
    (folder / runs.CPU_TIMES).write_text(json.dumps(dict.fromkeys(scores, 60.0)))


def test_who_is_clearly_worse_goes_and_the_best_validation_goes_on(tmp_path, monkeypatch):
    trained(tmp_path, **{"one-1": 0.5, "one-2": 0.25})
    made = [tmp_path / name / "policy" for name in ("one-1", "one-2")]
    assert runs.preferred(made) == made[1]
    own = np.arange(10.0, 18.0)[None, :, None].repeat(2, axis=0)  # (trainings, scenarios, runs)
    noise = np.sin(np.arange(8.0))[None, :, None]
    found = {
        "one": own,
        "worse": 1.5 * own[:1] + noise,
        "alike": own[:1] + 4.0 * noise,
        "better": 0.5 * own[:1] + noise,
    }
    monkeypatch.setattr(runs, "family_runs", lambda folder: folder)
    monkeypatch.setattr(runs, "excesses_of", lambda folder: found)
    assert runs.clearly_worse(tmp_path, "one") == {"worse"}


@pytest.mark.long
def test_a_screening_drops_who_is_clearly_worse_and_only_the_training_of_the_best_validation_goes_on(tmp_path):
    trained(tmp_path, **{"one-1": 0.5, "one-2": 0.25})
    learners = {"one": {"training": "one", "seeds": (1, 2)}}
    given = {"families": {"random": {"scenarios": 2, "best": "ORCA"}}, "screening": {"scenarios": 8, "seed": 9}}
    rules = {"worse": "fixed:RepulsionFernandez-view2.0", "hold": "fixed:PredictiveSteering"}
    manifest = Manifest(**TRIED | given | {"variants": {}}, learners=learners, rules=rules)
    runs.make(manifest, tmp_path)
    screened = excesses_of(family_runs(tmp_path / "random-screening-9"))
    judged = excesses_of(family_runs(tmp_path / "random-3"))
    assert screened["one"].shape[:2] == (2, 8)
    assert {"one", "hold", "fixed:ORCA"} <= set(judged) < set(screened)
    assert {"worse", "Random", "fixed:Off"}.isdisjoint(judged)
    assert screened["worse"].mean() > screened["one"].mean()
    assert judged["one"].shape[:2] == (1, 2)
    assert runs.claimed_training(manifest, tmp_path) == tmp_path / "one-2" / "policy"
    tables = Results(manifest, tmp_path).tables()
    assert "| `one` / `worse` |  |  | - |" in tables["learners"]  # a screening chooses, and judges nobody
    assert "| `random` | 37.5 | 37.5 | 25.0 | 50.0 |" in tables["trainings"]


@pytest.mark.long
def test_numbers_are_raced_among_the_options_that_ship(tmp_path):
    tried = {"AvoidCollision": {"ORCA": {"distance": (0.9,)}}}
    sizes = {"searched": 2, "finalists": 2, "seed": 1, "confirmed": 2, "fresh": 2}
    numbers = Numbers(**sizes, held={"AvoidCollision": "ORCA"}, tried=tried, families=("random",))
    (won,) = race_numbers(numbers, tmp_path, "random", "AvoidCollision").values()
    raced = (tmp_path / "numbers-of-random-AvoidCollision" / "runs.jsonl").read_text()
    assert "ORCA-distance0.9" in raced
    library = {option.name for option in load_knowledge("avoidance").options("AvoidCollision")}
    assert won.known in library
    assert won.best in {*library, "ORCA-distance0.9"}


def test_a_variant_counts_if_fresh_scenarios_show_it_to_be_better():
    known = np.arange(10.0, 30.0)
    better, alike = Ratio.of(0.8 * known + np.sin(known), known), Ratio.of(known + 5.0 * np.sin(known), known)
    assert Won("ORCA", "ORCA-distance0.9", better).option == "ORCA-distance0.9"
    assert Won("ORCA", "ORCA-distance0.9", alike).option == Won("ORCA", "ORCA", None).option == "ORCA"
    table = numbers_table({"random": {"AvoidCollision": Won("ORCA", "ORCA-distance0.9", better)}})
    assert f"**{better.ratio:.3f} [" in table


def test_a_race_tells_the_options_of_each_kind(tmp_path):
    manifest = Manifest(
        **TRIED | {"families": {"rare": {"scenarios": 2, "headroom": True}}, "variants": {}}, learners=LEARNERS
    )
    notes = ["best single choice: ORCA+Patrol", "best choices: spots 0 ORCA+Patrol, spots 1 Off+Finds"]
    (tmp_path / "race-of-rare").mkdir()
    (tmp_path / "race-of-rare" / "summary.json").write_text(json.dumps({"notes": notes}))
    found = runs.raced(manifest, tmp_path, "rare")
    assert found == runs.Raced("ORCA+Patrol", {"spots 0": "ORCA+Patrol", "spots 1": "Off+Finds"})


LEARNERS = {"one": {"training": "one", "seeds": (1,)}}


def test_shuffled_observations_change_places_within_teams_and_rows_without_robot_keep_theirs():
    class Seen(OptionDecider):
        def _choose(self, observations):
            self.seen = observations.copy()
            return np.zeros(len(observations), dtype=np.int64)

    teams = np.array([0, 0, 0, 0, 1, 1, 1, 1])
    own = np.array([1.0, 2.0, 3.0, 0.0, 5.0, 6.0, 7.0, 8.0], dtype=np.float32)[:, None]
    decider = Seen(Problem("Goal", ("only",), np.zeros(1), ("number",)), teams)
    shuffled = ShuffledDecider(decider, teams)
    for team in (0, 1):
        shuffled.reset(np.flatnonzero(teams == team), seed=team)
    orders = []
    for _ in range(20):
        shuffled.decide(own)
        orders.append(decider.seen[:, 0].tolist())
        assert sorted(orders[-1][:3]) == [1.0, 2.0, 3.0]
        assert orders[-1][3] == 0.0
        assert sorted(orders[-1][4:]) == [5.0, 6.0, 7.0, 8.0]
    assert len({tuple(order) for order in orders}) > 10


@pytest.mark.parametrize("file", [write_choosing.OWN.with_name(f"{name}.yaml") for name in ("choosing", "learning")])
def test_manifests_that_ship_name_what_there_is(file):
    manifest = Manifest(**read_mapping(file))
    assert manifest.name == file.stem
    if manifest.page:
        page = (write_choosing.DOCS / f"{manifest.name}.md").read_text(encoding="utf-8")
        for label in manifest.learners:
            assert f"| `{label}` |" in page
    for learner in manifest.learners.values():
        assert load_file("training", learner.training, TrainingConfig).validation.scenarios
        assert set(learner.families) <= set(manifest.families)
    for family in (*manifest.families, *(variant.family for variant in manifest.variants.values())):
        load_family(family)
