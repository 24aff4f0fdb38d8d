"""Recordings of scenes hold the places of `Run.tracks`, and change no run."""

import numpy as np
import pytest
from clean_swarm_env.goals.goal_batch import GoalBatch

from clean_swarm_env.clean_swarm_v0 import parallel_env
from clean_swarm_env.drawing.recorded_picture import RecordedCourse
from clean_swarm_env.recording.reader import RecordedMission
from clean_swarm_env.recording.recorder import RecordSettings
from clean_swarm_env.recording.scene_recording import SceneRecorder
from clean_swarm_env.scenes import Setting, find
from clean_swarm_env.scenes.arena import CONTROL_PERIOD
from clean_swarm_env.scenes.served import ServedTeam, expertise
from train.replay.page_file import page_of

SEEDS = (3, 4)


def ran(goal, setting, folder, *, baseline=False):
    """Run a scene with and without a recorder; return the run without one, and the recordings."""
    expert = expertise(goal)
    make = None if baseline else lambda scene: ServedTeam(scene, expert, explained=True)
    scene = find(goal)(setting, SEEDS)
    scene.start(make)
    recorder = SceneRecorder(scene, "some", folder, SEEDS)
    while not scene.over:
        scene.advance()
        recorder.record()
    recorder.close()
    return find(goal)(setting, SEEDS).run(make), recorder.paths


@pytest.mark.parametrize("ground", ["torus", "open"])
@pytest.mark.parametrize(("goal", "baseline"), [("Foraging", False), ("ReachGoal", False), ("ReachGoal", True)])
def test_a_recording_has_the_places_of_the_run_and_what_it_measured(tmp_path, goal, ground, baseline):
    setting = Setting(6, 30.0, ground)
    run, paths = ran(goal, setting, tmp_path, baseline=baseline)
    assert [path.name for path in paths] == [f"{goal}-some-seed3.swarm", f"{goal}-some-seed4.swarm"]
    for world, path in enumerate(paths):
        recording = RecordedMission(path)
        places = run.tracks[:-1, 6 * world : 6 * (world + 1)]
        found = np.stack([recording["x"], recording["y"]], axis=-1)
        assert np.allclose(found, places, atol=0.0005001)
        assert recording.result["measures"] == {name: values[world] for name, values in run.values.items()}
        assert recording.period == CONTROL_PERIOD
        canvas = RecordedCourse(recording).at(20.0)
        assert canvas.options[0]
        assert ((canvas.positions >= 0.0) & (canvas.positions <= canvas.width)).all()
        assert (canvas.width < 0.5 * recording.head["width"]) == (ground == "open")
        assert page_of([recording])


def test_the_nest_the_food_and_what_robots_carry_are_in_the_picture(tmp_path):
    recording = RecordedMission(ran("Foraging", Setting(12, 100.0, "torus"), tmp_path)[1][0])
    canvas = RecordedCourse(recording).at(60.0)
    assert sorted(area.name for area in canvas.areas) == ["food", "food", "nest"]
    assert not any(area.repels for area in canvas.areas)
    nest = next(area for area in canvas.areas if area.name == "nest")
    assert (nest.x, nest.y, nest.radius) == (15.0, 15.0, 1.5)
    picked, brought = (np.diff(recording["cargo"], axis=0) == step for step in (1, -1))
    assert picked.sum() >= brought.sum() > 0
    assert [kind["channel"] for kind in recording.notes["deposits"]] == ["trail"]
    left = recording["deposit"] == 1
    assert left.sum() > 50
    assert left[recording["cargo"] == 0].sum() > 0.9 * left.sum()  # those that carry food leave a trail
    assert len(canvas.pheromones) > 10


def test_obstacles_repel_in_the_picture(tmp_path):
    canvas = RecordedCourse(RecordedMission(ran("ReachGoal", Setting(6, 2.0, "torus"), tmp_path)[1][0])).at(0.0)
    assert {area.name for area in canvas.areas if area.repels} == {"obstacle"}


def test_the_minds_and_the_contacts_of_a_scene_are_recorded(tmp_path):
    setting = Setting(12, 30.0, "torus")
    path = ran("Foraging", setting, tmp_path)[1][0]
    recording, expert = RecordedMission(path), expertise("Foraging")
    assert recording.head["networks"]["robot"]["behaviours"] == ["Foraging"]
    assert (recording["robot/running"] == 1).all()
    inner = recording[f"Foraging/{expert.name}/running"]
    assert set(np.unique(inner)) == {0.0, 1.0}
    scene = find("Foraging")(setting, SEEDS)
    scene.start(lambda made: ServedTeam(made, expert))
    while not scene.over:
        scene.advance()
    assert recording["contact"].sum() == scene.arena.entered[:12].sum() > 0


def test_episodes_of_a_batch_are_recorded_and_take_the_same_course(tmp_path):
    settings = RecordSettings(tmp_path, minds=True, about={"experiment": "mine"})
    recorded = GoalBatch("ReachGoal", worlds=2, seconds=10.0, record=settings)
    plain = GoalBatch("ReachGoal", worlds=2, seconds=10.0)
    for batch in (recorded, plain):
        batch.reset([5, 6])
    for period in range(13):  # an episode, and three seconds of the next one
        actions = np.arange(recorded.rows) % 2
        steps = recorded.step(actions), plain.step(actions)
        assert steps[0].rewards.tolist() == steps[1].rewards.tolist()
        if period == 9:
            ends = recorded.finished
    assert len(ends) == 2
    with pytest.raises(ValueError, match="set_state: expected a batch that records nothing"):
        recorded.set_state(plain.get_state())
    plain.set_state(recorded.get_state())  # a state is given while it is recorded
    recorded.close()
    assert len(list(tmp_path.iterdir())) == 4
    for world, seed in enumerate((5, 6)):
        recording = RecordedMission(tmp_path / f"ReachGoal-learner-seed{seed}.swarm")
        assert recording.head["about"] == {
            "experiment": "mine",
            "condition": "learner",
            "scenario": f"seed {seed}",
            "seed": seed,
        }
        assert recording.frames == round(10.0 / CONTROL_PERIOD)
        assert recording.result["completed"] == ends[world].figures["completed"]
        held = recording["held/ReachGoal"][0]
        assert held.tolist() == (np.arange(len(held)) % 2).tolist()
        assert (recording["robot/running"] == 1).any()
    others = [
        RecordedMission(path) for path in tmp_path.iterdir() if "seed5." not in path.name and "seed6." not in path.name
    ]
    assert [other.frames for other in others] == [round(3.0 / CONTROL_PERIOD)] * 2
    assert [other.result for other in others] == [None, None]


def test_the_environment_of_a_goal_is_recorded(tmp_path):
    env = parallel_env(goal="Foraging", record=RecordSettings(tmp_path, name="mine"))
    env.reset(seed=3)
    assert list(tmp_path.iterdir()) == []
    env.step(dict.fromkeys(env.agents, 0))
    env.close()
    recording = RecordedMission(tmp_path / "Foraging-mine-seed3.swarm")
    assert (recording.frames, recording.result, recording.head["minds"]) == (5, None, False)
