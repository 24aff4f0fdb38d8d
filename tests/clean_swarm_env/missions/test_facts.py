"""Missions in which robots tell facts: as the page shows, by two documents, and as a machine sees them."""

import numpy as np
import pytest

from clean_swarm_env.config.load import load_mission
from clean_swarm_env.deciders.named import decider_named
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.recording.reader import recordings_in
from clean_swarm_env.recording.recorder import RecordSettings
from clean_swarm_env.tasks.cleaning.consequences import NOTICED, suffer
from clean_swarm_env.world.explaining import explain_robot
from selector.documents.errors import DocumentError
from selforg.program import Program
from tests.clean_swarm_env.courses import begun
from tests.pages import blocks

CROWD = {"base": "bumpers", "world": {"width": 5.0, "height": 5.0}, "robots": {"count": 8},
         "task": {"stations": {"recycling": [1.0, 1.0], "dump": [4.0, 4.0]}}}  # fmt: skip
STOPPED = ("heard_stopped_by_collision", "age_of_stopped_by_collision")


@pytest.fixture
def own(tmp_path):
    """The user's directory of the page."""
    for block in (block for block in blocks("docs/models.md", "yaml") if block.file):
        (tmp_path / block.file).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / block.file).write_text(block.text)
    return tmp_path / "my"


def run(mission, periods=60, seed=1, **settings):
    batch = begun(Batch(mission, begin_anew=False, **settings), [seed])
    for _ in range(periods):
        batch.step(np.zeros((batch.rows, len(batch.options)), dtype=np.int64))
    return batch.worlds, batch


def test_the_robots_of_the_page_tell_hear_and_explain(own):
    worlds, _ = run(load_mission("careful", [own]), 150, directories=[own], explained=True)
    heard = [explain_robot(worlds, row).heard[0] for row in range(5)]
    for row, one in enumerate(heard):
        who = "noticed itself" if one["robot"] == row else f"heard from robot {one['robot']}"
        assert one["sentence"] == f"has {who}, {one['age_s']:.0f} s ago, that it was at the dump"
    read = worlds.network.readings[:, worlds.network.model.sensor_index["dump busy"]]
    assert read.tolist() == [one["age_s"] <= 3.0 for one in heard]


def test_robots_of_another_document_neither_tell_nor_hear(own):
    (own / "robots" / "teller.yaml").write_text("base: cleaning\nfacts: {stopped_by_collision: {}}\n")
    (own / "robots" / "other.yaml").write_text("base: cleaning\nfacts: {stopped_by_collision: {keep: largest}}\n")
    groups = [{"model": "a", "count": 4, "document": "teller"}, {"model": "b", "count": 4}]
    fact = run({**CROWD, "robots": groups}, directories=[own])[0].minds.facts["stopped_by_collision"]
    fact.ask(60.0, np.arange(8))
    assert set(fact.tellers[:4]) <= set(range(4))
    assert set(fact.tellers[4:]) == {-1}
    with pytest.raises(DocumentError, match=r"^robots of teller: fact stopped_by_collision: expected the same as in"):
        Batch({**CROWD, "robots": groups, "network": {"robot": "other"}}, directories=[own])


def test_a_fact_that_nobody_tells_is_one_line(own):
    (own / "robots" / "wrong.yaml").write_text("base: cleaning\nfacts: {stoped_by_collision: {}}\n")
    line = r"^robots of wrong: facts: no action tells it .*'stoped_by_collision' .*mean 'stopped_by_collision'\?\)$"
    with pytest.raises(DocumentError, match=line):
        Batch({**CROWD, "network": {"robot": "wrong"}}, directories=[own])


def test_who_fails_tells_nothing_of_the_collision_before():
    worlds, told = run(CROWD, 0, observation={"terms": ["heard"]})[0], []
    colliding = Program(lambda: [step for step in worlds.steps() if step.kernel is suffer])
    for tick in range(10):
        worlds.collisions.entered_in_tick[:] = (np.arange(8) < 2) & (tick == 0)
        worlds.team.working[:] = worlds.physics.present[:] = (np.arange(8) != 0) | (tick == 0)
        colliding.run(0.2 * tick)
        told += [np.flatnonzero(rows).tolist() for rows in worlds.task.noticed().values()]
    assert told == [[1]]


def test_an_oldest_of_no_time_is_refused():
    with pytest.raises(DocumentError, match=r"^observation: terms: heard: oldest: expected more than 0 s, got 0$"):
        Batch(CROWD, observation={"terms": [{"name": "heard", "oldest": 0}]})


def test_recordings_have_what_a_term_makes_robots_hear(tmp_path):
    seen, record = decider_named("fsm:told-bumpers").observation(()), RecordSettings(tmp_path, minds=True)
    _, batch = run(CROWD, 2, observation=seen, record=record)
    batch.close()
    (recording,) = recordings_in(tmp_path)
    assert {f"heard/{name}/age" for name in NOTICED} <= set(recording)


def test_what_the_machine_sees_follows_from_collisions_and_costs_nothing_where_nobody_looks():
    worlds, batch = run(CROWD, observation=decider_named("fsm:told-bumpers").observation(()))
    number, age = batch.observations[:, [batch.observer.names.index(name) for name in STOPPED]].T
    assert (number == 1.0).all()
    assert (age < 0.5).all()
    plain, _ = run(CROWD)
    assert plain.minds.facts == {}
    np.testing.assert_array_equal(plain.physics.positions, worlds.physics.positions)


def test_a_task_whose_robots_tell_nothing_has_no_such_term():
    with pytest.raises(DocumentError, match=r"^observation: terms: heard: expected robots that tell facts.* Foraging$"):
        Batch({"task": "Foraging"}, observation={"terms": ["heard"]})
