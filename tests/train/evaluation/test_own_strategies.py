"""Strategies of one's own and models of other libraries take part in evaluations, and mistakes are one line."""

import sys
from contextlib import nullcontext
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
import yaml

from clean_swarm_env.clean_swarm_v0 import parallel_env
from clean_swarm_env.config.load import load_family, load_mission
from clean_swarm_env.deciders.decided_goal import DecidedGoal
from clean_swarm_env.deciders.models import LOADERS
from clean_swarm_env.deciders.named import decider_named
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.robots.process import RobotProcess
from selector.documents.errors import DocumentError
from selector.documents.find import files_of
from selector.strategies.policy_file import save_policy
from selector.strategies.problem import Problem
from selector.strategies.registry import spec_from_text
from tests.paths import TRAINED
from tests.selector.strategies.policies import untrained
from train.evaluation.comparing import Comparing
from train.evaluation.comparison import Deciders
from train.evaluation.conditions import UNTAUGHT, check_fit, conditions_of, remarks_on
from train.evaluation.repeat import steps_of
from train.live.chosen import chosen
from train.live.session import Session
from train.request import Request

PROBLEM = Problem("AvoidCollision", ("Fernandez", "Gradient"), np.array([1.0, 0.5]), ("near", "far"))
TEAMS = np.zeros(3, dtype=np.int64)
OWN = """
import numpy as np
from selector.strategies.strategy import DecisionStrategy

class Second(DecisionStrategy):
    option: int = 1

    def _select(self, decisions):
        return np.full(len(decisions.rows), self.option)
"""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    (tmp_path / "own_policies.py").write_text(OWN)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [*sys.path])  # to which an import adds the working directory
    monkeypatch.delitem(sys.modules, "own_policies", raising=False)  # another test's
    return tmp_path


@pytest.mark.parametrize("module", ["own_policies", "{folder}/own_policies.py"])
def test_a_class_of_ones_own_decides(folder, module):
    name = f"{module.format(folder=folder)}:Second"
    seen = np.zeros((3, 2), dtype=np.float32)
    assert decider_named(name).build(PROBLEM, TEAMS).decide(seen).options.tolist() == [1, 1, 1]
    assert decider_named(f"{name}:option=0").build(PROBLEM, TEAMS).decide(seen).options.tolist() == [0, 0, 0]
    assert spec_from_text(f"{name}:option=0,sharing=team").sharing == "team"
    before = decider_named(name).identity
    (folder / "own_policies.py").write_text(OWN + "# changed\n")
    assert decider_named(name).identity != before


@pytest.mark.parametrize(
    ("member", "message"),
    [
        ("own_policies:Third", "strategy: own_policies defines no 'Third'"),
        ("own_policies:np", "strategy own_policies:np: expected a subclass of DecisionStrategy, got <module"),
        ("no_policies:Third", "strategy: no_policies: no such file of Python code"),
        ("own_policies:Second:speed=1", "speed: unknown key 'speed'"),
        ("policy:model.zip", "model.zip: no such file"),
        ("policy:broken.onnx", r"broken.onnx: .*(onnxruntime|expected a model)"),
    ],
)
def test_mistakes_are_one_line(folder, member, message):
    (folder / "broken.onnx").write_bytes(b"no model")
    with pytest.raises(DocumentError, match=message) as told:
        decider_named(member).build(PROBLEM, TEAMS)
    assert "\n" not in str(told.value)


def test_a_family_without_the_options_of_a_policy_is_one_line(tmp_path):
    (tmp_path / "one.yaml").write_text("goals: {AvoidCollision: [{name: ORCA, score: 1.0}]}")
    with pytest.raises(DocumentError, match="--strategy policy:general: policy: AvoidCollision: options: ") as told:
        Comparing(Request("table1", ("policy:general",), 0, 1, str(tmp_path / "one.yaml"), directories=(TRAINED,)))
    assert "\n" not in str(told.value)


def test_strategies_that_have_learned_nothing_are_named():
    given = ("fixed", "fsm:rule", "UCB1", "mine=GaussianThompson", "Random", "learned:rules", "policy:general")
    told = remarks_on(conditions_of(given, PROBLEM.options), Batch("table1", knowledge="repulsion"), None, (TRAINED,))
    assert told == [f"UCB1: {UNTAUGHT}", f"mine: {UNTAUGHT}"]


@pytest.mark.parametrize("family", files_of("families"))
def test_the_policy_for_all_goals_fits_every_family(family):
    batch = Batch(load_family(family).scenario(0, 0, "test").mission)
    check_fit("one", Deciders(members=("policy:one",)), batch, None, ())
    decided = DecidedGoal(batch, decider_named("policy:one").decides(None)).problem.goal
    assert set(decided.split("+")) == set(batch.options)


