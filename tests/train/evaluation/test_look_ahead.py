"""Looking ahead: the mission is not disturbed by its copies, and bad options are seen."""

import numpy as np
import pytest
import yaml

from clean_swarm_env.config.errors import ConfigurationError
from clean_swarm_env.config.load import load_family
from clean_swarm_env.learning.actions import ActionConfig
from selector.knowledge import load_knowledge
from selector.strategies.policy_file import save_policy
from tests.selector.strategies.policies import exported, untrained
from train import cli
from train.deciders.named import decider_named
from train.evaluation.choosing.look_ahead import LookAheadRequest, LookingTeam, look_ahead_table
from train.running.trials import TrialSettings, run_trials

GOOD = {"configuration": "PredictiveSteering"}
BAD = {"name": "Far", "configuration": "RepulsionFernandez", "parameters": {"view_distance": 2.0}}


def request(tmp_path, *options, **changes):
    """Look ahead on missions of a library with these options."""
    (tmp_path / "knowledge").mkdir(exist_ok=True)
    goals = {"AvoidCollision": [{"score": 1.0, **option} for option in options]}
    (tmp_path / "knowledge" / "few.yaml").write_text(yaml.safe_dump({"goals": goals}))
    family = load_family("random").with_knowledge("few")
    settings = {"base": "PredictiveSteering", "scenarios": 2, "copies": 2, "hold": 5.0, "horizon": 200.0} | changes
    return LookAheadRequest(family, seed=1, directories=(tmp_path,), **settings)


def test_with_one_option_the_mission_is_that_of_the_option(tmp_path):
    asked = request(tmp_path, GOOD, hold=20.0, horizon=3.0)
    scenario = asked.family.scenario(1, 0, "test")
    team = LookingTeam(asked, scenario, 0)

    def decider(problem, teams):
        return decider_named("fixed:PredictiveSteering", (tmp_path,)).build(problem, teams)

    (alone,) = run_trials([scenario], decider, TrialSettings(directories=(tmp_path,)))
    assert team.result() == alone
    assert team.taken.total() == -(-alone.duration_s // 20.0)


def test_an_option_that_costs_much_is_not_taken(tmp_path):
    grid = look_ahead_table(request(tmp_path, BAD, GOOD, hold=15.0))
    excess = {row.label: float(row.groups[1][0]) for row in grid.rows}
    assert excess["look-ahead"] < 0.5 * excess["fixed:Far"]
    assert excess["look-ahead"] < 1.5 * excess["fixed:PredictiveSteering"]
    assert [row.groups[0][0] for row in grid.rows] == ["0%"] * len(grid.rows)  # unfinished
    note, few = grid.notes
    assert "no statement" in few
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
    asked = LookAheadRequest(
        load_family("clustered"), policy, 1, 1, 1, hold=60.0, horizon=60.0, goal="ExplorationPatrol"
    )
    scenario = asked.family.scenario(1, 0, "test")
    team = LookingTeam(asked, scenario, 0)
    assert team.alternatives[-1] == policy
    team._best = lambda state, observations: len(team.alternatives) - 1

    def decider(problem, teams):
        return decider_named(policy).build(problem, teams)

    named = decider_named(policy)
    seen, action = named.observation(asked.family.mission.terms), ActionConfig(mode=named.mode)
    (alone,) = run_trials([scenario], decider, TrialSettings("ExplorationPatrol", observation=seen, action=action))
    assert team.result() == alone
    assert team.taken.keys() == {policy}


def test_an_option_that_is_tried_takes_the_place_of_that_of_the_policy_but_not_of_its_corrections(tmp_path):
    asked = LookAheadRequest(
        load_family("clustered"), correcting(tmp_path), 1, 1, 1, hold=1.0, horizon=1.0, goal="ExplorationPatrol"
    )
    team = LookingTeam(asked, asked.family.scenario(1, 0, "test"), 0)
    seen, options = team._batch.reset(), np.arange(team._batch.rows) % len(team.alternatives)
    followed, tried = (
        team._base.actions(np.full_like(options, team._base.number), seen),
        team._base.actions(options, seen),
    )
    assert np.array_equal(followed[:, -2:], tried[:, -2:])
    assert np.abs(followed[:, -2:]).max() > 0.0
    goal = [coordinator.model.goal for coordinator in team._batch.worlds.coordinators].index("ExplorationPatrol")
    follows = options == team._base.number
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
    asked = request(tmp_path, GOOD, base=base)
    with pytest.raises(ConfigurationError, match=line):
        LookingTeam(asked, asked.family.scenario(1, 0, "test"), 0)


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (("--hold", "0"), "--hold: expected more than 0 s and at most 1e+06 s, got 0"),
        (("--horizon", "nan"), "--horizon: expected more than 0 s"),
        (("--copies", "0"), "--copies: expected"),
        (("--scenarios", "1"), "--scenarios: expected"),
    ],
)
def test_numbers_out_of_bounds_are_one_line(monkeypatch, capsys, words, line):
    monkeypatch.setattr("sys.argv", ["clean-swarm", "look-ahead", "random", "--base", "Off", *words])
    with pytest.raises(SystemExit) as ended:
        cli.main()
    assert ended.value.code == 2
    error = capsys.readouterr().err
    assert line in error
    assert error.count("\n") == 1
