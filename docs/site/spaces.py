"""What a task, a mission or a family is for a learner: how it starts, spaces, rewards, measures; asked of the code."""

from collections.abc import Iterator
from functools import cache
from typing import Any

from clean_swarm_env import __version__, clean_swarm_v0, load_family
from clean_swarm_env.clean_swarm_v0 import CleanSwarm
from clean_swarm_env.config.tasks import find_task
from clean_swarm_env.learning.reward import RewardConfig
from clean_swarm_env.tasks import Task
from clean_swarm_env.world.parts.measure import key_of
from docs.site.texts import cell, code, table


def arguments(kind: str, name: str) -> dict[str, Any]:
    """Return the arguments of an environment by which it has the task, the mission or the family of a name."""
    if kind != "families":
        return {"mission": name}
    sizes = load_family(name).tori
    return {"family": name} if len(sizes) == 1 else {"family": name, "size": sizes[0]}


@cache
def environment(kind: str, name: str) -> CleanSwarm:
    """Return the environment of a name."""
    return clean_swarm_v0.parallel_env(**arguments(kind, name))


def started(kind: str, name: str) -> Iterator[str]:
    """Yield the lines that start it, its id and its version."""
    lines = {
        "tasks": f"clean-swarm evaluate {name} --scenarios 5\nclean-swarm play {name}",
        "missions": f"clean-swarm play {name}",
        "families": f"clean-swarm evaluate {name} --strategy fixed --strategy Random --scenarios 2\n"
        f"clean-swarm play {name}",
    }
    yield "## Start it"
    yield code("sh", lines[kind])
    given = ", ".join(f"{key}={value!r}" for key, value in arguments(kind, name).items())
    yield code("python", f"from clean_swarm_env import clean_swarm_v0\n\nenv = clean_swarm_v0.parallel_env({given})")
    yield f"With Gymnasium its id is `CleanSwarm-v0` with `{given}`. Version: clean-swarm {__version__}, " \
        "environment v0."  # fmt: skip


def worlds(kind: str, name: str) -> Iterator[str]:
    """Yield robots, spaces, rewards and measures."""
    env = environment(kind, name)
    mission, robot = env.mission, env.possible_agents[0]
    width, height = mission.size
    yield "## World"
    ground = {"torus": "a torus", "open": "open land", "walled": "a walled field"}[mission.world.ground]
    yield (
        f"Up to {len(env.possible_agents)} robots on {ground} of {width:g} m x {height:g} m, for at most "
        f"{mission.time_limit:g} s; a decision lasts 1 s."
    )
    yield "## Spaces"
    options = [(goal, ", ".join(f"`{option}`" for option in names)) for goal, names in env.options.items()]
    yield f"Actions: `{env.action_space(robot)}`, an option for each goal."
    yield table(("goal", "options, by number from 0"), options)
    names = ", ".join(f"`{component}`" for component in env.observation_names)
    yield f"Observations: `{env.observation_space(robot)}`. Their components are {names}."
    yield "Other terms, vectors as actions: [the environment](../../environment.md)."
    yield from paid(find_task(mission.task.name))


def paid(task: type[Task]) -> Iterator[str]:
    """Yield the rewards and the measures of a task."""
    yield "## Rewards and measures"
    if task.priced:
        weight = RewardConfig().cost
        yield (
            f"A robot gets {weight:g} for each second by which the "
            "[cost of the mission](../../environment.md#what-a-mission-costs) grew. "
            "Results are the cost, the duration [s], and collisions [1/s]; less is better."
        )
        return
    yield "A reward is how much each measure improved in the period, in units of its target. The baseline is: " \
        f"{task.baseline}."  # fmt: skip
    rows = [
        (
            f"`{key_of(measure.name)}`",
            cell(measure.unit),
            f"{'≤' if measure.better == 'lower' else '≥'} {measure.target:g}",
            cell(measure.reason),
        )
        for measure in task.measures
    ]
    yield table(("measure", "unit", "target", "reason for the target"), rows)
