"""Why a robot moves as it does: the sentence by its rules, in Python and in the page, from what is recorded."""

import json
from dataclasses import asdict, replace
from math import pi

import numpy as np
import pytest

from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.tasks import Cleaning
from clean_swarm_env.world.explaining import explain_robot
from selector.documents.errors import DocumentError
from tests.train.commands import command, done
from tests.train.replay.conftest import CONDITIONS
from train.evaluation.why import Facts, facts_of, sentence

PATROLLING = Facts("at work", 0.0, ("Patrol",), (1.0, 0.0), (1.0, 0.0), 0.0, (), 0.0, None, 12.0)
AVOIDING = replace(PATROLLING, causes=((3, 0.6),), command=(0.0, 1.0), target=("recycling", 2.2))
CASES = {
    "patrols: nothing seen for 12 s": PATROLLING,
    "goes to an item, 1.2 m": replace(PATROLLING, running=("MoveToGarbage",), target=("an item", 1.2)),
    "goes to a dump": replace(PATROLLING, running=("MoveToDump",), target=("a dump", -1.0)),
    "picks an item": replace(PATROLLING, running=("PickGarbage",), target=("an item", 0.1)),
    "runs ChemotaxisGe and Tell": replace(PATROLLING, running=("ChemotaxisGe", "Tell"), unseen=-1.0),
    "does nothing: no behaviour runs": replace(PATROLLING, running=()),
    "does nothing: it has failed": replace(AVOIDING, state="failed"),
    "is not there": replace(PATROLLING, state="taken away"),
    "stands after a collision, for 1.2 s more": replace(AVOIDING, stands=1.2),
    "turns left because of robot 3, 0.6 m away; would go to recycling, 2.2 m": AVOIDING,
    "turns right because of robot 3, 0.6 m away; would patrol": replace(AVOIDING, command=(0.0, -1.0), target=None),
    "turns left because of robot 3, 0.6 m away; would go to a dump": replace(  # over the back
        AVOIDING, wish=(-1.0, 0.2), command=(-1.0, -0.2), target=("a dump", -1.0)
    ),
    "turns right because of robot 3, 0.6 m away; would go to an item, 3.0 m": replace(  # beside the heading
        AVOIDING, wish=(0.0, 0.0), heading=pi, command=(0.0, 1.0), target=("an item", 3.0)
    ),
    "stops because of robot 3, 0.6 m away, and robot 8; would go to recycling, 2.2 m": replace(
        AVOIDING, command=(0.01, 0.0), causes=((3, 0.6), (8, 0.9)), share=0.4
    ),
    "stops because of robot 3, 0.6 m away; would go to an item, 0.7 m": replace(  # others hold it where it is
        AVOIDING, running=("AvoidCollision",), wish=(0.0, 0.0), command=(0.01, 0.0), target=("an item", 0.7)
    ),
    "slows down because of robot 3, 0.6 m away; would go to recycling, 2.2 m": replace(
        AVOIDING, command=(0.5, 0.0), causes=((3, 0.6), (8, 0.9)), share=0.1
    ),
    "keeps away because of robot 3, 0.6 m away; would go to recycling, 2.2 m": replace(AVOIDING, command=(1.0, 0.1)),
    "goes to recycling, 2.2 m": replace(AVOIDING, command=(1.0, 0.02)),  # hardly another way
}


@pytest.mark.parametrize("expected", CASES)
def test_the_sentence_follows_the_rules(expected):
    assert sentence(CASES[expected], Cleaning) == expected


@pytest.mark.page
@pytest.mark.extra
@pytest.mark.long
def test_the_page_makes_the_same_sentences(opened):
    page = opened()
    words = {"doing": Cleaning.doing, "searching": Cleaning.searching, "sees": Cleaning.sees}
    said = page.evaluate(
        "([cases, words]) => cases.map((facts) => replay.sentenceOf(facts, words))",
        [[asdict(facts) for facts in CASES.values()], words],
    )
    assert said == list(CASES)


