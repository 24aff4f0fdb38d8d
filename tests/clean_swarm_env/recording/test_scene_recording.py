"""Recordings of scenes hold the places of `Run.tracks`, and change no run."""

import numpy as np
import pytest

from clean_swarm_env.drawing.recorded_picture import RecordedCourse
from clean_swarm_env.recording.reader import RecordedMission
from clean_swarm_env.recording.scene_recording import SceneRecorder
from clean_swarm_env.scenes import Setting, find
from clean_swarm_env.scenes.arena import CONTROL_PERIOD
from clean_swarm_env.scenes.served import ServedTeam, expertise
from train.replay.page_file import page_of

SEEDS = (3, 4)


def ran(goal, setting, folder, *, baseline=False):
    """Run a scene with and without a recorder; return the run without one, and the recordings."""
    expert = expertise(goal)
    make = None if baseline else lambda scene: ServedTeam(scene, expert)
    scene = find(goal)(setting, SEEDS)
    scene.begin(make)
    recorder = SceneRecorder(scene, folder, "some")
    while not scene.over:
        scene.advance()
        recorder.take()
    return find(goal)(setting, SEEDS).run(make), recorder.write(SEEDS)


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
        corner = (places - found).mean(axis=(0, 1)) if ground == "open" else np.zeros(2)
        assert np.allclose(found + corner, places, atol=0.0011)
        assert ((found >= 0.0) & (found <= recording.head["width"])).all()
        assert recording.result == {name: pytest.approx(values[world]) for name, values in run.values.items()}
        assert recording.period == CONTROL_PERIOD
        assert RecordedCourse(recording).at(20.0).options[0]
        assert page_of([recording])


def test_the_nest_the_food_and_what_robots_carry_are_in_the_picture(tmp_path):
    recording = RecordedMission(ran("Foraging", Setting(12, 100.0, "torus"), tmp_path)[1][0])
    canvas = RecordedCourse(recording).at(60.0)
    assert sorted(area.name for area in canvas.areas) == ["food", "food", "nest"]
    nest = next(area for area in canvas.areas if area.name == "nest")
    assert (nest.x, nest.y, nest.radius) == (15.0, 15.0, 1.5)
    picked, brought = (np.diff(recording["cargo"], axis=0) == step for step in (1, -1))
    assert picked.sum() >= brought.sum() > 0
    assert [kind["channel"] for kind in recording.notes["deposits"]] == ["trail"]
    left = recording["deposit"] == 1
    assert left.sum() > 50
    assert left[recording["cargo"] == 0].sum() > 0.9 * left.sum()  # those that carry food leave a trail
    assert len(canvas.pheromones) > 10
