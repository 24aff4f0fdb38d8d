"""What docs/selector.md shows works."""

import pytest

from selector.configurations.library import Library
from selector.coordination.model import CoordinatorModel
from selector.knowledge import load_knowledge
from tests.pages import blocks

CONFIGURATION, KNOWLEDGE, STEERS, SUM = (block.text for block in blocks("docs/selector.md", "yaml"))


@pytest.fixture
def mine(tmp_path):
    for kind, name, text in (("mechanisms", "Shy", CONFIGURATION), ("knowledge", "mine", KNOWLEDGE)):
        (tmp_path / kind).mkdir()
        (tmp_path / kind / f"{name}.yaml").write_text(text)
    return tmp_path


def test_the_configuration_serves_its_goal_with_the_options_parameters(mine):
    model = CoordinatorModel("AvoidCollision", load_knowledge("mine", [mine]), Library([mine]))
    assert model.options == ("Shy-near", "RepulsionGradient")
    assert model.configurations[0].mechanisms["shy"].parameters["view_distance"] == 1.0


def test_the_configuration_that_steers_takes_no_turn(mine):
    (mine / "mechanisms" / "Bend.yaml").write_text(STEERS)
    library = Library([mine])
    assert library.configuration("Bend", {"distance": 0.7}).steers
    assert not library.configuration("Shy").steers


def test_the_page_of_sums_shows_a_configuration(tmp_path):
    (tmp_path / "mechanisms").mkdir()
    (tmp_path / "mechanisms" / "Mine.yaml").write_text(SUM)
    assert Library([tmp_path]).configuration("Mine", {"push": 2.0}).mechanisms["both"].type == "WeightedSum"
