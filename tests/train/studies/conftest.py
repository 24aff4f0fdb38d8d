import os

import pytest


@pytest.fixture(autouse=True, scope="package")
def unsynced():
    """Missions that take no time wait for no disk."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(os, "fsync", lambda number: None)
        yield


@pytest.fixture(scope="module")
def configs(tmp_path_factory):
    """A directory with a family, its expert knowledge with Off, and a study of three parameters."""
    files = {
        "knowledge/two.yaml": """
            goals:
              AvoidCollision:
                - {name: Near, configuration: RepulsionFernandez, score: 0.5, parameters: {view_distance: 0.5}}
                - {name: Off, score: 0.0}
        """,
        "families/small.yaml": """
            name: small
            description: Two robots and three items.
            mission: {base: table1, knowledge: two, time_limit: 200.0}
            robots: [2, 2]
            items: [3, 3]
        """,
        "studies/planted.yaml": """
            name: planted
            family: small
            trials: 12
            last: {finalists: 3, scenarios: 40}
            space:
              AvoidCollision:
                Near:
                  parameters:
                    view_distance: {low: 0.1, high: 2.5}
                    presence_threshold: {low: 0.001, high: 1.0, log: true}
                    full_length: {low: 0.2, high: 5.0}
        """,
    }
    root = tmp_path_factory.mktemp("my")
    for name, text in files.items():
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return root
