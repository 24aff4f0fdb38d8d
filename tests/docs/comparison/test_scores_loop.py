"""The command behind the loop of docs/scores.md: what it computes from single options is what `--learn` does."""

import json

import numpy as np
import pytest
import yaml

from docs.comparison import loop_runs
from docs.comparison.loop import (
    LEARNERS,
    RIGHT,
    STARTS,
    WRONG,
    LoopedMissions,
    LoopManifest,
    learned_choices,
    tried_numbers,
)
from docs.comparison.loop_runs import LoopedRuns, make_loop, read_table
from docs.comparison.loop_tables import BY_SCORE, LoopResults
from selector.knowledge import knowledge_from
from selector.strategies.registry import spec_from_text
from tests.train.commands import done
from train.running.finished_runs import JOURNAL, runs_of

GOAL = "AvoidCollision"
ROOMS = {
    "name": "rooms",
    "description": "Table 1 with fewer items.",
    "mission": {"base": "table1", "knowledge": "cleaning", "time_limit": 400.0},
    "items": [4, 4],
}
SMALL = {
    "name": "tried",
    "families": {"rooms": {"goal": GOAL}},
    "missions": 4,
    "last": 2,
    "seeds": [3, 4],
    "training": 2,
    "training_seed": 1,
    "scaled": ["exploration", "deviation"],
    "numbers": {"UCB1": {"prior": [0.0, 1.0], "exploration": [0.5]}},
    "drawn": ["MaxScore", "UCB1"],
}
KNOWN = knowledge_from({"goals": {"G": [{"configuration": name, "score": k} for k, name in enumerate("abc")]}})


def taken(directory):
    """The options of the missions of an evaluation that learned."""
    lines = map(json.loads, (directory / "choices.jsonl").read_text().splitlines())
    return [one["options"][GOAL] for one in lines]


@pytest.mark.long
def test_strategies_learn_from_runs_of_single_options_as_the_command_does(tmp_path, monkeypatch):
    monkeypatch.setattr(loop_runs, "run", done)
    monkeypatch.chdir(tmp_path)
    file = tmp_path / "rooms.yaml"
    file.write_text(yaml.safe_dump(ROOMS))
    manifest = LoopManifest(**{**SMALL, "families": {"rooms": {"goal": GOAL, "file": str(file)}}})
    own = make_loop(manifest, "rooms", tmp_path)
    assert own.training.scores.shape == (1, 3, 2)
    assert own.missions.scores.shape == (2, 3, 4)
    names = own.missions.options
    for text in ("UCB1:exploration=0.05,prior=0", "EpsilonGreedy:epsilon=0.5", "GaussianThompson"):
        found = learned_choices(spec_from_text(f"{text},sharing=robot" if ":" in text else f"{text}:sharing=robot"),
                                own.missions.knowledge, own.missions, (3, 4))  # fmt: skip
        for row, seed in enumerate((3, 4)):
            output = tmp_path / f"{text[:3]}-{seed}"
            done("evaluate", file, "--store", f"{output}.sqlite", "--learn", "--strategy", text,
                 "--scenarios", 4, "--seed", seed, "--output", output)  # fmt: skip
            assert taken(output) == [names[option] for option in found[row]]
            (strategy,) = {record.condition for record in runs_of(output / JOURNAL)}
            (excess,) = read_table(output, "test", [strategy], "excess_s")
            assert excess.tolist() == own.missions.paid(found)[row].tolist()


def looped(means, missions=40, seeds=2):
    """Missions of three options with these mean costs."""
    noise = np.random.default_rng(1).normal(0.0, 1.0, (seeds, 1, missions))
    excess = np.array(means)[None, :, None] + noise
    return LoopedMissions(KNOWN, "G", excess, 1.0 - excess / 1000.0)


def test_further_seeds_have_the_same_missions_in_another_order():
    missions = looped([30.0, 10.0, 20.0], seeds=1)
    own = LoopedRuns(missions, missions, {"Random": missions.excess.mean(axis=1)}).in_orders((1, 2, 3))
    assert own.missions.scores.shape == (3, 3, 40)
    assert own.missions.excess[0].tolist() == missions.excess[0].tolist()
    for part in (own.missions.excess[:, 0], own.missions.scores[:, 2], own.beside["Random"]):
        assert len({tuple(row) for row in part}) == 3
        assert np.ptp(np.sort(part, axis=1), axis=0).max() == 0.0
    assert np.allclose(own.missions.excess.mean(axis=1), own.beside["Random"])  # options and the others stay together


def test_scores_at_the_beginning_are_those_of_training_missions_or_the_same_the_wrong_way_round():
    missions = looped([30.0, 10.0, 20.0])
    right, wrong = (missions.starting(start).scores("G") for start in (RIGHT, WRONG))
    assert np.argsort(right).tolist() == [0, 2, 1]
    assert np.argsort(wrong).tolist() == [1, 2, 0]
    assert sorted(right) == sorted(wrong)
    assert missions.starting(STARTS[0]).scores("G").tolist() == [0.0, 1.0, 2.0]


def test_tables_say_who_ends_at_the_best_option_and_who_stays_with_a_wrong_one():
    manifest = LoopManifest(
        **{**SMALL, "missions": 40, "last": 10, "seeds": [1, 2], "families": {"one": {"goal": "G"}}}
    )
    training, missions = looped([30.0, 10.0, 20.0]), looped([30.0, 10.0, 20.0])
    beside = {"Random": missions.excess.mean(axis=1)}
    results = LoopResults(manifest, {"one": LoopedRuns(training, missions, beside)})
    tables = results.tables()
    assert list(tables) == ["held", "scores of one", "numbers", "families"]
    assert set(results.taken[("one", WRONG, BY_SCORE)].ravel()) == {0, 2}  # never 1, whose score is the lowest
    rows = {row.split("|")[1].strip(): row for row in tables["scores of one"].splitlines()}
    assert set(rows) == {"", "---", f"`{BY_SCORE}`", *(f"`{name}`" for name in LEARNERS), "`Random`"}
    assert "| **1.00** [1.00, 1.00] | **1.00** |" in rows[f"`{BY_SCORE}`"]  # of all and at worst, from right scores
    random = np.mean(beside["Random"][:, -10:]) / missions.excess[:, 1, -10:].mean()
    assert rows["`Random`"].startswith(f"| `Random` | {random:.2f} [")
    assert results.numbers["UCB1"] in tried_numbers(manifest, "UCB1")
