"""The tables of the pages are those of the code: names, units, defaults and meanings."""

import re

import pytest

from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.reward import RewardConfig, weights_of
from clean_swarm_env.tasks import TASKS, Cleaning
from clean_swarm_env.world.parts.measure import key_of
from selector.strategies.registry import STRATEGIES
from tests.fields import descriptions
from tests.pages import table, text_of

OURS = {cls.__name__: cls for cls in STRATEGIES if cls.__module__.startswith("selector.strategies.")}


def test_weights_of_rewards():
    rows = {row[0].strip("`"): row[1:] for row in table("docs/environment.md", "rewards")}
    about = descriptions(RewardConfig)
    assert list(rows) == list(weights_of(Cleaning).model_fields)
    for name, field in weights_of(Cleaning).model_fields.items():
        paid = about.get(name, "Shaping: each time that the info of this name counts [-].")
        assert rows[name] == [f"{field.default:g}", paid]


def test_tasks():
    expected = []
    for name in (name for name in TASKS.names() if name != "Cleaning"):
        batch = Batch(name)
        names, default = next(iter(batch.options.values())), int(batch.choices.default[0])
        measures = batch.worlds.task.measures
        options = ", ".join(f"`{one}`" for one in (names[default], *names[:default], *names[default + 1 :]))
        keys = ", ".join(f"`{key_of(measure.name)}`" for measure in measures)
        expected.append([f"`{name}`", options, keys])
    assert table("docs/tasks.md", "tasks") == expected


@pytest.mark.parametrize("name", OURS)
def test_parameters_of_strategies(name):
    (row,) = [line for line in text_of("docs/strategies.md").splitlines() if line.startswith(f"| `{name}` |")]
    stated, fields = row.split(" | ")[2], OURS[name].Parameters.model_fields
    assert set(re.findall(r"`(\w+)`", stated)) == set(fields)
    for field, details in fields.items():
        if not details.is_required():
            default = "no" if details.default is False else f"{details.default:g}"
            assert re.search(rf"`{field}` {re.escape(default)}(,|$)", stated.strip(" |")), (field, default)
