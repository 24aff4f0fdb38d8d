"""Learners that compare whole missions of members: who decides where, exact resume, any number of workers."""

from functools import partial

import numpy as np
import pytest

from clean_swarm_env.config.load import load_family
from clean_swarm_env.deciders.decider import TeamsDecider
from clean_swarm_env.deciders.machines import FixedDecider, MachineDecider
from selector.documents.errors import DocumentError
from selector.strategies.machine_file import StateMachine, load_machine
from selector.strategies.policy_file import Network, load_policy
from selector.strategies.problem import Problem
from tests.train.learning.trainings import job, unvalidated, written
from train.learning.bandit import BanditTraining
from train.learning.config import DesignConfig, load_training
from train.learning.design import DesignTraining, MachineSpace
from train.learning.es import EsState, EsTraining, climbed, relative
from train.learning.members import MembersTraining, MemberTask, ObservationScale
from train.running.processes import Processes
from train.running.trials import TrialSettings

LEARNERS = {
    "es": (EsTraining, "policy/policy.safetensors", "checkpoint.json"),
    "design": (DesignTraining, "machine.yaml", "checkpoint.json"),
    "bandit": (BanditTraining, "strategy.safetensors", "checkpoint.safetensors"),
}


def always(option):
    return partial(FixedDecider, option)


def test_each_mission_follows_its_member_and_notes_what_it_sees():
    problem, seen = Problem("Goal", ("a", "b", "c"), np.zeros(3), ("left", "right")), {}
    decider = TeamsDecider([always(k) for k in (2, 0, 1)], [7, 9, 7], problem, np.repeat([0, 1], 2), seen)
    first, second = np.array([0, 1]), np.array([2, 3])
    decider.reset(second, 7)
    decider.reset(first, 9)
    observed = np.arange(8, dtype=np.float32).reshape(4, 2)
    assert decider.decide(observed).options.tolist() == [0, 0, 2, 2]
    decider.reset(second, 7)
    assert decider.decide(observed).options.tolist() == [0, 0, 1, 1]
    assert decider.opinions().argmax(axis=1).tolist() == [0, 0, 1, 1]
    assert seen[0].tolist() == [[2, 2], [4 + 6, 5 + 7], [16 + 36, 25 + 49]]
    assert seen[1].tolist() == [[4, 4], [4, 8], [8, 20]]


def test_the_missions_that_a_dead_worker_left_keep_their_members_and_places():
    scenarios = tuple(load_family("table1-starts").scenario(0, index, "train") for index in range(3))
    task = MemberTask(tuple(zip((4, 5, 6), scenarios, map(always, range(3)), strict=True)), TrialSettings())
    assert task.keys == tuple(zip(("train-1", "train-2", "train-3"), "456", strict=True))
    left = task.without({task.keys[1]})
    assert left.missions == task.missions[::2]


@pytest.mark.parametrize("kind", LEARNERS)
@pytest.mark.parametrize("workers", [1, pytest.param(2, marks=pytest.mark.long)])
def test_a_training_comes_to_the_same_bits_in_pieces_and_with_any_number_of_workers(
    tmp_path, monkeypatch, kind, workers
):
    made, *written_files = LEARNERS[kind]
    if workers == 1:
        unvalidated(monkeypatch)
    config = load_training(str(written(tmp_path, kind)), kind)
    whole = made(job(config, tmp_path / "whole"))
    while not whole.finished:
        whole.advance()
    whole.export("command")
    made(job(config, tmp_path / "cut")).advance()
    with Processes(workers).rounds() as done:
        cut = made(job(config, tmp_path / "cut", resume=True, workers=workers, done=done))
        assert cut.checkpoint == 1
        while not cut.finished:
            cut.advance()
    cut.export("command")
    for name in (*written_files, "history.jsonl"):
        assert (tmp_path / "cut" / name).read_bytes() == (tmp_path / "whole" / name).read_bytes(), name


def fake(monkeypatch, cost_of):
    """Let members cost what `cost_of` says, on scenarios that differ far more than members do."""
    noise = np.random.default_rng(0)

    def done(training, members, scenarios):
        training.decisions += len(members) * len(scenarios)
        hardness = np.exp(noise.normal(scale=2.0, size=(len(scenarios), 1)))
        costs = hardness * np.array([cost_of(member, training.problem) for member in members])
        training._costs += costs.ravel().tolist()
        features = len(training.problem.features)
        return costs, np.array([[100.0], [20.0], [54.0]]) * np.ones(features)

    monkeypatch.setattr(MembersTraining, "costs", done)
    unvalidated(monkeypatch)


def options_of(member, problem, observed):
    return member(problem, np.zeros(len(observed))).decide(observed).options


