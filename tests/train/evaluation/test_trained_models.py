"""What an environment trains, `evaluate` runs: models of Stable-Baselines3 on every mission and family that ships."""

import json
import zipfile
from dataclasses import replace
from importlib.util import find_spec

import numpy as np
import pytest

from clean_swarm_env.config.load import load_family
from clean_swarm_env.deciders.decided_goal import DecidedGoal
from clean_swarm_env.deciders.models import ModelDecider, TrainedOn, remembered, write_names
from clean_swarm_env.deciders.named import decider_named
from clean_swarm_env.learning.batch import Batch
from selector.documents.errors import DocumentError
from selector.documents.find import files_of
from train.evaluation.comparing import Comparing
from train.request import Request

pytest.importorskip("stable_baselines3", reason="needs the extra 'train'")

from stable_baselines3 import PPO, SAC
from stable_baselines3.common.vec_env import VecMonitor, VecNormalize

from clean_swarm_env.sb3 import RobotVecEnv

pytestmark = pytest.mark.extra
KINDS = {"family": files_of("families"), "mission": files_of("missions")}
FEW = [("family", "clustered"), ("mission", "table1")]
SHIPPED = [
    pytest.param(kind, name, marks=[] if (kind, name) in FEW else pytest.mark.long)
    for kind, names in KINDS.items()
    for name in names
]


def made(path, algorithm=PPO, **settings):
    """Save a model after one update, as a user does, and return its environment."""
    envs = VecNormalize(VecMonitor(RobotVecEnv(1, **settings)))
    tiny = {"policy_kwargs": {"net_arch": [4]}, "device": "cpu", "seed": 1}
    if algorithm is PPO:
        model = PPO("MlpPolicy", envs, n_steps=2, batch_size=2 * envs.num_envs, n_epochs=1, **tiny)
    else:
        model = algorithm("MlpPolicy", envs, learning_starts=0, gradient_steps=1, buffer_size=500, **tiny)
    model.learn(2 * envs.num_envs)
    model.save(path)
    envs.save(path.with_suffix(".pkl"))
    return envs


@pytest.fixture(scope="module")
def clustered(tmp_path_factory):
    """The file of a model of the family `clustered`."""
    path = tmp_path_factory.mktemp("clustered") / "sb3_ppo.zip"
    made(path, family="clustered")
    return path


def task(request):
    """Return the first task of the model of a request, cut short."""
    evaluation = Comparing(request)
    (own,) = (task for task in evaluation.tasks({}) if task.member.startswith("policy:"))
    short = [replace(each, mission=each.mission.model_copy(update={"time_limit": 3.0})) for each in own.scenarios]
    return replace(own, scenarios=tuple(short))


def settings_of(kind, name):
    tori = load_family(name).tori if kind == "family" else ()
    return {kind: name} | ({"size": tori[0]} if len(tori) > 1 else {})


@pytest.mark.parametrize(("kind", "name"), SHIPPED)
def test_a_model_of_any_mission_and_family_is_evaluated(kind, name, tmp_path):
    """The mission `table1` has other knowledge than the family of this name."""
    knowledge = "cleaning" if (kind, name) == ("mission", "table1") else None
    made(tmp_path / "model.zip", **settings_of(kind, name))
    own = task(Request(name, (f"policy:{tmp_path / 'model.zip'}",), 0, 1, knowledge))
    (record,) = own.run()
    assert record.result.duration_s <= 3.0
    assert own.settings.goal == "+".join(Batch(**settings_of(kind, name)).options)


@pytest.mark.parametrize(
    ("mode", "algorithm"),
    [
        ("velocity", SAC),
        ("both", PPO),
        pytest.param("velocity", PPO, marks=pytest.mark.long),
        pytest.param("both", SAC, marks=pytest.mark.long),
    ],
)
def test_models_that_steer_or_correct_are_evaluated(mode, algorithm, tmp_path):
    for name, goals in (("exploring", 2), ("bumpers", 1)):
        path = tmp_path / f"{name}.zip"
        envs = made(path, algorithm, mission=name, action={"mode": mode})
        assert decider_named(f"policy:{path}").mode == mode
        assert len(remembered(path).options) == (goals if mode == "both" else 0)
        (record,) = task(Request(name, (f"policy:{path}",), 0, 1)).run()
        assert record.result.duration_s <= 3.0
        assert envs.action_space.shape == ((2 + (mode == "both") * sum(envs.unwrapped.batches[0].choices.counts)),)


