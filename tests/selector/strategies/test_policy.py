import json
import re

import numpy as np
import pytest

from clean_swarm_env.deciders.strategies import PolicyDecider
from selector.documents.errors import DocumentError
from selector.knowledge import Definition
from selector.strategies.policy_file import Network, TrainedPolicy, load_policy, save_policy
from selector.strategies.probing import Probing
from selector.strategies.problem import Problem
from tests.selector.refusing import refusal
from tests.selector.strategies.policies import exported, untrained

OPTIONS, OBSERVATIONS = ("a", "b", "c"), tuple(f"x{k}" for k in range(7))
PROBLEM = Problem("Goal", OPTIONS, np.zeros(3), OBSERVATIONS)
OTHER = {"Goal": {"b": Definition(configuration="B")}}
TEAMS, CONTEXT = np.zeros(40, dtype=np.int64), np.random.default_rng(3).normal(size=(40, 7))


def several(goals, **changes):
    """Return a policy of several goals with random weights."""
    return untrained("", (), OBSERVATIONS, goals=goals, **changes)


def reference(policy, context):
    """Return the network's outputs, by plain float64 products."""
    spec, weights = policy.spec, policy.weights
    values = (context - np.array(spec.mean)) / np.sqrt(np.array(spec.variance) + spec.epsilon)
    values = np.clip(values, -spec.clip, spec.clip)
    for k in range(len(spec.hidden)):
        values = values @ weights[f"hidden.{k}.weight"].T.astype(float) + weights[f"hidden.{k}.bias"]
        values = np.tanh(values) if spec.activation == "tanh" else np.maximum(values, 0.0)
    return values @ weights["options.weight"].T.astype(float) + weights["options.bias"]


def network_of(directory):
    return Network(load_policy(directory))


@pytest.mark.parametrize("activation", ["tanh", "relu"])
@pytest.mark.parametrize("hidden", [(), (8,), (64, 64)])
def test_outputs_are_those_of_the_network(tmp_path, activation, hidden):
    policy = exported(tmp_path, "Goal", OPTIONS, OBSERVATIONS, activation=activation, hidden=hidden, clip=1.5)
    network = network_of(tmp_path)
    context = 3 * np.random.default_rng(0).normal(size=(200, 7))
    expected = reference(policy, context)
    np.testing.assert_allclose(network.heads(context)["options"], expected, atol=1e-4)
    chosen = network.heads(context)["options"].argmax(axis=1)
    clear = np.diff(np.sort(expected, axis=1))[:, -1] > 1e-3
    assert clear.sum() > 150
    np.testing.assert_array_equal(chosen[clear], expected.argmax(axis=1)[clear])


def test_components_of_vectors_are_at_most_one():
    context = np.random.default_rng(0).normal(size=(200, 7))
    policy = untrained("Goal", OPTIONS, OBSERVATIONS, vector=True)
    free, small = Network(policy).heads(context), policy.weights
    small |= {f"vector.{part}": small[f"vector.{part}"] * np.float32(0.125) for part in ("weight", "bias")}
    heads = Network(policy).heads(context)
    assert np.abs(heads["vector"]).max() < 1.0
    np.testing.assert_allclose(free["vector"], np.clip(8.0 * heads["vector"], -1.0, 1.0), atol=1e-5)


def test_a_row_gets_the_same_bits_alone_and_in_a_batch(tmp_path):
    exported(tmp_path, "Goal", OPTIONS, OBSERVATIONS, hidden=(64, 64))
    network = network_of(tmp_path)
    context = np.random.default_rng(0).normal(size=(333, 7))
    together = network.heads(context)["options"]
    for row in range(0, 333, 17):
        np.testing.assert_array_equal(network.heads(context[row : row + 1])["options"][0], together[row])


def test_other_orders_of_names_give_the_same_decisions(tmp_path):
    exported(tmp_path, "Goal", OPTIONS, OBSERVATIONS)
    context, teams = np.random.default_rng(0).normal(size=(200, 7)), np.zeros(200, dtype=np.int64)
    turned = Problem("Goal", OPTIONS[::-1], np.zeros(3), OBSERVATIONS[::-1])
    straight, other = (PolicyDecider(load_policy(tmp_path), problem, teams) for problem in (PROBLEM, turned))
    np.testing.assert_array_equal(2 - other.decide(context[:, ::-1]).options, straight.decide(context).options)
    np.testing.assert_allclose(other.opinions()[:, ::-1], straight.opinions())


