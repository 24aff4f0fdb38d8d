"""Missions by state machines: one state is a fixed option, and the rule made by hand is a machine, bit for bit."""

import numpy as np
import pytest

from clean_swarm_env.config.load import load_family
from clean_swarm_env.deciders.decided_goal import DecidedGoal
from clean_swarm_env.deciders.decider import OptionDecider
from clean_swarm_env.deciders.machines import MachineDecider
from clean_swarm_env.deciders.named import decider_named
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.recording.recorder import RecordSettings
from selector.documents.errors import DocumentError
from selector.documents.yaml_values import yaml_value
from selector.strategies.machine_file import StateMachine, load_machine
from selector.strategies.probing import Probing
from selector.strategies.problem import Problem
from tests.pages import blocks
from train.running.trials import TrialSettings, run_trials

PROBLEM = Problem("Goal", ("a", "b", "c"), np.zeros(3), ("near", "far"))
ONE = "goal: AvoidCollision\nstart: only\nstates:\n  only: {option: RepulsionGradient-view0.5}\n"


def machine(**states):
    return StateMachine.model_validate({"goal": "Goal", "start": next(iter(states)), "states": states})


STEADY = machine(on={"option": "a", "transitions": [{"to": "off", "when": "near", "above": 0.5}]}, off={"option": "b"})


def test_a_machine_of_one_state_is_a_fixed_option(tmp_path):
    (tmp_path / "one.yaml").write_text(ONE)
    scenarios = [load_family("random").scenario(1, number, "test") for number in range(2)]
    members = (f"fsm:{tmp_path / 'one.yaml'}", "fixed:RepulsionGradient-view0.5")
    recorded = TrialSettings(record=RecordSettings(tmp_path / "recordings"))
    machine, fixed = (run_trials(scenarios, decider_named(member).build, recorded) for member in members)
    assert machine == fixed == run_trials(scenarios, decider_named(members[0]).build)


def test_a_machine_that_goes_to_the_state_of_its_situation_is_a_rule(tmp_path):
    scenarios = [load_family("random").scenario(1, number, "test") for number in range(2)]
    situations, machine = ("free_far", "free_near", "carrying_far", "carrying_near"), load_machine("rule")

    class ByHand(OptionDecider):
        def _choose(self, observations):
            names = [machine.states[name.replace("_", " ")].option for name in situations]
            options = np.array([self.problem.options.index(name) for name in names])
            columns = [self.problem.features.index(name) for name in situations]
            return options[observations[:, columns].argmax(axis=1)]

    assert run_trials(scenarios, decider_named("fsm:rule").build) == run_trials(scenarios, ByHand)


def test_the_guide_shows_a_machine_for_the_options_that_ship():
    _, block = blocks("docs/strategies.md", "yaml")
    shown = StateMachine.model_validate(yaml_value(block.text, "guide"))
    batch = Batch(load_family("crowded").scenario(0, 0, "test").mission)
    shown.check_fits(DecidedGoal(batch).problem, "docs/strategies.md")
    assert len(shown.ways) == 3


def test_the_first_open_way_is_taken_and_one_way_a_decision():
    ways = [{"to": "second", "when": "near", "above": 0.5}, {"to": "third", "when": "far", "below": 0.0}]
    decider = MachineDecider(
        machine(
            first={"option": "a", "transitions": ways},
            second={"option": "b", "transitions": [{"to": "third"}]},
            third={"option": "c"},
        ),
        PROBLEM,
        np.zeros(4),
    )
    decider.reset(np.arange(4), 1)
    seen = np.array([[0.6, -1.0], [0.5, -0.1], [0.5, 0.0], [0.9, 0.9]], dtype=np.float32)
    assert decider.decide(seen).options.tolist() == [1, 2, 0, 1]
    assert decider.decide(seen).options.tolist() == [2, 2, 0, 2]
    assert decider.opinions().argmax(axis=1).tolist() == [2, 2, 0, 2]
    decider.reset(np.array([1, 3]), 2)
    assert decider.decide(seen).options.tolist() == [2, 2, 0, 1]


