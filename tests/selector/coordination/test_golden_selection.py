import pytest

from tests.golden.case import Case, SetAside
from tests.golden.selection import replay


def case(options, goal, expected):
    return Case("case", "select", "", {"expert_knowledge": options, "so_goal": goal}, expected)


def test_replay_tells_right_from_wrong():
    options = {"G": [["B", 1, {}], ["A", 1.0, {"p": {"q": 2}}]]}
    assert replay(case(options, "G", {"config_key": "B", "params": {}})) is None
    assert "got B" in replay(case(options, "G", {"config_key": "A", "params": {"p": {"q": 2}}}))
    assert replay(case(options, "H", {"error": "KeyError"})) is None
    assert "refused" in replay(case(options, "H", {"config_key": "B", "params": {}}))
    assert "keys ['error'] expected" in replay(case(options, "G", {"error": "KeyError"}))


def test_boolean_scores_are_refused_and_set_aside_by_their_number():
    with pytest.raises(SetAside, match="B6"):
        replay(case({"G": [["A", 0.0, {}], ["B", True, {}]]}, "G", {"config_key": "B", "params": {}}))
