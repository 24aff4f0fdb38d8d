"""The shipped mission of scouts and carriers: documents by model, and what it is worth that robots differ."""

import numpy as np
import pytest

from clean_swarm_env.config.load import load_mission, with_changes
from clean_swarm_env.config.mission import MissionConfig
from clean_swarm_env.learning.batch import Batch
from selector.documents.errors import DocumentError
from selforg.network import state as st
from tests.clean_swarm_env.courses import difference, snapshot
from tests.paths import ROOT

TRANSPORT = ("MoveToRecycling", "Recycle", "MoveToDump", "Dump")
MISSION = load_mission("scouts")


def of_models(*changes):
    """Return the mission whose carriers and scouts have some settings changed."""
    robots = MISSION.model_dump()["robots"]
    groups = [{**group, **change} for group, change in zip(robots["groups"], changes, strict=True)]
    return MissionConfig.model_validate(with_changes(MISSION.model_dump(), {"robots": {**robots, "groups": groups}}))


def begun(config=MISSION, seeds=(0,)):
    batch = Batch(config, worlds=len(seeds))
    batch.reset(list(seeds))
    return batch


def durations(config, seeds):
    """Return the decision periods that missions last."""
    batch, lasted = begun(config, seeds), np.zeros(len(seeds))
    for period in range(1, 1500):
        step = batch.step(np.tile(batch.choices.default, (batch.rows, 1)))
        lasted[(step.terminated | step.truncated) & (lasted == 0)] = period
        if lasted.all():
            break
    return lasted


def test_the_mission_has_fewer_than_forty_lines_and_both_models_do_their_part():
    assert len((ROOT / "configs/missions/scouts.yaml").read_text().splitlines()) < 40
    batch = begun()
    task, most, found = batch.worlds.task, 0, False
    for _ in range(150):
        batch.step(np.tile(batch.choices.default, (batch.rows, 1)))
        assert (task.garbage.cargo[4:] == -1).all()
        found |= bool(task.garbage.found.any())
        most = max(most, *(len(task.garbage.load(row)) for row in range(4)))
    assert task.garbage.done[0] >= 4
    assert most == 2
    assert found


def test_swapped_speeds_shorten_the_mission():
    seeds = range(4)
    swapped = of_models({"max_speed": 1.0}, {"max_speed": 0.5})
    assert durations(swapped, seeds).mean() < 0.85 * durations(MISSION, seeds).mean()


def test_robots_have_the_behaviours_of_their_own_document_also_after_they_begin_anew():
    worlds = begun(seeds=(0, 1)).worlds
    network = worlds.network
    for _ in range(2):
        there = {name: network.state.marks[:, st.PRESENT, network.model.behaviour_index[name]] for name in TRANSPORT}
        for present in there.values():
            assert present.tolist() == [1, 1, 1, 1, 0, 0, 0] * 2
        worlds.minds.reset_rows(np.array([4, 1]))


def test_a_world_of_two_documents_has_the_same_bits_in_a_batch_and_from_a_state():
    alone, batch, other = begun(seeds=(5,)), begun(seeds=(4, 5)), begun(seeds=(8, 9))

    def steps(one, world, count=25):
        found = []
        for _ in range(count):
            one.step(np.tile(one.choices.default, (one.rows, 1)))
            found.append(snapshot(one.worlds, world))
        return found

    assert not difference(steps(alone, 0), steps(batch, 1))
    other.set_state(batch.get_state([1]), [0])
    assert not difference(steps(batch, 1), steps(other, 0))


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
        begun(of_models({}, change))
    assert "\n" not in str(caught.value)
