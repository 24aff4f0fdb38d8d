import json

import pytest

from tests.golden.case import Case, read_case
from tests.golden.selection import replay
from tests.paths import SHARED

RECORDED = SHARED / "golden" / "selection.json"


def case(options, goal, expected):
    return Case("case", "select", "", {"expert_knowledge": options, "so_goal": goal}, expected)


def test_replay_tells_right_from_wrong():
    options = {"G": [["B", 1, {}], ["A", 1.0, {"p": {"q": 2}}]]}
    assert replay(case(options, "G", {"config_key": "B", "params": {}})) is None
    assert "got B" in replay(case(options, "G", {"config_key": "A", "params": {"p": {"q": 2}}}))
    assert replay(case(options, "H", {"error": "KeyError"})) is None
    assert "refused" in replay(case(options, "H", {"config_key": "B", "params": {}}))
    assert "keys ['error'] expected" in replay(case(options, "G", {"error": "KeyError"}))


@pytest.mark.skipif(not RECORDED.is_file(), reason="the recorded cases lie outside the project")
def test_recorded_selections_come_out():
    cases = [read_case(entry) for entry in json.loads(RECORDED.read_text())]
    assert cases
    assert {case.id: failure for case in cases if (failure := replay(case)) is not None} == {}
