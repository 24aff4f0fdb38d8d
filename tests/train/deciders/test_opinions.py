"""What a decider thinks, as a knowledge file with scores by situation, which MaxScore uses."""

import pytest
import yaml

from selector.documents.reading import read_mapping
from selector.knowledge import load_knowledge
from tests.paths import ROOT
from tests.selector.strategies.policies import exported
from tests.train.commands import done, refused, runs

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


OWN = ("--configs", "my")
SCORED = ("evaluate", "--family", "small", "--goal", GOAL, *OWN, "--knowledge")


@pytest.fixture(autouse=True)
def here(monkeypatch, tmp_path):
    """Be in a directory with a family and a directory of knowledge of our own in `my`."""
    monkeypatch.chdir(tmp_path)
    for kind in ("families", "knowledge"):
        (tmp_path / "my" / kind).mkdir(parents=True)
    (tmp_path / "my" / "families" / "small.yaml").write_text(yaml.safe_dump(SMALL))


def writing(decider, output="my/knowledge/thoughts.yaml", family="small", situations=FINDS, more=()):
    """The words of the command that writes what a decider thinks."""
    words = ("learn", "knowledge", "from-policy", decider, output, "--family", family, "--situations", situations)
    return (*words, "--scenarios", 3, *OWN, *more)


def test_max_score_does_with_the_thoughts_of_a_rule_what_the_rule_does(tmp_path):
    assert done(*writing("fsm:finds-alone")).endswith("decisions in my/knowledge/thoughts.yaml\n")
    known = load_knowledge("thoughts", [tmp_path / "my"])
    by_situation = known.situations[GOAL]
    assert [max(scores, key=scores.get) for scores in by_situation.values()] == ["RandomWalk", "Patrol", "Finds"]
    assert all(scores[max(scores, key=scores.get)] == 1.0 for scores in by_situation.values())
    shipped = load_knowledge("exploring")
    assert [one.name for one in known.options(GOAL)] == [one.name for one in shipped.options(GOAL)]
    assert known.options("AvoidCollision") == shipped.options("AvoidCollision")
    assert sum(known.scores(GOAL)) == pytest.approx(1.0)
    strategies = ("MaxScore", "fsm:finds-alone", "fixed:Patrol")
    words = (word for name in strategies for word in ("--strategy", name))
    done(*SCORED, "thoughts", *words, "--scenarios", 4, "--output", "both")
    found = {name: [] for name in (*strategies, "Random")}
    for row in runs(tmp_path / "both"):
        found[row.pop("condition")].append(row)
    assert found["MaxScore"] == found["fsm:finds-alone"] != found["fixed:Patrol"]


def test_the_commands_of_the_page_run_in_their_order(tmp_path):
    commands = (ROOT / "docs" / "knowledge.md").read_text(encoding="utf-8").split("```sh\n")[2].split("```")[0]
    (tmp_path / "my/families/clustered.yaml").write_text(yaml.safe_dump({**SMALL, "name": "clustered"}))
    for line in commands.replace("\\\n", "").splitlines():
        program, *words = line.split()
        assert program == "clean-swarm"
        done(*words, "--scenarios", 1, *OWN)


def test_a_situation_that_never_occurred_has_the_scores_of_all(tmp_path):
    done(*writing("policy:exploring-ppo", situations="crowd_2.5m,crowd_1m"))
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
def test_mistakes_are_one_line_and_write_nothing(tmp_path, changes, expected):
    exported(tmp_path / "my" / "policies" / "steers", GOAL, (), ("idle",), vector=True)
    (tmp_path / "my/families/alone.yaml").write_text(yaml.safe_dump({**SMALL, "name": "alone", "robots": [1, 1]}))
    assert expected in refused(*writing(**{"decider": "policy:exploring-ppo", **changes}))
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
def test_damaged_situations_are_one_line(tmp_path, situations, expected):
    goals = {
        "AvoidCollision": [{"configuration": "ORCA", "score": 1.0}],
        GOAL: [{"configuration": "Patrol", "score": 1.0}, {"configuration": "RandomWalk", "score": 0.5}],
    }
    (tmp_path / "my/knowledge/bad.yaml").write_text(yaml.safe_dump({"goals": goals, "situations": situations}))
    assert expected in refused(*SCORED, "bad", "--scenarios", 1)


def test_situations_that_a_mission_does_not_show_are_an_error_and_stores_take_none(tmp_path):
    done(*writing("fsm:finds-alone"))
    file = tmp_path / "my/knowledge/thoughts.yaml"
    file.write_text(file.read_text().replace("finds_apart:", "finds_lost:"))
    line = refused(*SCORED, "thoughts", "--scenarios", 1, "--strategy", "MaxScore")
    assert "strategy MaxScore: unknown component 'finds_lost'" in line
    line = refused("learn", "knowledge", "import", file, "--store", "s.sqlite")
    assert line.endswith("situations: expected none for a store, which keeps one score for each option\n")