def test_evolution_strategies_find_the_linear_rule_that_costs_least(tmp_path, monkeypatch):
    observed = np.random.default_rng(1).uniform(-1.0, 1.0, (200, 7)).astype(np.float32)
    best = np.where(observed[:, 0] > observed[:, 4], 3, 1)

    def cost_of(member, problem):
        return np.exp(0.5 * (options_of(member, problem, observed) != best).mean())

    fake(monkeypatch, cost_of)
    settings = {"pairs": 16, "averaged": 0.5}
    config = load_training(str(written(tmp_path, "es", es=settings, checkpoints=1, decisions=2000)), "es")
    training = EsTraining(job(config, tmp_path / "run"))
    training.advance()
    assert training.scale == ObservationScale(mean=(0.2,) * 7, variance=(0.5,) * 7)
    policy = load_policy(training.export("a command"))
    assert (policy.spec.hidden, policy.spec.training["command"]) == ((), "a command")
    found = Network(policy).heads(observed.astype(np.float64))["options"].argmax(axis=1)
    assert (found == best).mean() > 0.9
    decider = training._decider_maker()(training.problem, np.zeros(200, dtype=np.int64))
    assert decider.decide(observed).options.tolist() == found.tolist()


def test_goals_that_are_decided_as_one_have_weights_of_their_own(tmp_path, monkeypatch):
    observed = np.random.default_rng(1).uniform(-1.0, 1.0, (200, 10)).astype(np.float32)
    best = [np.where(observed[:, 0] > 0.0, "ORCA", "Off"), np.where(observed[:, 1] > 0.0, "Finds", "Patrol")]

    def cost_of(member, problem):
        pairs = [problem.options[k].split("+") for k in options_of(member, problem, observed)]
        return np.exp(0.5 * np.mean(best != np.array(pairs).T))

    fake(monkeypatch, cost_of)
    changes = {"tasks": [{"family": "clustered", "worlds": 2}], "goal": "AvoidCollision+ExplorationPatrol"}
    changes |= {"observation": {"terms": ["situation", "crowd", "finds"]}, "checkpoints": 1, "decisions": 3000}
    settings = {"pairs": 16, "averaged": 0.5}
    training = EsTraining(
        job(load_training(str(written(tmp_path, "es", es=settings, **changes)), "es"), tmp_path / "run")
    )
    training.advance()
    assert len(training.state.parameters) == (5 + 7) * (len(training.problem.features) + 1)
    policy = load_policy(training.export("a command"))
    outputs = Network(policy).heads(observed.astype(np.float64))["options"]
    table = outputs.reshape(-1, 5, 7)  # the sum of two: differences are the same whatever the other goal has
    np.testing.assert_allclose(
        table - table[:, :1], np.broadcast_to((table - table[:, :1])[..., :1], table.shape), atol=1e-4
    )
    assert cost_of(training._decider_maker(), training.problem) < np.exp(0.5 * 0.15)


def test_a_training_begins_with_the_best_option_also_where_most_fail(tmp_path, monkeypatch):
    costs = [3000.0, 2000.0, 4000.0, 3000.0, 2500.0, 2600.0, 300.0, 90.0, 60.0, 150.0]  # four are far below the median
    fake(monkeypatch, lambda member, _: costs[member.args[0]] if member.func is FixedDecider else 100.0)
    es = EsTraining(job(load_training(str(written(tmp_path, "es")), "es"), tmp_path / "es"))
    monkeypatch.setattr(EsTraining, "_next", lambda training, *_: setattr(training, "decisions", 99) or training.state)
    es.advance()
    matrix = np.array(es.state.parameters).reshape(10, 8)
    assert np.argwhere(matrix).tolist() == [[8, 7]]
    design = DesignTraining(job(load_training(str(written(tmp_path, "design")), "design"), tmp_path / "design"))
    monkeypatch.setattr(DesignTraining, "_next", EsTraining._next)
    design.advance()
    (only,) = design.state.kept[0].states.values()
    assert only.option == design.problem.options[8]


def test_missions_are_compared_with_those_of_their_scenario_only():
    costs = np.array([10.0, 20.0, 40.0, 1.0, 2.0, 80.0])
    rewards = relative(costs, 3, limit=1.0)
    np.testing.assert_allclose(rewards, [np.log(2.0), 0.0, np.log(0.5), np.log(2.0), 0.0, -1.0])
    np.testing.assert_array_equal(relative(costs[3:], 3, limit=1.0), rewards[3:])


