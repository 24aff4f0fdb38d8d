"""The guide to strategies says what there is, and its examples run."""

import re

import numpy as np
import pytest

import selector.strategies.registry
from selector.strategies.registry import STRATEGIES
from selector.strategies.strategy import DecisionStrategy
from tests.paths import ROOT

GUIDE = (ROOT / "docs" / "strategies.md").read_text(encoding="utf-8")
EXAMPLES = re.findall(r"```python\n(.*?)```", GUIDE, re.DOTALL)


def shipped():
    return {cls.__name__: cls for cls in STRATEGIES if cls.__module__.startswith("selector.strategies.")}


@pytest.mark.parametrize("name", list(shipped()))
def test_the_table_names_every_parameter_and_its_default(name):
    (row,) = [line for line in GUIDE.splitlines() if line.startswith(f"| `{name}` |")]
    stated = row.split(" | ")[2]
    fields = shipped()[name].Parameters.model_fields
    assert set(re.findall(r"`(\w+)`", stated)) == set(fields)
    for field, details in fields.items():
        if not details.is_required():
            default = "no" if details.default is False else f"{details.default:g}"
            assert re.search(rf"`{field}` {re.escape(default)}(,|$)", stated.strip(" |")), (field, default)


def test_the_table_names_nothing_else():
    assert set(re.findall(r"^\| `(\w+)` \|", GUIDE, re.MULTILINE)) == set(shipped()) | {"baseline"}


@pytest.mark.parametrize("example", range(len(EXAMPLES)))
def test_the_examples_run(example, monkeypatch, capsys):
    monkeypatch.setattr(STRATEGIES, "_classes", {cls.__name__: cls for cls in STRATEGIES})
    names = {"__name__": "guide"}
    exec(compile(EXAMPLES[example], "strategies.md", "exec"), names)  # the guide's own text
    if "strategy" in names:
        assert isinstance(names["strategy"], DecisionStrategy)
        assert all(np.isfinite(array).all() for array in names["strategy"].state_dict().values())
    printed = capsys.readouterr().out
    if "print" in EXAMPLES[example]:
        assert printed == re.search(r"print\(.*# (.*)$", EXAMPLES[example], re.MULTILINE)[1] + "\n"


def test_the_yaml_is_a_strategy():
    import yaml

    (text,) = re.findall(r"```yaml\n(.*?)```", GUIDE, re.DOTALL)
    spec = selector.strategies.registry.StrategySpec.model_validate(yaml.safe_load(text))
    (word,) = re.findall(r"or in one word, `(.*?)`", GUIDE)
    assert spec == selector.strategies.registry.spec_from_text(word)
