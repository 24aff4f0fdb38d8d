"""The tables of the pages are those of the code: names, units, defaults and meanings."""

import re
from typing import get_args

import pytest

import selforg.components
from clean_swarm_env import clean_swarm_v0
from clean_swarm_env.config.load import load_family
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.config.starts import random_start
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.observation.config import DEFAULT_TERMS
from clean_swarm_env.learning.observation.term import TERMS
from clean_swarm_env.learning.reward import RewardConfig
from clean_swarm_env.recording.by_hand import ByHand
from clean_swarm_env.recording.reader import RecordedMission
from clean_swarm_env.recording.recorder import RecordSettings, record_mission
from clean_swarm_env.tasks import TASKS, Task
from clean_swarm_env.tasks.cleaning.settings import ConsequencesConfig
from clean_swarm_env.world.measure import key_of
from clean_swarm_env.world.mission import MissionRun
from selector.knowledge import load_knowledge
from selector.strategies.registry import STRATEGIES
from selforg.components import ACTIONS, SENSORS
from tests.clean_swarm_env.courses import mission
from tests.clean_swarm_env.recording.shepherding import with_shepherding
from tests.fields import descriptions
from tests.pages import table, text_of

OURS = {cls.__name__: cls for cls in STRATEGIES if cls.__module__.startswith("selector.strategies.")}


def first_words(page, heading):
    """Return the names in the first column of the tables below a heading."""
    part = text_of(page).partition(f"## {heading}\n")[2].partition("\n## ")[0]
    return re.findall(r"^\| `([\w-]+)` \|", part, flags=re.MULTILINE)


def test_terms_of_the_environment():
    rows = {row[0].strip("`"): row[1:] for row in table("docs/environment.md", "terms")}
    assert list(rows) == list(DEFAULT_TERMS)
    for name, (meaning, components, *_) in rows.items():
        term = TERMS.find(name)
        assert meaning == term.meaning()
        assert not term.components or re.findall(r"`(\w+)`", components) == list(term.components)


def test_weights_of_rewards():
    rows = {row[0].strip("`"): row[1:] for row in table("docs/environment.md", "rewards")}
    assert list(rows) == list(RewardConfig.model_fields)
    for name, description in descriptions(RewardConfig).items():
        assert rows[name] == [f"{RewardConfig.model_fields[name].default:g}", description]


def test_ways_to_explore_and_to_carry():
    explore, carry = load_knowledge("exploring"), load_knowledge("transport")
    assert set(first_words("docs/exploring.md", "Ways to explore")) == {
        option.name for option in explore.options("ExplorationPatrol")
    }
    assert first_words("docs/transport.md", "Ways to carry") == [one.name for one in carry.options("Transport")]


def test_families_of_exploring():
    named = first_words("docs/exploring.md", "Families")
    assert named == ["clustered", "hotspots", "rare", "crowded-exploring", "unseen-exploring"]
    for name in named:
        family = load_family(name)
        assert family.mission.knowledge == "exploring"
        if name != "crowded-exploring":
            assert family.spots == (0, 1)
            kinds = [len(family.scenario(1, k, "test").mission.task.garbage.spots) for k in range(100)]
            assert 35 <= sum(kinds) <= 65


def test_channels_of_recordings(tmp_path, monkeypatch):
    with_shepherding(monkeypatch)
    cleaning = mission(time_limit=1.0, delivery={"loss": 0.5}, consequences={"stop": 5.0})
    other = MissionConfig.model_validate({"task": "Shepherding", "time_limit": 1.0})
    channels = {}
    for each in (cleaning, other):
        run = MissionRun(each, random_start(each, 1, 0), 2, {})
        policies = {"policy:any": {"observations": ("idle",)}}
        record_mission(run, RecordSettings(tmp_path, minds=True, name=each.name, policies=policies), {})
        channels |= RecordedMission(tmp_path / f"{each.name}.swarm").channels
    rows = table("docs/recordings.md", "channels")
    shown = {name: (unit, about) for names, _, unit, about in rows for name in re.findall(r"`([^`]+)`", names)}
    coded = {}
    for name, channel in channels.items():
        of_network = re.sub(r"^(?!held|opinion).*/(\w+)$", r"NETWORK/\1", name)
        coded[re.sub(r"^(held|opinion)/.*", r"\1/GOAL", of_network)] = channel.unit, channel.about
    assert shown == coded