def test_options_and_observations_go_by_their_names(tmp_path):
    """A model of three options in another order, and of fewer terms, takes what it means."""
    observation = {"terms": ["cargo", "movement"]}
    envs = made(tmp_path / "m.zip", mission="table1", knowledge="avoidance", observation=observation)
    path, batch = tmp_path / "m.zip", Batch("table1", knowledge="avoidance")
    batch.reset([1])
    (goal,), names = batch.options, envs.observation_space.names
    evaluation = Comparing(Request("table1", (f"policy:{path}",), 0, 1, knowledge="avoidance"))
    problem = DecidedGoal(batch).problem
    decider, model = ModelDecider(path, "option", problem, np.zeros(1)), PPO.load(path, device="cpu")
    columns = [batch.observer.names.index(name) for name in names]
    own = envs.normalize_obs(batch.observations[:, columns])
    assert decider.decide(batch.observations).options.tolist() == model.predict(own, deterministic=True)[0].tolist()
    turned = problem.__class__(goal, problem.options[::-1], problem.scores, problem.features[::-1])
    backwards = ModelDecider(path, "option", turned, np.zeros(1)).decide(batch.observations[:, ::-1]).options
    last = len(problem.options) - 1
    assert backwards.tolist() == (last - decider.decide(batch.observations).options).tolist()
    assert evaluation.problem.goal == goal


def test_a_mismatch_names_what_is_missing(clustered, tmp_path):
    member = f"policy:{clustered}"
    assert decider_named(member).goal == "ExplorationPatrol+AvoidCollision"
    with pytest.raises(DocumentError, match=r"sb3_ppo\.zip: .*ExplorationPatrol") as told:
        Comparing(Request("crowded", (member,), 0, 1))
    assert "\n" not in str(told.value)
    made(tmp_path / "n.zip", mission="table1", knowledge="avoidance")
    with pytest.raises(DocumentError, match=r"n\.zip: options: knows .*ORCA.*, which does not exist here"):
        Comparing(Request("table1", (f"policy:{tmp_path / 'n.zip'}",), 0, 1, knowledge="repulsion"))
    made(tmp_path / "o.zip", mission="exploring", observation={"terms": ["yards", "finds"]})
    with pytest.raises(DocumentError, match=r"o\.zip: observations: knows .*, which does not exist here"):
        Comparing(Request("clustered", (f"policy:{tmp_path / 'o.zip'}",), 0, 1))


def test_names_are_read_without_running_anything_and_damage_has_none(clustered, tmp_path):
    with zipfile.ZipFile(clustered) as archive:
        content = json.loads(archive.read("data"))
    for space in ("observation_space", "action_space"):
        content[space][":serialized:"] = "never unpickled"
    with zipfile.ZipFile(tmp_path / "hostile.zip", "w") as archive:
        archive.writestr("data", json.dumps(content))
    assert remembered(tmp_path / "hostile.zip") == remembered(clustered) != TrainedOn()
    (tmp_path / "cut.zip").write_bytes(clustered.read_bytes()[:500])
    (tmp_path / "odd.zip").write_bytes(b"")
    (tmp_path / "list.json").write_text("[1]")
    for name in ("cut.zip", "odd.zip", "none.zip", "list.pt"):
        assert remembered(tmp_path / name) == TrainedOn()


@pytest.mark.skipif(find_spec("torch") is None, reason="needs the extra 'train'")
def test_names_beside_a_module_of_torch_make_it_an_entrant_of_several_goals_and_both_kinds(tmp_path):
    import torch

    envs = RobotVecEnv(1, mission="exploring", action={"mode": "both"})
    width, outputs = envs.observation_space.shape[0], envs.action_space.shape[0]
    layer, path = torch.nn.Linear(width, outputs), tmp_path / "m.pt"
    torch.jit.script(layer).save(path)
    write_names(path, envs.observation_space, envs.action_space)
    known = remembered(path)
    assert (known.mode, known.observations) == ("both", envs.observation_space.names)
    assert known.options == dict(envs.batches[0].options)
    (record,) = task(Request("exploring", (f"policy:{path}",), 0, 1)).run()
    assert record.result.duration_s <= 3.0
    seen = np.zeros((3, width), np.float32)
    batch = Batch("exploring", action={"mode": "both"})
    problem = DecidedGoal(batch, known.goal).problem
    decider = ModelDecider(path, known.mode, problem, np.zeros(1))
    options, vectors = decider.decide(seen)
    assert (options.shape, vectors.shape) == ((3,), (3, 2))
