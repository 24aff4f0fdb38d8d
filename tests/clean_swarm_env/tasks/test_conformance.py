"""Every task as an environment passes the checks of the cleaning environment, at every border and with all actions."""

import sys

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import clean_swarm_env.registration  # noqa: F401  (the ids of the environments)
from clean_swarm_env import Batch, clean_swarm_v0
from clean_swarm_env.tasks import (
    TASKS,
    Achievement,
    Destination,
    Drawn,
    Measure,
    Shown,
    Task,
    TaskSettings,
    TaskState,
    Things,
)
from clean_swarm_env.testing import check_task
from selforg.plugins import PluginError
from tests.clean_swarm_env.courses import begun

SECONDS = 4.0
OTHERS = tuple(name for name in TASKS.names() if name != "Cleaning")
KINDS = ("Foraging", "CollisionAvoidance", "FormationControl", "MaxValue")
"""Facts, an errand, holonomic drives, decisions: the other tasks are long tests."""
every_task = pytest.mark.parametrize(
    "task", [pytest.param(task, marks=[] if task in KINDS else pytest.mark.long) for task in OTHERS]
)


def mission_of(task, seconds=SECONDS):
    return {"task": task, "time_limit": seconds}


def environment(task, seconds=SECONDS, **settings):
    return clean_swarm_v0.parallel_env(mission_of(task, seconds), **settings)


def sampled(env):
    return {agent: env.action_space(agent).sample() for agent in env.agents}


LUCK = np.random.default_rng(1)
"""Random numbers that no seed decides, for classes that break their promises."""


@pytest.mark.parametrize("task", TASKS.names())
def test_a_task_keeps_its_contract(task):
    check_task(TASKS.find(task))


PASSED = (Achievement("passed", "Times that the robot passed the middle."),)


class Waiting(Task[TaskSettings, TaskState]):
    """Robots wait; the measure is the time."""

    measures = (Measure("waited", "s", "higher", 2.0, "half of the time"),)
    goal = "CollectiveExploration"

    def result(self):
        return {"waited": self.world.ticks * 0.2}


@pytest.mark.parametrize(
    ("members", "said"),
    [
        ({"result": lambda self: {}}, r"Mine.result: .* \(1,\) by name, those of the measures, got nothing"),
        ({"result": lambda self: {"waited": np.full(self.world.worlds, np.nan)}}, r"waited: float64 \(1,\) with NaN"),
        ({"result": lambda self: {"waited": np.zeros(9)}}, r"Mine.result: .*, got waited: float64 \(9,\)"),
        ({"result": lambda self: {"waited": self.world.ticks.sum() + 0.0 * self.world.ticks}}, "same bits alone"),
        ({"reward": lambda self: LUCK.random(self.world.rows)}, "AssertionError|same bits"),
        ({"after_moving": lambda self: self.nothing}, "AttributeError: 'Mine' object has no attribute 'nothing'"),
        ({"observe": lambda self: {"near": np.full(self.world.rows, np.nan)}}, "Mine.observe: .* with NaN"),
        ({"achieved": lambda self: {"passed": self.world.of_row}}, "Mine.achieved: .*, got passed: int64"),
        ({"achievements": PASSED}, "Mine.achieved: expected whole numbers .*, got nothing"),
        (
            {"achievements": PASSED, "achieved": lambda self: {"passed": np.full(self.world.rows, 0.5)}},
            r"Mine.achieved: .*, got passed: float64 \(\d+,\)",
        ),
        ({"achievements": "passed"}, "achievements: expected a valid tuple, got 'passed'"),
        ({"phase": lambda self: np.ones(self.world.rows, dtype=np.int64)}, "Mine.phase: expected numbers"),
        ({"totals": lambda self: {"passed": 3}}, "Mine.totals: .*, got passed: 3"),
        ({"observe": lambda self: {"near": np.zeros(3)}}, r"Mine.observe: .* got near: float64 \(3,\)"),
    ],
)  # fmt: skip
def test_a_task_that_breaks_its_contract_is_one_line(members, said, monkeypatch):
    with pytest.raises(ValueError, match=said) as raised:
        check_task(registered(members, monkeypatch))
    assert "\n" not in str(raised.value)


