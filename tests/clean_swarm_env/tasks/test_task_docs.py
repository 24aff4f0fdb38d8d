"""The examples of docs/tasks.md and docs/own_task.md run, and the tables of tasks and terms are those of the code."""

import re

import pytest

from clean_swarm_env import clean_swarm_v0
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.observation.term import TERMS
from clean_swarm_env.tasks import TASKS, Task
from clean_swarm_env.world.measure import key_of
from tests.clean_swarm_env.courses import long_course
from tests.paths import ROOT

PAGE = (ROOT / "docs" / "tasks.md").read_text(encoding="utf-8")
EXAMPLES = re.findall(r"```python\n(.*?)```", PAGE, flags=re.DOTALL)


def rows(name):
    return PAGE.split(f"<!-- begin: {name} -->\n")[1].split(f"<!-- end: {name} -->")[0].splitlines()[2:]


@long_course
@pytest.mark.parametrize("example", EXAMPLES, ids=lambda text: text.split("\n")[0][:40])
def test_the_examples_run(example):
    exec(example, {})


def test_the_example_of_a_task_of_ones_own_runs(monkeypatch):
    page = (ROOT / "docs" / "own_task.md").read_text(encoding="utf-8")
    monkeypatch.chdir(ROOT)
    monkeypatch.setenv("CLEAN_SWARM_IMPORT", "")
    monkeypatch.setattr(TASKS, "_classes", dict(TASKS._classes))
    exec(re.findall(r"```python\n(.*?)```", page, flags=re.DOTALL)[0], {})
    assert Batch({"task": {"name": "Shepherding", "sheep": 30}}).worlds.task.around[1].count == 30


def test_the_tasks_on_the_page_are_those_of_the_code():
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
        expected.append(f"| `{name}` | {options} | {keys} | {targets} |")
    assert rows("tasks") == expected


def test_the_terms_on_the_page_are_those_of_the_code():
    expected = []
    for name in Task.terms:
        seen = Batch("Foraging", observation={"terms": [name]}).observer.names if name != "task" else ()
        components = ", ".join(f"`{component}`" for component in seen) or "none"
        expected.append(f"| `{name}` | {TERMS.find(name).meaning()} | {components} |")
    assert rows("terms") == expected


def test_the_infos_on_the_page_are_those_of_the_code():
    env = clean_swarm_v0.parallel_env({"task": "Foraging", "time_limit": 2.0})
    env.reset(seed=1)
    infos = env.step(dict.fromkeys(env.agents, 0))[-1]["robot_0"]
    listed = re.findall(r"`(\w+)`", "".join(re.findall(r"^\| (`.*?) \|", PAGE.partition("## Infos")[2], re.MULTILINE)))
    assert set(infos) - {"items_brought_per_minute"} == set(listed) - set(Task.terms)