@pytest.mark.page
@pytest.mark.extra
@pytest.mark.long
def test_facts_and_inputs_are_those_of_the_command(opened, explained, recordings):
    page, avoided, chosen = opened(), 0, 0
    for k, frame, robot, step in explained(page, 14, seed=5):
        shown, facts = page.evaluate(f"replay.factsOf(replay.runs[{k}], {frame}, {robot})"), step["facts"]
        assert shown["state"] == facts["state"]
        if facts["state"] != "at work":
            continue
        assert shown["running"] == list(facts["running"])
        assert [who for who, _ in shown["causes"]] == [who for who, _ in facts["causes"]]
        near, told = ([away for _, away in each["causes"]] for each in (shown, facts))
        assert near == pytest.approx(told, abs=0.003)
        for name in ("wish", "command", "unseen", "stands", "share", "heading"):
            assert shown[name] == pytest.approx(facts[name], abs=0.002), name
        assert (shown["target"] or [None])[0] == (facts["target"] or [None])[0]
        if facts["target"]:
            assert shown["target"][1] == pytest.approx(facts["target"][1], abs=0.003)
        facts = {**shown, "target": tuple(shown["target"]) if shown["target"] else None}
        told = page.text_content("[data-sentence]").removeprefix("the run is over; in its last step it ")
        assert told == sentence(Facts(**facts), Cleaning)
        avoided += "because of robot" in step["sentence"]
        move = step["policy"].get("AvoidCollision")
        if move is not None and recordings[k]["working"][frame, robot]:
            chosen += 1
            found = page.evaluate(f"replay.movesOf(replay.runs[{k}], {frame}, {robot}, 'AvoidCollision')")
            assert found["option"] == move["option"]
            assert found["likely"] == pytest.approx(move["probability"], abs=0.01)
            moved = {one["name"]: one["moved"] for one in found["moves"]}
            assert moved == pytest.approx(move["moved"], abs=0.02)
    assert avoided
    assert chosen


def test_an_error_in_target_names_the_method():
    batch = Batch({"task": "Foraging"}, explained=True)
    batch.reset([1])
    batch.step(np.zeros(batch.rows, dtype=np.int64))
    batch.worlds.task.target = lambda row, read: int("no den")
    with pytest.raises(DocumentError, match=r"^task Foraging: target: .*no den"):
        facts_of(batch.worlds, explain_robot(batch.worlds, 0), {"x": [0.0], "y": [0.0], "cause": [[-1]]}, 0.0)


def test_what_if_it_goes_on_as_it_did(results, recordings):
    """The option that the robot holds anyway leads where the recorded robot went."""
    recording = recordings[1]
    for frame in (23, 60):
        robot = int(np.flatnonzero(recording["working"][frame : frame + 27].all(axis=0))[0])
        words = ("--condition", CONDITIONS[1], "--robot", robot, "--time", frame * 0.2, "--json", "--what-if")
        told = json.loads(done("explain", results / "run", *words))["what_if"]
        foretold = {one["option"]: one for one in told}
        course = [[recording[name][t, robot] for name in "xy"] for t in range(frame + 1, frame + 27)]
        assert np.allclose(foretold["RepulsionGradient-view0.5"]["path"], course, atol=0.0006)
        assert len(foretold) > 5


def test_what_if_takes_the_runs_of_an_experiment(tmp_path):
    done("evaluate", "--scenarios", 1, "--workers", 1, "--output", tmp_path / "run")
    code, told, said = command("explain", tmp_path / "run", "--robot", 0, "--time", 1, "--what-if")
    assert (code, "the next 5 s if it took" in told) == (0, True)
    assert said == "run again up to 1 s\n"


@pytest.mark.page
@pytest.mark.extra
@pytest.mark.long
def test_the_cost_so_far_ends_at_the_cost_of_the_run(opened, recordings):
    page = opened()
    for k, recording in enumerate(recordings):
        page.evaluate(f"replay.page.go({(recording.frames - 1) * 0.2})")
        cost = float(page.get_attribute(f"figure:nth-of-type({k + 1}) [data-cost]", "data-cost"))
        assert cost == pytest.approx(recording.result["cost_s"], rel=0.01)