def test_a_policy_samples_options_as_it_gives_them_where_its_file_or_the_caller_says_so(tmp_path):
    exported(tmp_path, "Goal", OPTIONS, OBSERVATIONS, probing=Probing(sampled=True))
    rows = 4000
    context = np.repeat(np.random.default_rng(6).normal(size=(1, 7)), rows, axis=0)
    read, many = load_policy(tmp_path), np.zeros(rows, dtype=np.int64)
    free, best = PolicyDecider(read, PROBLEM, many), PolicyDecider(read, PROBLEM, many, Probing())
    free.reset(np.arange(rows), 3)
    shares = np.bincount(free.decide(context).options, minlength=3) / rows
    likely = free.opinions()[0]
    np.testing.assert_allclose(shares, likely, atol=0.03)
    assert set(best.decide(context).options) == {int(likely.argmax())}
    rarest, seen = int(likely.argmin()), dict(zip(OBSERVATIONS, context[0].tolist(), strict=True))
    told = free.moves(seen, {"Goal": OPTIONS[rarest]})["Goal"]
    assert (told["option"], told["sampled"], round(told["probability"], 6)) == (
        OPTIONS[rarest],
        True,
        round(likely[rarest], 6),
    )
    told = best.moves(seen, {"Goal": OPTIONS[rarest]})["Goal"]
    assert (told["option"], told["sampled"]) == (OPTIONS[rarest], False)
    told = free.moves(seen, {"Goal": "what it began with"})["Goal"]
    assert (told["option"], told["sampled"]) == (OPTIONS[int(likely.argmax())], False)


def test_what_is_written_is_read_again(tmp_path):
    policy = exported(tmp_path, "Goal", OPTIONS, OBSERVATIONS, training={"seed": 3, "command": "clean-swarm train ppo"})
    read = load_policy(tmp_path)
    assert read.spec.model_copy(update={"weights_sha256": ""}) == policy.spec
    assert read.weights.keys() == policy.weights.keys()
    for name, array in policy.weights.items():
        np.testing.assert_array_equal(read.weights[name], array)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["policy.json", "policy.safetensors"]


@pytest.mark.parametrize(
    ("problem", "message"),
    [
        (Problem("Other", OPTIONS, np.zeros(3), OBSERVATIONS), "goals: expected Other, got Goal"),
        (Problem("Goal+Other", ("a+x", "b+x"), np.zeros(2), OBSERVATIONS), "goals: expected Goal, Other, got Goal"),
        (Problem("Goal", ("d", "e"), np.zeros(2), OBSERVATIONS), "Goal: options: expected some of d, e, got a, b, c"),
        (Problem("Goal", OPTIONS, np.zeros(3), OBSERVATIONS[2:]), "observations: unknown component 'x0'"),
        (
            Problem("Goal", OPTIONS, np.zeros(3), OBSERVATIONS, definitions=OTHER),
            "Goal: option 'b': expected A {}, got B {}",
        ),
    ],
)
def test_a_policy_for_something_else_says_what_differs(tmp_path, problem, message):
    exported(tmp_path, "Goal", OPTIONS, OBSERVATIONS)
    with pytest.raises(DocumentError, match=message):
        PolicyDecider(load_policy(tmp_path), problem, np.zeros(1, dtype=np.int64))


def edit(directory, **changes):
    path = directory / "policy.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | changes))