def registered(members, monkeypatch):
    """A task of a plug-in that waits; some of its members do not."""
    monkeypatch.setattr(TASKS, "_classes", dict(TASKS._classes))
    return TASKS.register(type("Mine", (Waiting,), {**members, "__module__": __name__}))


def put(array, value, place=slice(None)):
    array[place] = value


AT = {"things": lambda self: (Things("goal", np.zeros((self.world.worlds, 1, 2)), moves=True),)}
"""A task with a thing."""
WRONG = {
    "things": [
        lambda self: [], lambda self: None, lambda self: {}, lambda self: 7, lambda self: (1, 2),
        lambda self: Things("goal", np.zeros((self.world.worlds, 1, 2))),
        lambda self: (Things("goal", np.zeros((2, 2))),),
        lambda self: (Things("goal", [[[0.0, 0.0]]]),),
        lambda self: (Things(7, np.zeros((self.world.worlds, 1, 2))),),
        lambda self: (Things("goal", np.full((self.world.worlds, 1, 2), np.nan)),),
    ],
    "sizes": [lambda self: None, lambda self: {"K": -1}, lambda self: {"K": 1.5}, lambda self: {"R": 3}],
    "place": [
        lambda self, start: put(start.poses, np.nan),
        lambda self, start: start.put_robots(np.full((start.robots, 2), np.inf)),
        lambda self, start: start.put_robots(np.ones((start.robots, 2)), np.full(start.robots, np.nan)),
        lambda self, start: setattr(start, "poses", None),
        lambda self, start: put(self.around[0].places, np.nan),
    ],
    "known": [
        lambda self: None, lambda self: [1], lambda self: {"carrying": np.zeros(3)},
        lambda self: {"carrying": np.full(self.world.rows, np.nan)},
    ],
    "command": [lambda self, commands: put(commands.vectors, np.inf)],
    "bend": [
        lambda self, commands: put(commands.vectors, np.nan, 0),
        lambda self, commands: setattr(commands, "vectors", np.zeros(3)),
    ],
    "after_moving": [lambda self: put(self.around[0].places, np.nan), lambda self: put(self.world.positions, np.nan)],
    "done": [lambda self: None, lambda self: np.zeros(self.world.worlds), lambda self: np.zeros(9, bool)],
    "observe": [lambda self: None, lambda self: {"near": 1.0}, lambda self: {7: np.zeros(self.world.rows)}],
    "reward": [lambda self: np.full(self.world.rows, np.nan), lambda self: np.zeros(3), lambda self: "x"],
    "cost": [lambda self, world, values, wrong=wrong: wrong for wrong in (np.nan, -5.0, "x", None, np.zeros(2))],
    "unavoidable": [lambda self, world, wrong=wrong: wrong for wrong in (np.nan, -5.0, None)],
    "duration": [lambda self, world, wrong=wrong: wrong for wrong in (np.inf, -5.0, "x")],
    "completed": [lambda self, values: 7, lambda self, values: np.zeros(self.world.worlds)],
    "headline": [lambda self, world: 7],
    **{part: [classmethod(lambda cls, mission: None)] for part in ("cost_words", "kind_of")},
    "cost_so_far": [lambda self, world, values: np.nan],
    "target": [lambda self, row, read, wrong=wrong: wrong for wrong in (7, ("a den", "far"), ("a den", np.zeros(2)))],
    "totals": [lambda self: {"waited": 7}],
    "shown": [
        lambda self: None, lambda self: (7,), lambda self: (Shown("load", "R", np.zeros(3, int), "too many"),),
        lambda self: (Shown("load", "robot", np.zeros(self.world.rows), "no whole numbers"),),
        lambda self: (Shown("load", "robot", np.full(self.world.rows, np.nan), "nothing", recorded=False),),
        lambda self: (Shown("load", "robot", [0], "no array"),),
        lambda self: 2 * (Shown("load", "robot", np.zeros(self.world.rows, int), "twice"),),
        lambda self: (Shown("load", "robot", self.world.of_row, "", {"far": np.full(self.world.rows, 7.0)}),),
        lambda self: (Shown("load", "robot", self.world.of_row, "", {"far": (0.5, 1)}),),
        lambda self: (Shown("load", "robot", self.world.of_row, "", where={"nothing": (0, 1)}),),
    ],
    "drawn": [
        lambda self: None, lambda self: (Drawn("nowhere", "item"),), lambda self: (Drawn("robot", "unicorn"),),
        lambda self: (Drawn("robot", "item", {"load": (0, 1)}),),
    ],
    "destinations": [lambda self: None, lambda self: (Destination("a den", "den", {}),)],
    "goals": [classmethod(lambda cls, *_: 7), classmethod(lambda cls, *_: ())],
    "__init__": [lambda self, world: None],
}  # fmt: skip
"""Part of a task -> functions that answer wrongly."""


