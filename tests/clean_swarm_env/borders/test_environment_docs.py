"""The examples of docs/environment.md run, and its tables are those of the code."""

import re
from importlib.util import find_spec

import pytest

from clean_swarm_env.learning.observation.config import DEFAULT_TERMS, TRUE_TERMS
from clean_swarm_env.learning.observation.term import TERMS
from clean_swarm_env.learning.reward import RewardConfig
from tests.clean_swarm_env.courses import long_course
from tests.fields import descriptions
from tests.paths import ROOT

PAGE = (ROOT / "docs" / "environment.md").read_text(encoding="utf-8")
EXAMPLES = re.findall(r"```python\n(.*?)```", PAGE, flags=re.DOTALL)


def table(name):
    rows = PAGE.split(f"<!-- begin: {name} -->\n")[1].split(f"<!-- end: {name} -->")[0].splitlines()[2:]
    return [[cell.strip() for cell in row.strip("|").split("|")] for row in rows]


@long_course
@pytest.mark.parametrize("example", EXAMPLES, ids=lambda text: text.split("\n")[0][:40])
def test_the_examples_run(example):
    if re.search("stable_baselines3|clean_swarm_env.sb3", example) and find_spec("stable_baselines3") is None:
        pytest.skip("needs the extra 'train'")
    exec(example, {})


def test_all_terms_are_on_the_page_as_they_are():
    rows = {row[0].strip("`"): row[1:] for row in table("terms")}
    assert list(rows) == [*DEFAULT_TERMS, *TRUE_TERMS]
    for name in rows:
        term = TERMS.find(name)
        assert rows[name][0] == term.meaning()
        if term.components:
            assert re.findall(r"`(\w+)`", rows[name][1]) == list(term.components)


def test_all_weights_are_on_the_page_as_they_are():
    rows = {row[0].strip("`"): row[1:] for row in table("rewards")}
    assert list(rows) == list(RewardConfig.model_fields)
    for name, description in descriptions(RewardConfig).items():
        assert rows[name] == [f"{RewardConfig.model_fields[name].default:g}", description]