def test_a_step_goes_up_the_slope_and_the_average_follows():
    state = EsState(parameters=(0.0, 0.0), average=(0.0, 0.0), slope=(0.0, 0.0), square=(0.0, 0.0))
    for _ in range(50):
        off = np.array(state.parameters) - np.array([1.0, -2.0])
        state = climbed(state, -2.0 * off, rate=0.2, averaged=0.9)
    np.testing.assert_allclose(state.parameters, [1.0, -2.0], atol=0.15)
    np.testing.assert_allclose(state.average, [1.0, -2.0], atol=0.3)


@pytest.mark.parametrize(
    ("change", "line"),
    [
        (lambda text: text[:100], "checkpoint.json: line 1: "),
        (lambda text: text.replace('"decisions": ', '"decisions": -'), "decisions"),
        (
            lambda text: text.replace('"average": [0.0, ', '"average": ['),
            "expected 80 numbers of this training, got 79",
        ),
    ],
)
def test_a_damaged_checkpoint_is_one_line(tmp_path, monkeypatch, change, line):
    fake(monkeypatch, lambda *_: 1.0)
    config = load_training(str(written(tmp_path, "es")), "es")
    EsTraining(job(config, tmp_path / "run")).advance()
    file = tmp_path / "run" / "checkpoint.json"
    damaged = change(file.read_text())
    assert damaged != file.read_text()
    file.write_text(damaged)
    with pytest.raises(DocumentError, match=line):
        EsTraining(job(config, tmp_path / "run", resume=True))


@pytest.mark.parametrize(  # the best option alone: 0.4
    ("fresh", "most"), [(0.2, 0.2), pytest.param(1.0, 0.4, marks=pytest.mark.long)]
)
def test_a_design_finds_a_machine_that_costs_little(tmp_path, monkeypatch, fresh, most):
    observed = np.random.default_rng(1).uniform(-1.0, 1.0, (20, 7)).astype(np.float32)
    course = np.repeat(observed, 3, axis=0)[:, None]  # each robot sees the same for three decisions
    best = np.where(course[:, 0, 0] > 0.2, 3, 1)
    random = np.random.default_rng(2)

    def wrong(member, problem):
        decider = member(problem, np.zeros(1))
        decider.reset(np.array([0]), 3)
        return (np.array([decider.decide(seen).options[0] for seen in course]) != best)[2::3].mean()

    fake(monkeypatch, lambda member, problem: np.exp(wrong(member, problem) + random.normal(scale=0.02)))
    settings = {"fresh": fresh, "race": {"block": 2, "blocks": 3}}
    config = load_training(str(written(tmp_path, "design", design=settings, checkpoints=1, decisions=3000)), "design")
    training = DesignTraining(job(config, tmp_path / "run"))
    training.advance()
    machine = load_machine(str(training.export("a command")))
    assert machine.training["command"] == "a command"
    assert all(way.to in machine.states for way in machine.ways)
    assert wrong(partial(MachineDecider, machine), training.problem) <= most


def test_no_machine_races_twice_at_a_time(tmp_path, monkeypatch):
    raced = []

    def costs(training, members, scenarios):
        raced.append([member.args[0] for member in members])
        return np.ones((len(scenarios), len(members))), np.zeros(0)

    fake(monkeypatch, lambda *_: 1.0)
    monkeypatch.setattr(DesignTraining, "costs", costs)
    settings = {"states": 1, "candidates": 50, "race": {"block": 2, "blocks": 1}}
    config = load_training(str(written(tmp_path, "design", design=settings)), "design")
    training = DesignTraining(job(config, tmp_path / "run"))
    training.scale = ObservationScale(mean=(0.0,) * 7, variance=(1.0,) * 7)
    training.state = training._first(np.arange(10))
    training.state = training._next(lambda count: [None] * count, np.random.default_rng(0))
    (machines,) = raced
    assert len(machines) == 10  # one for each option


def test_machines_stay_within_their_sizes_whatever_is_changed():
    problem = Problem("Goal", ("a", "b"), np.zeros(2), ("seen",))
    settings = DesignConfig(states=3, transitions=2)
    space = MachineSpace(problem, ObservationScale(mean=(0.5,), variance=(0.01,)), settings, np.random.default_rng(0))
    machine, sizes = space.drawn(), set()
    for _ in range(500):
        machine = StateMachine.model_validate(space.changed(machine).model_dump())
        machine.check_fits(problem, "here")
        sizes.add((len(machine.states), max(len(state.transitions) for state in machine.states.values())))
        bounds = [way.above or way.below for way in machine.ways if way.when]
        assert all(0.3 <= bound <= 0.7 for bound in bounds)
    assert sizes >= {(1, 0), (3, 2)}
    assert max(states for states, _ in sizes) == 3
    assert max(ways for _, ways in sizes) == 2
