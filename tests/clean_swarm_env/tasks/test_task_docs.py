"""The examples of docs/goal_environments.md run, and its tables are those of the code."""

import re

import pytest
from clean_swarm_env.goals.goal_batch import GoalBatch
from clean_swarm_env.goals.observer import TERMS_OF_GOALS
from clean_swarm_env.goals.settings import key_of
from clean_swarm_env.scenes import find, goals

from tests.clean_swarm_env.courses import long_course
from tests.paths import ROOT

PAGE = (ROOT / "docs" / "goal_environments.md").read_text(encoding="utf-8")
EXAMPLES = re.findall(r"```python\n(.*?)```", PAGE, flags=re.DOTALL)


def rows(name):
    return PAGE.split(f"<!-- begin: {name} -->\n")[1].split(f"<!-- end: {name} -->")[0].splitlines()[2:]


@long_course
@pytest.mark.parametrize("example", EXAMPLES, ids=lambda text: text.split("\n")[0][:40])
def test_the_examples_run(example):
    exec(example, {})


def test_the_goals_on_the_page_are_those_of_the_code():
    expected = []
    for goal in goals():
        batch, measures = GoalBatch(goal), find(goal).measures
        names, default = batch.options[goal], int(batch.choices.default[0])
        options = ", ".join(f"`{name}`" for name in (names[default], *names[:default], *names[default + 1 :]))
        keys = ", ".join(f"`{key_of(measure.name)}`" for measure in measures)
        units = [f"{m.target:g}{'' if m.unit == '-' else f' {m.unit}'}" for m in measures]
        ends = [f"or {'less' if measure.better == 'lower' else 'more'}" for measure in measures]
        targets = ", ".join(f"{unit} {end}" for unit, end in zip(units, ends, strict=True))
        expected.append(f"| `{goal}` | {options} | {keys} | {targets} |")
    assert rows("goals") == expected


def test_the_terms_on_the_page_are_those_of_the_code():
    assert [row.split("`")[1] for row in rows("goal terms")] == list(TERMS_OF_GOALS)
    assert all(function.__doc__ for _, function in TERMS_OF_GOALS.values())
