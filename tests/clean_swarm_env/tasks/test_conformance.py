"""Every task as an environment passes the checks of the cleaning environment, at every border and with all actions."""

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import clean_swarm_env.registration  # noqa: F401  (the ids of the environments)
from clean_swarm_env import clean_swarm_v0
from clean_swarm_env.tasks import TASKS, Measure, Task, TaskSettings, TaskState, Things
from clean_swarm_env.testing import check_task
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


class Waiting(Task[TaskSettings, TaskState]):
    """Robots wait; the measure is the time."""

    measures = (Measure("waited", "s", "higher", 2.0, "half of the time"),)
    goal = "CollectiveExploration"

    def result(self):
        return {"waited": self.world.ticks * 0.2}


@pytest.mark.parametrize(
    ("members", "said"),
    [
        ({"result": lambda self: {}}, r"result: expected the measures \['waited'\]"),
        ({"result": lambda self: {"waited": np.full(self.world.worlds, np.nan)}}, "result: waited: expected finite"),
        ({"result": lambda self: {"waited": np.zeros(9)}}, r"result: waited: expected shape \(1,\), got \(9,\)"),
        ({"result": lambda self: {"waited": self.world.ticks.sum() + 0.0 * self.world.ticks}}, "same bits alone"),
        ({"reward": lambda self: LUCK.random(self.world.rows)}, "AssertionError|same bits"),
        ({"after_moving": lambda self: self.nothing}, "AttributeError: 'Mine' object has no attribute 'nothing'"),
        ({"things": lambda self: 7}, "TypeError"),
        ({"observe": lambda self: {"near": np.full(self.world.rows, np.nan)}}, "observe: expected finite"),
        ({"observe": lambda self: {"near": np.zeros(3)}}, r"observe: expected shape \(1, \d+\), got \(1, 3\)"),
        ({"things": lambda self: (Things("goal", np.zeros((2, 2))),)}, r"things: goal: expected shape \(1, 2, 2\)"),
        ({"place": lambda self, start: start.put_robots(np.full((4, 2), np.inf))}, "put_robots: places: expected"),
    ],
)  # fmt: skip
def test_a_task_that_breaks_its_contract_is_one_line(members, said, monkeypatch):
    monkeypatch.setitem(TASKS._classes, "Mine", type("Mine", (Waiting,), {**members, "__module__": __name__}))
    with pytest.raises(ValueError, match=said) as raised:
        check_task(TASKS.find("Mine"))
    assert "\n" not in str(raised.value)


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
