"""What a decider thinks, as a knowledge file with scores by situation, which MaxScore uses."""

import csv

import pytest
import yaml

from selector.documents.reading import read_mapping
from selector.knowledge import load_knowledge
from tests.paths import ROOT
from tests.selector.strategies.policies import exported
from tests.train.commands import told

GOAL = "ExplorationPatrol"
FINDS = "finds_none,finds_apart,finds_together"
SMALL = {
    "name": "small",
    "description": "Spots in a short mission.",
    "mission": {"base": "exploring", "time_limit": 60.0, "world": {"width": 12.0, "height": 12.0}, "task":
                {"garbage": {"count": 8}, "stations": {"recycling": [3.0, 6.0], "dump": [9.0, 6.0]}}},
    "robots": [3, 4],
    "items": [8, 8],
    "spots": [0, 1],
}  # fmt: skip


@pytest.fixture
def run(monkeypatch, capsys, tmp_path):
    """Run the command line in a directory with a family and a directory of knowledge: code, output, errors."""
    monkeypatch.chdir(tmp_path)
    for kind in ("families", "knowledge"):
        (tmp_path / "my" / kind).mkdir(parents=True)
    (tmp_path / "my" / "families" / "small.yaml").write_text(yaml.safe_dump(SMALL))
    return lambda *words: told(capsys, *words, "--configs", "my")


def write(run, decider, output="my/knowledge/thoughts.yaml", family="small", situations=FINDS, more=()):
    words = ("learn", "knowledge", "from-policy", decider, output, "--family", family, "--situations", situations)
    return run(*words, "--scenarios", 3, *more)


def figures(directory, condition):
    """The rows of a condition in runs.csv, without the time that they took."""
    with (directory / "runs.csv").open(newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["condition"] == condition]
    return [{key: value for key, value in row.items() if key not in ("wall_s", "condition")} for row in rows]


def test_max_score_does_with_the_thoughts_of_a_rule_what_the_rule_does(run, tmp_path):
    code, out, err = write(run, "fsm:finds-alone")
    assert code == 0, err
    assert out.endswith("decisions in my/knowledge/thoughts.yaml\n")
    known = load_knowledge("thoughts", [tmp_path / "my"])
    by_situation = known.situations[GOAL]
    assert [max(scores, key=scores.get) for scores in by_situation.values()] == ["RandomWalk", "Patrol", "Finds"]
    assert all(scores[max(scores, key=scores.get)] == 1.0 for scores in by_situation.values())
    shipped = load_knowledge("exploring")
    assert [one.name for one in known.options(GOAL)] == [one.name for one in shipped.options(GOAL)]
    assert known.options("AvoidCollision") == shipped.options("AvoidCollision")
    assert sum(known.scores(GOAL)) == pytest.approx(1.0)
    code, _, err = run(
        "evaluate", "--family", "small", "--goal", GOAL, "--knowledge", "thoughts", "--strategy", "MaxScore",
        "--strategy", "fsm:finds-alone", "--strategy", "fixed:Patrol", "--scenarios", 4, "--output", "both",
    )  # fmt: skip
    assert code == 0, err
    by_rule = figures(tmp_path / "both", "fsm:finds-alone")
    assert figures(tmp_path / "both", "MaxScore") == by_rule != figures(tmp_path / "both", "fixed:Patrol")


def test_the_commands_of_the_page_run_in_their_order(run, tmp_path):
    commands = (ROOT / "docs" / "knowledge.md").read_text(encoding="utf-8").split("```sh\n")[2].split("```")[0]
    (tmp_path / "my/families/clustered.yaml").write_text(yaml.safe_dump({**SMALL, "name": "clustered"}))
    for line in commands.replace("\\\n", "").splitlines():
        program, *words = line.split()
        code, _, err = run(*words, "--scenarios", 1)
        assert (program, code) == ("clean-swarm", 0), err


def test_a_situation_that_never_occurred_has_the_scores_of_all(run, tmp_path):
    assert write(run, "policy:exploring-ppo", situations="crowd_2.5m,crowd_1m")[0] == 0
    content = read_mapping(tmp_path / "my/knowledge/thoughts.yaml")
    overall = {one["name"]: one["score"] for one in content["goals"][GOAL]}
    seen, never = content["situations"][GOAL].values()
    assert sum(overall.values()) == pytest.approx(1.0)
    assert seen == overall == never  # whoever is near is not far