def test_a_policy_decides_the_goals_that_it_was_made_for_and_says_so():
    batch, both = Batch(family="clustered"), "AvoidCollision+ExplorationPatrol"
    name, policy = "policy:exploring-ppo", Deciders(members=("policy:exploring-ppo",))
    decided = ["policy:exploring-ppo: decides ExplorationPatrol; AvoidCollision held ORCA"]
    for goal in (None, "ExplorationPatrol"):
        assert check_fit(name, policy, batch, goal, ()) == decided
    one = ["policy:one: decides AvoidCollision and ExplorationPatrol"]
    assert check_fit("policy:one", Deciders(members=("policy:one",)), batch, both, ()) == one
    with pytest.raises(DocumentError, match="goals: expected AvoidCollision, ExplorationPatrol, got Explor"):
        check_fit(name, policy, batch, both, ())


@pytest.fixture
def ahead(folder, monkeypatch):
    """A model that lets all robots drive ahead and slightly to the left, as a file `ahead.const`."""
    (folder / "ahead.const").write_text("0.9 0.1")
    monkeypatch.setitem(LOADERS, ".const", lambda path: lambda seen: np.tile(np.loadtxt(path), (len(seen), 1)))
    return "velocity:ahead.const"


def short(name, seconds=60.0, **changes):
    """Return a family whose missions end after that time [s] at the latest."""
    family = load_family(name)
    mission = family.mission.model_copy(update={"time_limit": seconds, **changes})
    return family.model_copy(update={"mission": mission})


def test_a_model_that_steers_has_the_missions_of_an_environment_with_vectors(ahead):
    request = Request("table1", (ahead,), 3, scenarios=2)
    evaluation = Comparing(request, short("table1"))
    (task,) = (task for task in evaluation.tasks({}) if task.member == ahead)
    for number, record in enumerate(task.run()):
        scenario = evaluation.document.scenario(3, number, "test")
        env = parallel_env(scenario.mission, action={"mode": "velocity"})
        env.reset(seed=scenario.seed, options={"start": scenario.start})
        while env.agents:
            infos = env.step({agent: np.array([0.9, 0.1], dtype=np.float32) for agent in env.agents})[-1]
        last = infos["robot_0"]
        assert (record.result.garbage_done, record.result.completed) == (last["garbage_done"], last["completed"])
        assert record.result.duration_s == last["duration_s"]
    assert sum(1 for _ in steps_of(task)) == task.run()[0].result.ticks


def constant(folder, batch, options, vector):
    """Write a policy that always prefers the second option and gives a vector, where it has them; return its name."""
    policy = untrained("AvoidCollision", options, batch.observer.names, hidden=(), vector=vector is not None)
    for weights in policy.weights.values():
        weights[:] = 0.0
    if options:
        policy.weights["options.bias"][1] = 1.0
    if vector is not None:
        policy.weights["vector.bias"][:] = vector
    directory = folder / f"policy-{len(options)}-{vector}"
    save_policy(directory, policy)
    return f"policy:{directory}"


def test_a_policy_that_steers_corrects_or_both_is_evaluated_as_what_it_gives(folder, ahead):
    plain, driven = Batch(family="table1-starts"), Batch("table1", action={"mode": "velocity"})
    options = plain.options["AvoidCollision"]
    Path("ahead.const").write_text("0.75 0.125")  # the same in float32
    steering = constant(folder, driven, (), [0.75, 0.125])
    still, moved = (constant(folder, plain, options, vector) for vector in ([0.0, 0.0], [0.3, 0.0]))
    request = Request("table1-starts", (ahead, steering, f"fixed:{options[1]}", still, moved), 3, scenarios=2)
    tasks = Comparing(request, short("table1-starts")).tasks({})[:5]
    assert [task.named.mode for task in tasks] == ["velocity", "velocity", "option", "both", "both"]
    runs = [[record.result for record in task.run()] for task in tasks]
    assert runs[0] == runs[1]
    assert runs[2] == runs[3] != runs[4]


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        (
            "ahead.const",
            "1 2 3",
            r"velocity:ahead.const: ahead.const: expected a model of \d+ numbers and a vector, got .*3",
        ),
        ("ahead.const", "nan 0", "expected a model of .* a vector, got actions: expected finite numbers"),
        ("none.const", "", r"velocity:none.const: none.const: no such file"),
        ("", "", r"velocity:: expected the path of a file after the colon"),
        ("ahead.md", "", r"ahead.md: expected a file that ends in \.zip, "),
    ],
)
def test_a_model_that_steers_has_to_be_there_and_must_give_vectors(ahead, name, text, message):
    if name not in ("none.const", ""):
        Path(name).write_text(text)
    with pytest.raises(DocumentError, match=message):
        Comparing(Request("table1", (f"velocity:{name}",), 3, scenarios=2))


