"""Actions: options with masks, and movement vectors in place of those of the network."""

import numpy as np
import pytest

from clean_swarm_env import clean_swarm_v0
from clean_swarm_env.config.types import AVOIDANCE
from clean_swarm_env.learning.actions import ActionConfig
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.tasks.cleaning.garbage import NOTHING
from clean_swarm_env.tasks.cleaning.learning.around import PHASES
from selector.documents.errors import DocumentError
from selforg.program import STEER, Rows, Step
from tests.clean_swarm_env.courses import OPTIONS, begun, long_course, mission

SERVES = ActionConfig(
    serves={
        "RepulsionFernandez-view2.0": ("patrol", "approach"),
        "RepulsionGradient-view1.5": ("to_recycling", "to_dump", "patrol"),
    }
)
TABLE = {
    "patrol": [True, True, True],
    "approach": [True, True, False],
    "to_recycling": [False, True, True],
    "to_dump": [False, True, True],
}


@long_course
def test_masks_follow_the_phase_and_options_that_cannot_serve_give_way():
    batch, rng, met = Batch(mission(), 2, action=SERVES), np.random.default_rng(1), set()
    batch.reset([1, 2])
    for _ in range(150):
        phases = [PHASES[phase] for phase in batch.worlds.task.phase()]
        met |= set(phases)
        carrying = batch.worlds.task.garbage.cargo != NOTHING
        assert carrying.tolist() == [phase.startswith("to_") for phase in phases]
        masks, options = batch.masks(), rng.integers(0, 3, 10)
        assert masks.tolist() == [TABLE[phase] for phase in phases]
        batch.step(options)
        if batch.finished:
            break
        stand_in = [0 if TABLE[phase][0] else 2 for phase in phases]  # scores: 1.0, 0.0, 0.5
        expected = np.where(masks[np.arange(10), options], options, stand_in)
        assert batch.worlds.minds.coordinator_of(AVOIDANCE).held.tolist() == expected.tolist()
    assert met == set(PHASES)


@pytest.mark.parametrize(
    ("serves", "message"),
    [
        ({"Repulsion": ("patrol",)}, "actions: serves: unknown option 'Repulsion'"),
        ({OPTIONS[0]: ("patrole",)}, f"actions: serves: {OPTIONS[0]}: unknown phase 'patrole' .*did you mean 'patrol'"),
        (
            dict.fromkeys(OPTIONS, ("patrol",)),
            "expected an option for goal AvoidCollision in phase 'approach', got none",
        ),
    ],
)
def test_limits_that_cannot_be_kept_are_refused(serves, message):
    with pytest.raises(DocumentError, match=message):
        Batch(action=ActionConfig(serves=serves))


PARTS, FINITE = "expected an option and a vector for each of 5 rows", r"expected finite numbers of shape \(5, 2\)"
WRONG = [
    ("option", np.zeros((5, 2), dtype=np.int64), r"expected shape \(5, 1\), got \(5, 2\)"),
    ("option", np.zeros(5), "expected whole numbers, got float64"),
    ("option", np.array([0, 1, 2, 3, 0]), r"options\[3\]: expected 0\.\.2, got 3"),
    ("option", np.array([0, -1, 2, 2, 0]), r"options\[1\]: expected 0\.\.2, got -1"),
    ("both", np.full((5, 3), 3.0), r"options\[0\]: expected 0\.\.2, got 3"),
    *(
        ("both", wrong, PARTS)
        for wrong in (np.zeros((5, 2)), np.zeros(5), np.full((5, 3), np.nan), np.full((5, 3), 0.5))
    ),
    *(("velocity", wrong, FINITE) for wrong in (np.zeros((5, 3)), np.zeros(5), np.full((5, 2), np.nan))),
]


@pytest.mark.parametrize(("mode", "actions", "message"), WRONG)
def test_wrong_actions_are_named(mode, actions, message):
    batch = begun(Batch(action={"mode": mode}), [1])
    with pytest.raises(ValueError, match=message):
        batch.step(actions)


VELOCITY = ActionConfig(mode="velocity")


def velocity_batch(worlds: int = 1, **changes) -> Batch:
    return Batch(mission(**changes), worlds, action=VELOCITY)


