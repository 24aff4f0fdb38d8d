"""What docs/selector.md shows works."""

import re

import numpy as np
import pytest

from selector.configurations.library import Library
from selector.coordination.model import CoordinatorModel
from selector.knowledge import load_knowledge
from selforg.components import ACTIONS, SENSORS
from tests.paths import ROOT

PAGE = (ROOT / "docs" / "selector.md").read_text(encoding="utf-8")


def blocks(language):
    return re.findall(rf"```{language}\n(.*?)```", PAGE, flags=re.DOTALL)


@pytest.fixture
def mine(tmp_path):
    configuration, knowledge, *_ = blocks("yaml")
    for kind, name, text in (("mechanisms", "Shy", configuration), ("knowledge", "mine", knowledge)):
        (tmp_path / kind).mkdir()
        (tmp_path / kind / f"{name}.yaml").write_text(text)
    return tmp_path


def test_the_configuration_serves_its_goal_with_the_options_parameters(mine):
    model = CoordinatorModel("AvoidCollision", load_knowledge("mine", [mine]), Library([mine]))
    assert model.options == ("Shy-near", "RepulsionGradient")
    assert model.configurations[0].mechanisms["shy"].parameters["view_distance"] == 1.0
    assert "Eleven lines" in PAGE
    assert len(blocks("yaml")[0].splitlines()) == 11


def test_the_configuration_that_steers_takes_no_turn(mine):
    (mine / "mechanisms" / "Bend.yaml").write_text(blocks("yaml")[2])
    library = Library([mine])
    assert library.configuration("Bend", {"distance": 0.7}).steers
    assert not library.configuration("Shy").steers


def test_the_host_of_the_page_brings_its_robots_to_the_goal():
    (code,) = blocks("python")
    names = {}
    exec(code, names)
    offsets = np.abs(names["positions"] - 6.0)
    assert (np.hypot(*np.minimum(offsets, 12.0 - offsets).T) <= 2.5).all()  # goal radii, and the others around


def test_all_words_are_explained():
    types = [cls.__name__ for cls in (*SENSORS, *ACTIONS) if cls.__module__.startswith("selforg.")]
    assert len(types) == 20
    assert [name for name in types if f"`{name}`" not in PAGE] == []


def test_the_page_of_sums_shows_a_configuration(tmp_path):
    (tmp_path / "mechanisms").mkdir()
    (tmp_path / "mechanisms" / "Mine.yaml").write_text(blocks("yaml")[3])
    assert Library([tmp_path]).configuration("Mine", {"push": 2.0}).mechanisms["both"].type == "WeightedSum"
