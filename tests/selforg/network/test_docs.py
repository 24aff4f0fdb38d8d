"""What docs/network.md shows works."""

import re

import yaml

from selector.coordination.robot_document import network_from
from tests.paths import ROOT

PAGE = (ROOT / "docs" / "network.md").read_text(encoding="utf-8")


def blocks(language):
    return re.findall(rf"```{language}\n(.*?)```", PAGE, flags=re.DOTALL)


def test_the_first_example_runs():
    names = {}
    exec(blocks("python")[0], names)
    assert names["running"].shape == (320, 2)
    assert [names["model"].behaviours[b].name for b in names["network"].state.plan[0, :2]] == ["GoHome", "Charge"]


def test_the_yaml_example_is_a_network():
    nested = network_from(yaml.safe_load(blocks("yaml")[0]))
    assert list(nested.inner) == ["Approach"]


def test_components_named_on_the_page_exist():
    import selforg.components as components

    section = PAGE.split("## Mechanisms in the network")[1].split("```")[0]
    named = re.findall(r"`([A-Z]\w+)`", section)
    assert len(named) > 15
    assert [name for name in named if not hasattr(components, name)] == []