@pytest.mark.parametrize(("part", "number"), [(part, k) for part, wrong in WRONG.items() for k in range(len(wrong))])
def test_an_answer_that_a_task_may_not_give_is_one_line_that_names_it(part, number, monkeypatch):
    cls = registered({**AT, part: WRONG[part][number]}, monkeypatch)
    with pytest.raises(PluginError, match=rf"Mine\.{part}: expected ") as raised:
        lived(cls)
    assert "\n" not in str(raised.value)


def test_a_task_says_what_robots_carry_of_which_no_option_asks(monkeypatch):
    batch = Batch(
        mission_of(registered({"known": lambda self: {"carrying": self.world.of_row + 1.0}}, monkeypatch).name)
    )
    assert batch.worlds.world.carrying.all()
    foraging = Batch("Foraging").worlds
    foraging.minds.known = lambda: {"carrying": np.ones(foraging.rows)}
    assert not foraging.world.carrying.any()  # a mechanism knows it
    foraging.world.by_baseline = True
    assert foraging.world.carrying.all()


def lived(cls):
    """Let a task go through a mission, and ask for all that is told of it."""
    batch = Batch(mission_of(cls.name, 2.0))
    batch.reset([1])
    while not batch.finished:
        batch.step(np.tile(batch.choices.default, (batch.rows, 1)))
    task = batch.worlds.task
    task.headline(0), task.target(0, {}), task.destinations(), task.totals(), task.cost_so_far(0, task.result())
    task.cost_words(batch.mission), task.kind_of(batch.mission), task.shown(), task.drawn()


class Mute(BaseException):
    """What cannot even say what went wrong."""

    def __str__(self):
        sys.exit(0)


@pytest.mark.parametrize("part", ["__init__", "place", "known", "done", "reward", "goals", "buffers", "check"])
@pytest.mark.parametrize("error", [SystemExit(0), Mute(), KeyError("lost"), RecursionError()])
def test_nothing_that_a_task_raises_ends_the_program_or_goes_by_another_name(part, error, monkeypatch):
    def broken(*_):
        raise error

    members = {part: classmethod(broken) if part in ("goals", "buffers", "check") else broken}
    with pytest.raises(ValueError, match=rf"test_conformance.py:\d+: {type(error).__name__}:"):
        lived(registered(members, monkeypatch))


@pytest.mark.parametrize(
    ("name", "value"),
    [("measures", 7), ("measures", (7,)), ("terms", None), ("fewest", "x"), ("apart", np.nan), ("mission", 7)],
)
def test_an_attribute_of_another_type_is_one_line(name, value):
    with pytest.raises(ValueError, match=f"^task Mine: {name}.*: expected "):
        type("Mine", (Waiting,), {name: value, "__module__": __name__})


@pytest.mark.filterwarnings("ignore::UserWarning")  # remarks on observations, such as not being normalised pictures
@every_task
def test_gymnasiums_check_passes(task):
    check_env(gymnasium.make("CleanSwarm-v0", mission=mission_of(task)).unwrapped, skip_render_check=True)


@pytest.mark.parametrize("task", ["Cleaning", *KINDS])
def test_the_time_limit_and_max_cycles_truncate(task):
    for settings, steps in (({}, 4), ({"max_cycles": 2}, 2), ({"seconds": 2.2}, 3), ({"seconds": 0.2}, 1)):
        env = begun(environment(task, **settings), seed=1)
        for step in range(steps):
            assert env.agents
            _, _, terminations, truncations, infos = env.step(sampled(env))
            assert set(terminations.values()) == {False}
            assert set(truncations.values()) == {step == steps - 1}
        assert env.agents == []
        assert infos["robot_0"]["time_s"] == pytest.approx(min(steps, settings.get("seconds", 9.0)))