def damage(directory):
    path = directory / "policy.safetensors"
    content = bytearray(path.read_bytes())
    content[-1] ^= 1
    path.write_bytes(content)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda d: (d / "policy.json").write_text("{"), r"policy\.json: line 1: .*expected JSON"),
        (lambda d: (d / "policy.json").write_text("[]"), r"policy\.json: expected a mapping of keys"),
        (lambda d: (d / "policy.safetensors").unlink(), r"policy\.safetensors: cannot be read"),
        (damage, r"policy\.json: weights_sha256: expected that of policy\.safetensors"),
        (lambda d: edit(d, version=3), "version: expected 1, got 3"),
        (lambda d: edit(d, mean=[0.0]), "mean: expected 7 numbers, one an observation, got 1"),
        (lambda d: edit(d, luck=7), "luck: unknown key"),
        (lambda d: edit(d, probing={"probability": -0.1}), "probing.probability: expected"),
        (lambda d: edit(d, activation="sine"), "activation: expected 'tanh' or 'relu', got 'sine'"),
        (lambda d: edit(d, hidden=[5, 9]), r"hidden\.1\.weight: expected \(9, 5\) of float32, got \(4, 5\)"),
        (lambda d: edit(d, version=2), "version: expected 1, got 2"),
        (lambda d: edit(d, holds={"Other": 2}), "holds: unknown goal 'Other'"),
        (lambda d: edit(d, holds={"Goal": 0}), "holds.Goal: expected"),
        (lambda d: edit(d, goals={"Goal": ["a", "a"]}), "goals: Goal: expected each option once"),
        (lambda d: edit(d, goals={"Goal": []}), "goals.Goal"),
        (lambda d: edit(d, goals={}), "goals: expected at least one, or a vector, got none"),
        (lambda d: edit(d, goals={"Goal": ["a", "b"]}), "options.weight: expected"),
        (
            lambda d: edit(d, goals={"Goal": ["a", "d"]}),
            r"definitions: Goal: expected those of all .*, got none of \['d'\]",
        ),
        (lambda d: edit(d, terms=["evil:Term"]), "terms.0"),
        (lambda d: edit(d, hidden=[5]), r"weights: knows hidden\.1\.bias, hidden\.1\.weight, which"),
    ],
)
def test_files_that_do_not_fit_are_one_line(tmp_path, change, message):
    exported(tmp_path, "Goal", OPTIONS, OBSERVATIONS)
    change(tmp_path)
    assert re.search(message, refusal(load_policy, tmp_path))


def test_weights_that_are_not_numbers_are_not_written(tmp_path):
    policy = untrained("Goal", OPTIONS, OBSERVATIONS)
    policy.weights["options.bias"][1] = np.nan
    with pytest.raises(DocumentError, match=r"options\.bias: expected finite numbers, got nan"):
        save_policy(tmp_path / "new", policy)
    assert not (tmp_path / "new").exists()
    with pytest.raises(DocumentError, match="weights: does not know hidden"):
        save_policy(tmp_path / "new", TrainedPolicy(policy.spec, {}))


def test_a_policy_of_several_goals_decides_those_that_there_are():
    goals = {"A": ("a", "b"), "B": ("x", "y", "z"), "C+D": ("k+m", "l+n")}
    policy = several(goals)
    outputs = np.split(Network(policy).heads(CONTEXT)["options"], [2, 5], axis=1)
    likeliest = [part.argmax(axis=1) for part in outputs]
    joint = Problem("B+A", tuple(f"{b}+{a}" for b in "zyxw" for a in "ba"), np.zeros(8), OBSERVATIONS)
    decided = PolicyDecider(policy, joint, TEAMS).decide(CONTEXT).options
    names = [joint.options[number] for number in decided]
    assert names == [f"{'xyz'[b]}+{'ab'[a]}" for a, b in zip(likeliest[0], likeliest[1], strict=True)]
    alone = Problem("A", ("b", "c"), np.zeros(2), OBSERVATIONS)
    decider = PolicyDecider(policy, alone, TEAMS)
    assert set(decider.decide(CONTEXT).options) == {0}  # it does not know c
    assert (decider.opinions() == [1.0, 0.0]).all()
    pairs = Problem("C+D", ("l+n", "k+n", "k+m"), np.zeros(3), OBSERVATIONS)
    decided = PolicyDecider(policy, pairs, TEAMS).decide(CONTEXT).options
    assert [pairs.options[number] for number in decided] == [goals["C+D"][k] for k in likeliest[2]]


def test_a_policy_holds_the_options_of_a_goal():
    policy = several({"A": ("a", "b"), "B": ("x", "y", "z")}, holds={"B": 3})
    problem = Problem("A+B", tuple(f"{a}+{b}" for a in "ab" for b in "xyz"), np.zeros(6), OBSERVATIONS)
    free = PolicyDecider(several({"A": ("a", "b"), "B": ("x", "y", "z")}), problem, TEAMS)
    held = PolicyDecider(policy, problem, TEAMS)
    expected = np.zeros(len(TEAMS), dtype=np.int64)
    for period in range(8):
        seen = np.random.default_rng(period).normal(size=CONTEXT.shape)
        if period == 5:
            held.reset(np.array([0]), seed=1)  # a row that begins anew chooses anew
        a, b = np.divmod(free.decide(seen).options, 3)
        fresh = np.full(len(TEAMS), period % 3 == 0)
        fresh[0] |= period == 5
        fresh[0] &= period != 6
        expected = np.where(fresh, b, expected)
        np.testing.assert_array_equal(held.decide(seen).options, 3 * a + expected)
