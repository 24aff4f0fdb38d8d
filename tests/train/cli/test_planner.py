"""An evaluation whose mission names a planner that there is not ends before anything is written."""

import pytest

from clean_swarm_env.config.types import ConfigurationError
from tests.train.records import experiment
from train.evaluation.experiment import check_mission


def test_a_planner_that_there_is_not_is_one_line_with_its_key():
    planned = experiment(mission={"network": {"planner": "ares"}})
    with pytest.raises(ConfigurationError, match=r"^my\.yaml: mission\.network\.planner: .*'ares'") as caught:
        check_mission(planned, (), "my.yaml")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", ["built-in", "off"])
def test_the_planners_of_the_project_are_always_there(name):
    check_mission(experiment(mission={"network": {"planner": name}}), (), "my.yaml")