@pytest.mark.parametrize(
    ("changes", "expected"),
    [
        ({"decider": "policy:none"}, "unknown policy 'none' (known: "),
        ({"decider": "fixed:Patrl"}, "--strategy fixed:Patrl: goal AvoidCollision: unknown option 'Patrl'"),
        ({"output": "thoughts.txt"}, "thoughts.txt: expected a name that ends in .yaml"),
        ({"output": "my/families/small.yaml"}, "my/families/small.yaml: cannot be written (File exists)"),
        ({"family": "smal"}, "unknown mission, family or task 'smal'"),
        ({"situations": " , "}, "--situations: expected components of the observation, got none"),
        ({"situations": "finds_none,lost"}, "--situations: unknown component 'lost'"),
        (
            {"decider": "policy:steers"},
            "policy:steers: expected a decider that only chooses options, got one that drives",
        ),
        (
            {"decider": "Random", "more": ("--goal", "AvoidCollision"), "family": "alone"},
            "alone: expected robots that run options of AvoidCollision, got none",
        ),
        ({"decider": "Random", "more": ("--goal", f"{GOAL}+AvoidCollision")}, "expected a decider for one goal, got"),
    ],
)
def test_mistakes_are_one_line_and_write_nothing(run, tmp_path, changes, expected):
    exported(tmp_path / "my" / "policies" / "steers", GOAL, (), ("idle",), vector=True)
    (tmp_path / "my/families/alone.yaml").write_text(yaml.safe_dump({**SMALL, "name": "alone", "robots": [1, 1]}))
    code, _, err = write(run, **{"decider": "policy:exploring-ppo", **changes})
    assert code == 2
    assert expected in err
    assert err.count("\n") == 1
    assert not (tmp_path / "my/knowledge/thoughts.yaml").exists()


@pytest.mark.parametrize(
    ("situations", "expected"),
    [
        ({"Nothing": {}}, "unknown goal 'Nothing'"),
        ({GOAL: {"finds_none": {"Patrol": 1.0}}}, f"situations.{GOAL}.finds_none: options: does not know RandomWalk"),
        ({GOAL: {"x": {"Patrol": 1.0, "RandomWalk": float("nan")}}}, "situations.ExplorationPatrol.x.RandomWalk"),
        ({GOAL: {"x": {"Patrol": 1.0, "RandomWalk": 0.0, "Fly": 1.0}}}, "knows Fly, which does not exist here"),
        ({GOAL: [1.0]}, f"situations.{GOAL}"),
    ],
)
def test_damaged_situations_are_one_line(run, tmp_path, situations, expected):
    goals = {
        "AvoidCollision": [{"configuration": "ORCA", "score": 1.0}],
        GOAL: [{"configuration": "Patrol", "score": 1.0}, {"configuration": "RandomWalk", "score": 0.5}],
    }
    (tmp_path / "my/knowledge/bad.yaml").write_text(yaml.safe_dump({"goals": goals, "situations": situations}))
    code, _, err = run("evaluate", "--family", "small", "--goal", GOAL, "--knowledge", "bad", "--scenarios", 1)
    assert code == 2
    assert expected in err
    assert err.count("\n") == 1


def test_situations_that_a_mission_does_not_show_are_an_error_and_stores_take_none(run, tmp_path, capsys):
    assert write(run, "fsm:finds-alone")[0] == 0
    file = tmp_path / "my/knowledge/thoughts.yaml"
    file.write_text(file.read_text().replace("finds_apart:", "finds_lost:"))
    words = ("evaluate", "--family", "small", "--goal", GOAL, "--knowledge", "thoughts", "--scenarios", 1)
    code, _, err = run(*words, "--strategy", "MaxScore")
    assert code == 2
    assert "strategy MaxScore: unknown component 'finds_lost'" in err
    code, _, err = told(capsys, "learn", "knowledge", "import", file, "--store", "s.sqlite")
    assert code == 2
    assert err.endswith("situations: expected none for a store, which keeps one score for each option\n")