def test_probabilities_are_kept_and_rows_draw_the_same_in_any_batch():
    flips = machine(
        on={"option": "a", "transitions": [{"to": "off", "probability": 0.2}]},
        off={"option": "b", "transitions": [{"to": "on", "when": "near", "above": -1.0, "probability": 0.4}]},
    )

    def course(rows, first):
        decider = MachineDecider(flips, PROBLEM, np.zeros(rows))
        decider.reset(np.arange(first, rows), 5)
        return np.array([decider.decide(np.zeros((rows, 2), dtype=np.float32)).options for _ in range(300)])[:, first:]

    alone = course(50, 0)
    np.testing.assert_array_equal(course(60, 10), alone)
    assert alone[100:].mean() == pytest.approx(0.2 / 0.6, abs=0.03)  # the share of the time in the second state
    assert len(np.unique(alone, axis=1).T) == 50


BEGIN = {"robots": 2, "option": "c", "until": "far"}


@pytest.mark.parametrize(
    ("probing", "words"),
    [
        (BEGIN | {"robots": 4}, "probing.robots: expected at most 3, the robots of the smallest team, got 4"),
        (BEGIN | {"option": "d"}, "probing: unknown option 'd' (known: a, b, c)"),
        (
            BEGIN | {"until": "heard_news"},
            "probing: unknown component 'heard_news' (known: near, far); it is there where",
        ),
    ],
)
def test_probing_that_does_not_fit_is_one_line(probing, words):
    with pytest.raises(DocumentError) as error:
        MachineDecider(STEADY, PROBLEM, np.array([0, 0, 0, 1, 1, 1, 1]), Probing(**probing))
    assert str(error.value).startswith(words)


def test_some_begin_otherwise_until_they_have_heard_and_others_try_now_and_then():
    steady = MachineDecider(STEADY.model_copy(update={"probing": Probing(**BEGIN)}), PROBLEM, np.zeros(6))
    steady.reset(np.arange(3), 1)
    steady.reset(np.arange(3, 6), 2)
    seen = np.zeros((6, 2), dtype=np.float32)
    assert steady.decide(seen).options.tolist() == [2, 2, 0, 2, 2, 0]
    seen[[0, 3, 4], 1] = 1.0
    assert steady.decide(seen).options.tolist() == [0, 2, 0, 0, 0, 0]

    def course(rows, first):
        decider = MachineDecider(STEADY, PROBLEM, np.zeros(rows), Probing(probability=0.2))
        decider.reset(np.arange(first, rows), 5)
        return np.array([decider.decide(np.zeros((rows, 2), dtype=np.float32)).options for _ in range(300)])[:, first:]

    alone = course(50, 0)
    np.testing.assert_array_equal(course(60, 10), alone)
    assert [np.mean(alone == option) for option in range(3)] == pytest.approx([0.8, 0.2, 0.0], abs=0.02)


def test_chance_that_holds_draws_every_option_alike_and_anew_every_eight_decisions():
    held = load_machine("random-held")
    options = tuple(dict.fromkeys(state.option for state in held.states.values()))
    decider = MachineDecider(held, Problem("ExplorationPatrol", options, np.zeros(7), ("any",)), np.zeros(2000))
    decider.reset(np.arange(2000), 3)
    chosen = np.array([decider.decide(np.zeros((2000, 1), dtype=np.float32)).options for _ in range(40)])
    for one in (chosen[0], chosen[-1]):
        assert np.bincount(one) / 2000 == pytest.approx(np.full(7, 1 / 7), abs=0.03)
    assert np.mean(chosen[1:] != chosen[:-1]) == pytest.approx(6 / 7 / 8, abs=0.003)


def test_a_machine_sees_the_terms_that_it_names():
    named = decider_named("fsm:recent-finds")
    assert [term.name for term in named.observation(()).terms][-1] == "recent_finds"
    assert [term.name for term in named.observation(("recent_finds",)).terms].count("recent_finds") == 1