def test_a_velocity_is_a_vector_in_the_frame_that_the_robot_has_when_it_is_given():
    for action, turned in (([0.5, 0.0], 0.0), ([0.0, 0.3], np.pi / 2), ([-0.2, 0.0], np.pi)):
        batch = begun(velocity_batch(robots={"count": 1}, garbage={"count": 1}), [1])
        heading = float(batch.worlds.physics.headings[0])
        for _ in range(3):  # turning on the spot takes its time
            before = batch.worlds.physics.positions[0].copy()
            batch.step(np.array([action], dtype=np.float32))
            away = heading + turned - batch.worlds.physics.headings[0]
            action = [np.hypot(*action) * np.cos(away), np.hypot(*action) * np.sin(away)]
        moved = batch.worlds.physics.positions[0] - before
        expected = np.hypot(*action) * np.array([np.cos(heading + turned), np.sin(heading + turned)])
        np.testing.assert_allclose(moved, expected, atol=0.02)


def test_zero_means_to_stand_still_and_what_is_beyond_the_bounds_counts_as_the_bound():
    batch, other = velocity_batch(), velocity_batch()
    for one in (batch, other):
        one.reset([1])
    before = batch.worlds.physics.positions.copy()
    batch.step(np.zeros((5, 2), dtype=np.float32))
    assert np.array_equal(batch.worlds.physics.positions, before)
    other.step(np.zeros((5, 2), dtype=np.float32))
    batch.step(np.tile([7.0, -3.0], (5, 1)))
    other.step(np.tile([1.0, -1.0], (5, 1)))
    assert np.array_equal(batch.worlds.physics.positions, other.worlds.physics.positions)


def test_a_zero_correction_changes_nothing_and_another_one_moves_who_stands():
    config = mission("exploring")  # two goals
    courses = []
    for mode, vector in (("option", []), ("both", [0.0, 0.0]), ("both", [0.1, 0.0])):
        batch, rng = Batch(config, 2, action={"mode": mode}), np.random.default_rng(1)
        batch.reset([1, 2])
        course = []
        for _ in range(40):
            options = np.stack([rng.integers(0, count, batch.rows) for count in batch.choices.counts], axis=1)
            actions = np.hstack([options, np.tile(vector, (batch.rows, 1))]) if vector else options
            course.append(batch.step(actions).observations.tobytes())
            assert np.array_equal(np.stack([c.held for c in batch.worlds.coordinators], axis=1), options)
        courses.append(course)
    assert courses[0] == courses[1] != courses[2]


def test_a_correction_is_added_to_what_behaviours_command():
    batch = begun(Batch(action={"mode": "both"}), [1])
    worlds, before = batch.worlds, np.zeros((5, 2))
    commands, steps, headings = worlds.minds.commands, worlds.minds.robots.steps, worlds.physics.headings.copy()

    def note(now, rows):
        before[:] = commands.vectors * (commands.commanded & ~commands.in_place)[:, None]

    worlds.minds.robots.steps = lambda commands: [*steps(commands), Step(STEER, note, Rows.of(np.arange(5)))]
    ahead, left = np.array([np.cos(headings), np.sin(headings)]), np.array([-np.sin(headings), np.cos(headings)])
    correction = batch.mission.robots.max_speed * (0.5 * ahead - 0.25 * left).T
    for _ in batch.ticks(np.tile([0.0, 0.5, -0.25], (5, 1))):
        assert commands.commanded.all()
        np.testing.assert_allclose(commands.vectors, before + correction, atol=1e-12)
    assert before.any()


def test_pettingzoo_takes_vectors():
    env = begun(clean_swarm_v0.parallel_env(action=VELOCITY), seed=1)
    actions = {agent: env.action_space(agent).sample() for agent in env.agents}
    observations, *_ = env.step(actions)
    assert all(env.observation_space(agent).contains(observations[agent]) for agent in env.agents)
    with pytest.raises(ValueError, match=r"actions\['robot_0'\]: expected Box"):
        env.step({**actions, "robot_0": 1})


def test_options_are_limited_to_the_phases_of_the_task():
    serves = {"RandomSearch": ["searching"]}
    batch = begun(Batch("Foraging", action={"serves": serves}), [1])
    search, met = batch.options["Foraging"].index("RandomSearch"), 0
    for _ in range(60):
        carrying = batch.worlds.world.carrying
        assert batch.masks()[:, search].tolist() == (~carrying).tolist()
        met += int(carrying.sum())
        batch.step(np.full(batch.rows, search))
    assert met
