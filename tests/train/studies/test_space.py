"""Spaces say what is wrong with them in one line, and put values where they belong."""

import pytest

from clean_swarm_env.config.known import knowledge_of
from clean_swarm_env.config.load import load_family
from selector.documents.errors import DocumentError
from selector.documents.find import load_file
from train.studies.config import StudyConfig

pytest.importorskip("optuna", reason="optuna is not installed (extra tune)")

from train.studies.space import StudySpace

pytestmark = pytest.mark.extra


def space_of(configs, space, **changes):
    study = load_file("studies", "planted", StudyConfig, [configs])
    content = {**study.model_dump(), "space": {"AvoidCollision": space}, **changes}
    known = knowledge_of(load_family("small", [configs]).mission, [configs])
    return StudySpace(StudyConfig.model_validate(content), known, (configs,))


def test_values_stand_at_their_paths_and_nothing_else_changes(configs):
    space = space_of(
        configs,
        {
            "Near": {
                "score": {"low": 0.0, "high": 1.0},
                "parameters": {"presence_threshold": 0.1, "view_distance": {"low": 0.5, "high": 2.0, "log": True}},
            },
            "Other": {"configuration": "RepulsionGradient", "score": {"choices": [0.25, 0.75]}},
        },
    )
    assert space.names == ("Near.score", "Near.parameters.view_distance", "Other.score")
    assert [dimension.at(0.5) for dimension in space.dimensions] == [0.5, 1.0, 0.75]
    goals = space.goals_with([0.5, 1.0, 0.75])
    near, other = goals["AvoidCollision"]
    assert near == {
        "name": "Near-varied",
        "configuration": "RepulsionFernandez",
        "score": 0.5,
        "parameters": {"view_distance": 1.0, "presence_threshold": 0.1},
    }
    assert space.served(goals)["AvoidCollision"] == other
    assert space.unchanged()["AvoidCollision"][0]["parameters"] == {"view_distance": 0.5, "presence_threshold": 0.1}
    assert [option["name"] for option in space.null()["AvoidCollision"]] == ["Off"]


@pytest.mark.parametrize(
    ("space", "message"),
    [
        ({"Near": {"parameters": {"view_distance": 1.0}}}, "space: expected at least one range or choice"),
        ({"Near": {"parameters": {"view": {"low": 0, "high": 1}}}}, "space.AvoidCollision.Near.parameters.view: 0.0: "),
        ({"New": {"score": {"low": 0, "high": 1}}}, "space.AvoidCollision.New: configuration: missing key"),
        ({"Near": {"score": {"low": 1, "high": 0}}}, "Near.score: high: expected more than low, 1, got 0"),
        ({"Near": {"score": {"low": 0, "high": 1, "log": True}}}, "Near.score: low: expected more than 0 with log"),
        ({"Near": {"score": {"low": 0, "hight": 1}}}, "Near.score: hight: unknown key"),
        (
            {"Near": {"parameters": {"view_distance": {"low": 0.1, "high": 1}}}, "Off": {}},
            "space.AvoidCollision: expected a range of a score",
        ),
    ],
)
def test_a_mistake_is_one_line(configs, space, message):
    with pytest.raises(DocumentError) as raised:
        space_of(configs, space)
    text = str(raised.value)
    assert message in text
    assert "\n" not in text