def test_tasks():
    expected = []
    for name in (name for name in TASKS.names() if name != "Cleaning"):
        batch = Batch(name)
        names, default = next(iter(batch.options.values())), int(batch.choices.default[0])
        measures = batch.worlds.task.measures
        options = ", ".join(f"`{one}`" for one in (names[default], *names[:default], *names[default + 1 :]))
        keys = ", ".join(f"`{key_of(measure.name)}`" for measure in measures)
        units = [f"{m.target:g}{'' if m.unit == '-' else f' {m.unit}'}" for m in measures]
        ends = [f"or {'less' if measure.better == 'lower' else 'more'}" for measure in measures]
        targets = ", ".join(f"{unit} {end}" for unit, end in zip(units, ends, strict=True))
        expected.append([f"`{name}`", options, keys, targets])
    assert table("docs/tasks.md", "tasks") == expected


def test_terms_of_tasks():
    expected = []
    for name in Task.terms:
        seen = Batch("Foraging", observation={"terms": [name]}).observer.names if name != "task" else ()
        components = ", ".join(f"`{component}`" for component in seen) or "none"
        expected.append([f"`{name}`", TERMS.find(name).meaning(), components])
    assert table("docs/tasks.md", "terms") == expected


def test_infos_of_tasks():
    env = clean_swarm_v0.parallel_env({"task": "Foraging", "time_limit": 2.0})
    env.reset(seed=1)
    infos = env.step(dict.fromkeys(env.agents, 0))[-1]["robot_0"]
    part = text_of("docs/tasks.md").partition("## Infos")[2]
    listed = re.findall(r"`(\w+)`", "".join(re.findall(r"^\| (`.*?) \|", part, re.MULTILINE)))
    assert set(infos) - {"items_brought_per_minute"} == set(listed) - set(Task.terms)


@pytest.mark.parametrize("name", OURS)
def test_parameters_of_strategies(name):
    (row,) = [line for line in text_of("docs/strategies.md").splitlines() if line.startswith(f"| `{name}` |")]
    stated, fields = row.split(" | ")[2], OURS[name].Parameters.model_fields
    assert set(re.findall(r"`(\w+)`", stated)) == set(fields)
    for field, details in fields.items():
        if not details.is_required():
            default = "no" if details.default is False else f"{details.default:g}"
            assert re.search(rf"`{field}` {re.escape(default)}(,|$)", stated.strip(" |")), (field, default)


def test_names_of_strategies():
    names = re.findall(r"^\| `(\w+)` \|", text_of("docs/strategies.md"), re.MULTILINE)
    assert set(names) == set(OURS) | {"baseline"}


def test_changes_by_hand():
    rows = re.findall(r"^\| `(\w+)` \| (`.*`) \| (.*) \|$", text_of("docs/play.md"), flags=re.MULTILINE)
    shown = {do: (set(re.findall(r"`(\w+)`", names)), about) for do, names, about in rows}
    (union, *_) = get_args(ByHand)
    coded = {}
    for change in get_args(union):
        (do,) = get_args(change.model_fields["do"].annotation)
        coded[do] = (set(change.model_fields) - {"do", "tick"}, change.__doc__)
    assert shown == coded


def test_consequences_of_collisions():
    shown = dict(re.findall(r"^\| `(\w+)` \| (\w[\w.]*)", text_of("docs/cost.md"), flags=re.MULTILINE))
    coded = {name: field.default for name, field in ConsequencesConfig.model_fields.items()}
    assert {name: text if text == "false" else float(text) for name, text in shown.items()} == {
        name: "false" if default is False else default for name, default in coded.items()
    }


def test_components():
    types = [cls.__name__ for cls in (*SENSORS, *ACTIONS) if cls.__module__.startswith("selforg.")]
    assert types != []
    assert [name for name in types if f"`{name}`" not in text_of("docs/selector.md")] == []
    section = text_of("docs/network.md").split("## Mechanisms in the network")[1].split("```")[0]
    named = re.findall(r"`([A-Z]\w+)`", section)
    assert named != []
    assert [name for name in named if not hasattr(selforg.components, name)] == []
