"""Contract of every scene: what it declares, and that a world takes the same course alone and in a batch.

A scene of a user's own, `Gathering`, joins.
"""

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from clean_swarm_env.config.errors import ConfigurationError
from clean_swarm_env.scenes import SCENES, Measure, Scene, Setting, find, goals
from clean_swarm_env.scenes.baselines import GoTo, StandStill
from clean_swarm_env.scenes.placing import any_headings, scattered
from clean_swarm_env.scenes.served import ServedTeam, expertise
from selector.knowledge import load_knowledge

FOURTEEN = {
    "ReachGoal", "CollectiveExploration", "FormationControl", "CircleFormation", "Foraging", "IndividualExploration",
    "FindBarycenter", "MaxValue", "UniformDistribution", "CollisionAvoidance", "AgentCollisionAvoidance",
    "ExplorationPatrol", "FollowPotentialField", "FollowMaxPotential",
}  # fmt: skip
SECONDS = 4.0


class Gathering(Scene):
    """Robots come together in the middle."""

    goal = "Gathering"
    story = "4 robots come together on a field of 10 m x 10 m"
    measures = (Measure("distance to the middle", "m", "lower", 1.0, "room for four"),)
    baseline = "nobody moves"
    setting = Setting(robots=4, seconds=20.0, ground="torus")
    side = 10.0

    def _place(self, rng):
        return scattered(rng, self.chosen.robots, self.ground, 1.0), any_headings(rng, self.chosen.robots)

    def _baseline(self):
        return StandStill(self.arena)

    def _result(self):
        return {"distance to the middle": self.ground.distances(self.positions, self.ground.centre).mean(axis=1)}


EVERY = [pytest.param(scene, id=scene.goal) for scene in (*SCENES, Gathering)]


def to_the_middle(scene):
    return GoTo(scene.arena, np.tile(scene.ground.centre, (scene.arena.rows, 1)), 0.5)


def short(scene, ground=None):
    return Setting(scene.setting.robots, SECONDS, ground or scene.setting.ground)


def served(kind, setting, seeds):
    if kind is Gathering:
        return kind(setting, seeds).run(to_the_middle)
    expert = expertise(kind.goal)
    return kind(setting, seeds).run(lambda scene: ServedTeam(scene, expert))


def test_every_goal_has_a_scene_and_options():
    assert set(goals()) == FOURTEEN
    assert set(load_knowledge("library").goals) == FOURTEEN


@pytest.mark.parametrize("scene", EVERY)
def test_a_scene_says_what_it_is(scene):
    assert scene.story
    assert scene.baseline
    assert scene.setting.robots >= scene.fewest
    assert not all(measure.guard for measure in scene.measures)
    for measure in scene.measures:
        assert measure.reason, measure.name
        assert np.isfinite(measure.target)


@pytest.mark.parametrize("ground", ["torus", "open"])
@pytest.mark.parametrize("scene", EVERY)
def test_every_scene_measures_on_both_grounds(scene, ground):
    for run in (served(scene, short(scene, ground), [3, 4]), scene(short(scene, ground), [3, 4]).run()):
        assert set(run.values) == {measure.name for measure in scene.measures}
        for name, values in run.values.items():
            assert values.shape == (2,), name
            assert np.isfinite(values).all(), name
        assert run.tracks.shape == (SECONDS * 5 + 1, 2 * scene.setting.robots, 2)


@pytest.mark.parametrize("scene", EVERY)
def test_a_run_is_the_same_again_and_alone_and_in_a_batch(scene):
    setting = short(scene)
    for run in (served, lambda scene, setting, seeds: scene(setting, seeds).run()):
        batch, again = run(scene, setting, [5, 6]), run(scene, setting, [5, 6])
        assert_array_equal(batch.tracks, again.tracks)
        for world, seed in enumerate((5, 6)):
            alone, rows = run(scene, setting, [seed]), slice(world * setting.robots, (world + 1) * setting.robots)
            assert_array_equal(alone.tracks, batch.tracks[:, rows])
            for name, values in alone.values.items():
                assert values[0] == batch.values[name][world], name


@pytest.mark.parametrize("scene", EVERY)
def test_mechanism_and_baseline_have_the_same_start(scene):
    setting = short(scene)
    starts = [run.tracks[0] for run in (served(scene, setting, [7]), scene(setting, [7]).run())]
    assert_array_equal(*starts)
    assert not np.array_equal(starts[0], scene(setting, [8]).run().tracks[0])


def test_open_land_is_wide_enough_for_the_fastest():
    own = find("CollectiveExploration").setting
    scene = find("CollectiveExploration")(Setting(own.robots, 30.0, "open"), [0])
    tracks = scene.run().tracks
    assert (np.abs(np.diff(tracks, axis=0)) < 1.0).all()  # nobody jumps across the seam


def test_names_that_are_not_there_are_named():
    with pytest.raises(ConfigurationError, match=r"unknown goal 'ReachGaol'.*did you mean 'ReachGoal'"):
        find("ReachGaol")
    with pytest.raises(ConfigurationError, match=r"goal ReachGoal: unknown option 'Nothing'"):
        expertise("ReachGoal", "Nothing")


def test_too_few_and_too_many_robots_are_refused():
    with pytest.raises(ConfigurationError, match="--robots: UniformDistribution expects at least 2, got 1"):
        find("UniformDistribution")(Setting(1, 1.0, "torus"), [0])
    with pytest.raises(ConfigurationError, match="--robots: expected room for 50 places"):
        find("FormationControl")(Setting(50, 1.0, "open"), [0])
    with pytest.raises(ConfigurationError, match="--robots: robots: at most 461 discs"):
        find("FormationControl")(Setting(500, 1.0, "open"), [0])


def test_a_goal_has_one_scene():
    with pytest.raises(ValueError, match="goal 'ReachGoal' is registered already"):
        SCENES.register(find("ReachGoal"))


def test_a_scene_of_the_users_own_is_found_by_its_goal(monkeypatch):
    monkeypatch.setattr(SCENES, "_classes", dict(SCENES._classes))
    SCENES.register(Gathering)
    assert find("Gathering") is Gathering
    assert "Gathering" in goals()
    run = Gathering(Gathering.setting, [0, 1]).run(to_the_middle)
    assert Gathering.measures[0].met(float(run.values["distance to the middle"].mean()))


def test_targets_are_met_from_their_better_side():
    lower, higher = (Measure("x", "-", better, 1.0, "why") for better in ("lower", "higher"))
    assert [lower.met(0.9), lower.met(1.1), higher.met(0.9), higher.met(1.1)] == [True, False, False, True]


@pytest.mark.parametrize("goal", ["MaxValue", "FindBarycenter", "AgentCollisionAvoidance", "CircleFormation"])
def test_quick_goals_are_reached(goal):
    scene = find(goal)
    values = served(scene, scene.setting, range(100, 104)).values
    for measure in scene.measures:
        assert measure.met(float(values[measure.name].mean())), (measure.name, values[measure.name])