def models(folder):
    """Write a model of each kind that prefers the second option where `near` is above `far`."""
    import torch

    layer = torch.nn.Linear(2, 2)
    with torch.no_grad():
        layer.weight[:] = torch.tensor([[0.0, 1.0], [1.0, 0.0]])
        layer.bias[:] = 0.0
    torch.jit.script(layer).save(folder / "model.pt")
    if find_spec("onnx") and find_spec("onnxruntime"):
        import onnx

        weights = onnx.numpy_helper.from_array(np.array([[0.0, 1.0], [1.0, 0.0]], dtype=np.float32), "w")
        shapes = [onnx.helper.make_tensor_value_info(n, onnx.TensorProto.FLOAT, ["R", 2]) for n in ("x", "y")]
        graph = onnx.helper.make_graph(
            [onnx.helper.make_node("MatMul", ["x", "w"], ["y"])], "g", shapes[:1], shapes[1:], [weights]
        )
        opset = [onnx.helper.make_opsetid("", 17)]
        onnx.save(onnx.helper.make_model(graph, opset_imports=opset, ir_version=10), folder / "model.onnx")
    return sorted(path.name for path in folder.glob("model.*"))


@pytest.mark.parametrize(
    ("family", "strategy", "goal", "line"),
    [
        ("table1", "policy:one", None, "ExplorationPatrol, .*: --goal AvoidCollision lets it decide that alone; "),
        ("table1", "fsm:recent-finds", None, "; network: {robot: cleaning-patrol} in the mission, with knowledge"),
        ("table1", "policy:exploring-ppo", None, "which these robots do not choose options for: network: {robot: "),
        ("table1", "policy:one", "AvoidCollision", ""),
    ],
)
def test_a_policy_for_goals_that_a_mission_does_not_let_it_decide_is_an_error(
    family, strategy, goal, line, monkeypatch
):
    if line:  # before there are worlds, for which kernels compile
        monkeypatch.delattr("train.evaluation.comparing.Batch")
    with pytest.raises(DocumentError, match=line) if line else nullcontext() as told:
        Comparing(Request(family, (strategy,), 0, 1, goal=goal))
    assert told is None or "\n" not in str(told.value)


@pytest.mark.parametrize(("name", "fewest"), [("unseen", 6), ("table1", 5)])
@pytest.mark.parametrize("label", ["", "mine="])
def test_more_probing_robots_than_the_smallest_team_has_are_refused_where_the_mission_is_read(
    name, fewest, label, tmp_path, monkeypatch
):
    file = tmp_path / "probing.yaml"

    def asked(robots):
        probing = {"robots": robots, "option": "Off", "until": "free_near"}
        machine = {"goal": "AvoidCollision", "start": "on", "states": {"on": {"option": "ORCA"}}, "probing": probing}
        file.write_text(yaml.safe_dump(machine))
        return Request(name, (f"{label}fsm:{file}",), 0, 1, goal="AvoidCollision", knowledge="avoidance")

    Comparing(asked(fewest))
    monkeypatch.setattr("train.evaluation.comparing.check_fit", None)
    with pytest.raises(DocumentError) as error:
        Comparing(asked(fewest + 1))
    where = f"--strategy {label[:-1] or f'fsm:{file}'}: probing.robots"
    expected = f"expected at most {fewest}, the robots of the smallest team, got {fewest + 1}"
    assert str(error.value) == f"{where}: {expected}"
    with pytest.raises(DocumentError, match=r"probing\.yaml: probing\.robots: expected at most 5"):
        Session(chosen("table1", 1, 0, f"fsm:{file}", (), "avoidance"), tmp_path / "run.swarm", minds=False)
    hall = load_mission("table1").model_copy(update={"knowledge": "avoidance"})
    with pytest.raises(DocumentError, match=r"probing\.yaml: probing\.robots: expected at most 5"):
        RobotProcess(hall, 0, strategy=f"fsm:{file}")


@pytest.mark.extra
@pytest.mark.skipif(find_spec("torch") is None, reason="needs the extra 'train'")
def test_models_of_torch_and_onnx_decide_and_must_fit(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    seen = np.array([[1.0, 0.0], [0.0, 1.0], [0.5, 0.0]], dtype=np.float32)
    three = Problem("AvoidCollision", ("a", "b", "c"), np.ones(3), ("near", "far"))
    wide = Problem("AvoidCollision", ("a", "b"), np.ones(2), ("near", "far", "alone"))
    assert set(LOADERS) == {".zip", ".pt", ".onnx"}
    for name in models(tmp_path):
        assert decider_named(f"policy:{name}").build(PROBLEM, TEAMS).decide(seen).options.tolist() == [1, 0, 1]
        for other in (three, wide):
            expected = rf"{name}: expected a model of {len(other.features)} numbers"
            with pytest.raises(DocumentError, match=expected) as told:
                decider_named(f"policy:{name}").build(other, TEAMS)
            assert "\n" not in str(told.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("=fixed:ORCA", "--strategy =fixed:ORCA: label: "),
        ("two\nlines=fixed:ORCA", "label: "),
        ("Random=fixed:ORCA", "--strategy Random=...: expected another label, since a baseline has this one"),
    ],
)
def test_labels_are_names_and_not_those_of_baselines(text, message):
    with pytest.raises(DocumentError) as error:
        Comparing(Request("table1-starts", (text,), 0, 1))
    assert message in str(error.value)
    assert len(str(error.value).splitlines()) == 1
