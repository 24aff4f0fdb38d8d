"""Missions as a Minari dataset, for learners that need no environment (https://minari.farama.org)."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from importlib.util import find_spec
from typing import Any

import gymnasium
import numpy as np
from numpy.typing import NDArray

from clean_swarm_env import __version__
from clean_swarm_env.borders.spaces import CORRECTION, OPTION
from selector.documents.errors import DocumentError
from train.deciders.decided_goal import DecidedGoal
from train.deciders.named import NamedDecider, decider_named
from train.request import Request
from train.running.needs import ALONE, check_needs

ENVIRONMENT = "clean_swarm_env.registration:CleanSwarm-v0"
"""Id by which Minari makes the environment of a dataset again, in a program that has not imported ours."""


def write_dataset(
    name: str, request: Request, size: tuple[float, float] | None, on_mission: Callable[[], object]
) -> tuple[str, int]:
    """Run the missions and write the dataset; return its description and its number of decisions.

    Args:
        name: name of the dataset, as Minari has it: `group/name-v0`.
        request: the family, one strategy, and the number of missions as `scenarios`.
        size: torus of a family that draws from several [m].
        on_mission: called after each mission.

    Raises:
        DocumentError: Minari is not installed, has such a dataset already, or does not take the name; or the missions
            need more memory or time than there is.

    """
    [strategy], missions = request.strategies, request.scenarios or 1
    if find_spec("minari") is None:
        raise DocumentError("dataset: needs the extra 'minari', pip install 'clean-swarm[minari]'")
    import minari  # the extra is rarely installed

    try:
        known = name in minari.list_local_datasets()
        minari.dataset.minari_dataset.parse_dataset_id(name)
    except ValueError as error:
        raise DocumentError(f"NAME: expected group/name-v0, got {name!r} ({error})") from error
    if known:
        raise DocumentError(f"NAME: expected a new dataset, {name!r} is there; `minari delete` removes it")
    named = decider_named(strategy, request.directories)
    settings: dict[str, Any] = {"family": request.name}
    if named.mode != "option" or named.trained_with:
        settings |= {"action": {"mode": named.mode}, "observation": named.observation(()).model_dump(mode="json")}
    if size is not None:
        settings["size"] = size
    if request.directories:
        settings["directories"] = [str(directory.resolve()) for directory in request.directories]
    team = gymnasium.make(ENVIRONMENT, disable_env_checker=True, **settings)
    mission = team.unwrapped.batch.mission  # type: ignore[attr-defined]
    check_needs(mission, missions, ALONE, hint="fewer --missions need less")
    collector = minari.DataCollector(team, record_infos=True)
    figures = [_mission(collector, request.seed + number, named, on_mission) for number in range(missions)]
    text = _description(request, collector.unwrapped.batch, figures)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # it asks for an address and for an environment of evaluations
        collector.create_dataset(
            dataset_id=name,
            algorithm_name=strategy,
            description=text,
            author="Clean Swarm",
            requirements=[f"clean-swarm=={__version__}"],
        )
    return text, minari.load_dataset(name).total_steps


def _mission(env: Any, seed: int, named: NamedDecider, on_mission: Callable[[], object]) -> dict[str, float]:  # noqa: ANN401
    """Run one mission and return its figures."""
    batch = env.unwrapped.batch
    decided = DecidedGoal(batch, named.decides(None))
    decider = named.build(decided.problem, np.zeros(batch.rows, dtype=np.int64))
    env.reset(seed=seed)
    decider.reset(np.arange(batch.rows), seed)
    total, over = 0.0, False
    while not over:
        actions = decided.decide(decider, batch.observations)
        _, reward, terminated, truncated, infos = env.step(_in_space(actions, env.action_space))
        total, over = total + float(reward), terminated or truncated
    on_mission()
    return {"return": total, **{name: float(infos[name]) for name in ("duration_s", "garbage_done", "completed")}}


def _in_space(actions: NDArray[Any], space: gymnasium.Space[Any]) -> Any:  # noqa: ANN401  (as the space has it)
    """Return actions (R, ...) of a batch as one of the team."""
    if not isinstance(space, gymnasium.spaces.Dict):
        return actions.ravel()
    options, vectors = np.split(actions, [-2], axis=1)
    return {OPTION: options.ravel().astype(np.int64), CORRECTION: vectors.ravel().astype(np.float32)}


def _description(request: Request, batch: Any, figures: list[dict[str, float]]) -> str:  # noqa: ANN401  (a Batch)
    """Return the description of the dataset for its users."""
    mean = {name: float(np.mean([mission[name] for mission in figures])) for name in figures[0]}
    options = "; ".join(f"{goal}: {', '.join(names)}" for goal, names in batch.options.items())
    last, period = request.seed + len(figures) - 1, batch.mission.decision_period
    weights = ", ".join(f"{name} {weight:g}" for name, weight in batch.rewards.config.model_dump().items() if weight)
    done = f"{mean['duration_s']:.1f} s, {mean['garbage_done']:.1f} items, {mean['completed']:.0%} completed"
    gives = {
        "option": f"the number of an option for each goal. {options}",
        "velocity": "a vector, ahead and left in shares of the largest speed",
        "both": f"`{OPTION}`, an option for each goal, and `{CORRECTION}`, a vector that is added. {options}",
    }[batch.action.mode]
    return f"""\
Cleaning robots on a torus, {len(figures)} missions of the family {request.name}, seeds {request.seed} to {last}.
Every {period:g} s {request.strategies[0]} decides for each of {batch.robots} robots.

- Observations: robot after robot; of each {", ".join(batch.observer.names)}.
- Actions: robot after robot {gives}.
- Rewards: mean over the robots, with the weights {weights}.
- Terminated: all garbage is dumped. Truncated: the time is over.
- Infos: time, items and collisions of each period and of the mission so far.
- Means of a mission: return {mean["return"]:.2f}, {done}."""
