"""The shipped mission of scouts and carriers: documents by model, and what it is worth that robots differ."""

import numpy as np
import pytest

from clean_swarm_env.config.load import load_mission, with_changes
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.learning.batch import Batch
from selector.documents.errors import DocumentError
from selforg.network import state as st
from tests.clean_swarm_env.courses import begun

TRANSPORT = ("MoveToRecycling", "Recycle", "MoveToDump", "Dump")
MISSION = load_mission("scouts")


def of_models(*changes):
    """Return the mission whose carriers and scouts have some settings changed."""
    robots = MISSION.model_dump()["robots"]
    groups = [{**group, **change} for group, change in zip(robots["groups"], changes, strict=True)]
    return MissionConfig.model_validate(with_changes(MISSION.model_dump(), {"robots": {**robots, "groups": groups}}))


def of_seeds(config=MISSION, seeds=(0,)):
    return begun(Batch(config, worlds=len(seeds)), list(seeds))


def test_robots_have_the_behaviours_of_their_own_document_also_after_they_begin_anew():
    worlds = of_seeds(seeds=(0, 1)).worlds
    network = worlds.network
    for _ in range(2):
        there = {name: network.state.marks[:, st.PRESENT, network.model.behaviour_index[name]] for name in TRANSPORT}
        for present in there.values():
            assert present.tolist() == [1, 1, 1, 1, 0, 0, 0] * 2
        worlds.minds.reset_rows(np.array([4, 1]))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"document": "cleaning"}, r"cleaning: expected a robot that coordinates ExplorationPatrol, AvoidCollision as"),
        ({"document": "nobody"}, r"^mission\.robots\.groups\.1\.document: .*nobody"),
        ({"carries": 1}, r"^mission\.robots\.groups\.1\.document: .*scout\.yaml: .*; MoveToRecycling is missing"),
    ],
)
def test_documents_that_do_not_fit_are_one_line(change, message):
    with pytest.raises(DocumentError, match=message) as caught:
        of_seeds(of_models({}, change))
    assert "\n" not in str(caught.value)
