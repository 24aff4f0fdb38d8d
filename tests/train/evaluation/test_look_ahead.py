"""Looking ahead: the mission is not disturbed by its copies, and bad options are seen."""

import numpy as np
import pytest
import yaml

from clean_swarm_env.learning.actions import ActionConfig
from selector.documents.errors import DocumentError
from selector.knowledge import load_knowledge
from selector.strategies.policy_file import save_policy
from tests.selector.strategies.policies import exported, untrained
from train import cli
from train.deciders.named import decider_named
from train.evaluation.look_ahead import LookAheadEvaluation, LookingAhead, LookingTeam
from train.request import Request
from train.running.runs import RunRecord
from train.running.trials import TrialSettings, run_trials

GOOD = {"configuration": "PredictiveSteering"}
BAD = {"name": "Far", "configuration": "RepulsionFernandez", "parameters": {"view_distance": 2.0}}


LOOKING = {"base": "PredictiveSteering", "copies": 2, "hold": 5.0, "horizon": 200.0}


def evaluation_of(tmp_path, *options, **changes):
    """Look ahead on missions of a library with these options."""
    (tmp_path / "knowledge").mkdir(exist_ok=True)
    goals = {"AvoidCollision": [{"score": 1.0, **option} for option in options]}
    (tmp_path / "knowledge" / "few.yaml").write_text(yaml.safe_dump({"goals": goals}))
    request = Request("random", seed=1, scenarios=2, knowledge="few", directories=(tmp_path,))
    return LookAheadEvaluation(request, LookingAhead(**{**LOOKING, **changes}))


def team_of(base, **times):
    """Return a team that looks ahead from a policy, and its scenario."""
    looking = LookingAhead(base=base, copies=1, **times)
    asked = Request("clustered", seed=1, scenarios=1, goal="ExplorationPatrol")
    task = LookAheadEvaluation(asked, looking).tasks({})[0]
    return LookingTeam(task), task.first


def test_with_one_option_the_mission_is_that_of_the_option(tmp_path):
    task = evaluation_of(tmp_path, GOOD, hold=20.0, horizon=3.0).tasks({})[0]

    def decider(problem, teams):
        return decider_named("fixed:PredictiveSteering", (tmp_path,)).build(problem, teams)

    (alone,) = run_trials([task.first], decider, TrialSettings(directories=(tmp_path,)))
    [record] = task.run()
    assert record.result == alone
    assert sum(record.counts.values()) == -(-alone.duration_s // 20.0)
    assert RunRecord.of_mapping(record.as_mapping()) == record


def test_an_option_that_costs_much_is_not_taken(tmp_path):
    evaluation = evaluation_of(tmp_path, BAD, GOOD, hold=15.0)
    records = [record for task in evaluation.tasks({}) for record in task.run()]
    [grid] = evaluation.publication(records).grids
    excess = {row[0]: float(row[2]) for row in grid.rows}
    assert excess["look-ahead"] < 0.5 * excess["fixed:Far"]
    assert excess["look-ahead"] < 1.5 * excess["fixed:PredictiveSteering"]
    assert [row[1] for row in grid.rows] == ["0%"] * len(grid.rows)  # unfinished
    note, excess_note, few = grid.notes
    assert "no statement" in few
    assert excess_note.startswith("excess: ")
    assert note.startswith("taken by the look-ahead: PredictiveSteering")


def correcting(directory):
    """Write a policy that chooses how to explore and corrects the movement a little; return its name."""
    options = tuple(option.name for option in load_knowledge("exploring").options("ExplorationPatrol"))
    policy = untrained("ExplorationPatrol", options, ("free_far", "finds_none", "finds_together"), vector=True)
    for part in ("weight", "bias"):
        policy.weights[f"vector.{part}"] *= 0.05
    save_policy(directory, policy)
    return f"policy:{directory}"


@pytest.mark.parametrize("corrects", [False, True])
def test_a_policy_is_followed_where_no_option_is_better(corrects, tmp_path):
    policy = correcting(tmp_path) if corrects else "policy:exploring-ppo"
    team, scenario = team_of(policy, hold=60.0, horizon=60.0)
    assert team.alternatives[-1] == policy
    team._best = lambda state, observations: len(team.alternatives) - 1

    def decider(problem, teams):
        return decider_named(policy).build(problem, teams)

    named = decider_named(policy)
    seen, action = named.observation(scenario.mission.terms), ActionConfig(mode=named.mode)
    (alone,) = run_trials([scenario], decider, TrialSettings("ExplorationPatrol", observation=seen, action=action))
    assert team.result() == alone
    assert team.taken.keys() == {policy}


def test_an_option_that_is_tried_takes_the_place_of_that_of_the_policy_but_not_of_its_corrections(tmp_path):
    team, _ = team_of(correcting(tmp_path), hold=1.0, horizon=1.0)
    seen, options = team._batch.reset(), np.arange(team._batch.rows) % len(team.alternatives)
    followed, tried = (
        team._actions(0, np.full_like(options, team._base), seen),
        team._actions(0, options, seen),
    )
    assert np.array_equal(followed[:, -2:], tried[:, -2:])
    assert np.abs(followed[:, -2:]).max() > 0.0
    goal = [coordinator.model.goal for coordinator in team._batch.worlds.coordinators].index("ExplorationPatrol")
    follows = options == team._base
    assert np.array_equal(tried[:, goal], np.where(follows, followed[:, goal], options))


@pytest.mark.parametrize(
    ("base", "line"),
    [
        ("PredictiveSteerin", r"--base: unknown option 'PredictiveSteerin'.*PredictiveSteering"),
        ("policy:nobody", r"nobody"),
        ("policy:steers", r"--base: expected an option or a policy that chooses options, got policy:steers"),
    ],
)
def test_a_base_that_does_not_exist_is_one_line(tmp_path, base, line):
    exported(tmp_path / "policies" / "steers", "AvoidCollision", (), ("idle",), vector=True)
    with pytest.raises(DocumentError, match=line):
        evaluation_of(tmp_path, GOOD, base=base)


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (("--hold", "0"), "look-ahead: hold: expected"),
        (("--horizon", "nan"), "look-ahead: horizon: expected"),
        (("--copies", "0"), "look-ahead: copies: expected"),
        (("--scenarios", "1"), "--scenarios: expected"),
    ],
)
def test_numbers_out_of_bounds_are_one_line(monkeypatch, capsys, words, line):
    monkeypatch.setattr("sys.argv", ["clean-swarm", "study", "look-ahead", "random", "--base", "Off", *words])
    with pytest.raises(SystemExit) as ended:
        cli.main()
    assert ended.value.code == 2
    error = capsys.readouterr().err
    assert line in error
    assert error.count("\n") == 1
