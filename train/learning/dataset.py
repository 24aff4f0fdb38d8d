"""Missions as a Minari dataset, for learners that need no environment (https://minari.farama.org)."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from dataclasses import dataclass
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np

from selector.documents.errors import DocumentError
from train.running.decided_goal import DecidedGoal
from train.running.pilots import PilotMaker

ENVIRONMENT = "clean_swarm_env.registration:CleanSwarm-v0"
"""Id by which Minari makes the environment of a dataset again, in a program that has not imported ours."""


@dataclass(frozen=True)
class DatasetRequest:
    """The request of the user."""

    name: str
    """Name of the dataset, as Minari has it: `group/name-v0`."""
    family: str
    """Name or path of the family of the missions."""
    size: tuple[float, float] | None
    """Torus of a family that draws from several [m]."""
    strategy: str
    """Who decides."""
    missions: int
    """Number of missions, the first ones of the family's training split."""
    seed: int
    """Seed of the missions."""
    directories: tuple[Path, ...] = ()
    """The user's own directories of configurations."""


def write_dataset(request: DatasetRequest, maker: PilotMaker, on_mission: Callable[[], object]) -> tuple[str, int]:
    """Run the missions and write the dataset; return its description and its number of decisions.

    `on_mission` is called after each mission.

    Raises:
        DocumentError: Minari is not installed, has such a dataset already, or does not take the name.

    """
    if find_spec("minari") is None:
        raise DocumentError("dataset: needs the extra 'minari', pip install 'clean-swarm[minari]'")
    import minari  # the extra is rarely installed

    try:
        known = request.name in minari.list_local_datasets()
        minari.dataset.minari_dataset.parse_dataset_id(request.name)
    except ValueError as error:
        raise DocumentError(f"NAME: expected group/name-v0, got {request.name!r} ({error})") from error
    if known:
        raise DocumentError(f"NAME: expected a new dataset, {request.name!r} is there; `minari delete` removes it")
    settings: dict[str, Any] = {"family": request.family}
    if request.size is not None:
        settings["size"] = request.size
    if request.directories:
        settings["directories"] = [str(directory.resolve()) for directory in request.directories]
    team = gymnasium.make(ENVIRONMENT, disable_env_checker=True, **settings)
    collector = minari.DataCollector(team, record_infos=True)
    figures = [_mission(collector, request.seed + number, maker, on_mission) for number in range(request.missions)]
    text = _description(request, collector.unwrapped.batch, figures)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # it asks for an address and for an environment of evaluations
        collector.create_dataset(
            dataset_id=request.name,
            algorithm_name=request.strategy,
            description=text,
            author="Clean Swarm",
            requirements=[f"clean-swarm=={version('clean-swarm')}"],
        )
    return text, minari.load_dataset(request.name).total_steps


def _mission(env: Any, seed: int, maker: PilotMaker, on_mission: Callable[[], object]) -> dict[str, float]:  # noqa: ANN401
    """Run one mission and return its figures."""
    batch = env.unwrapped.batch
    decided = DecidedGoal(batch)
    pilot = maker(decided.problem, np.zeros(batch.rows, dtype=np.int64))
    env.reset(seed=seed)
    pilot.begin(np.arange(batch.rows), seed)
    total, over = 0.0, False
    while not over:
        actions = decided.decide(pilot, batch.observations)
        _, reward, terminated, truncated, infos = env.step(actions.ravel())
        total, over = total + float(reward), terminated or truncated
    on_mission()
    return {"return": total, **{name: float(infos[name]) for name in ("duration_s", "garbage_done", "completed")}}


def _description(request: DatasetRequest, batch: Any, figures: list[dict[str, float]]) -> str:  # noqa: ANN401  (a Batch)
    """Return what a user of the dataset has to know."""
    mean = {name: float(np.mean([mission[name] for mission in figures])) for name in figures[0]}
    options = "; ".join(f"{goal}: {', '.join(names)}" for goal, names in batch.options.items())
    last, period = request.seed + len(figures) - 1, batch.mission.decision_period
    weights = ", ".join(f"{name} {weight:g}" for name, weight in batch.rewards.config.model_dump().items() if weight)
    done = f"{mean['duration_s']:.1f} s, {mean['garbage_done']:.1f} items, {mean['completed']:.0%} completed"
    return f"""\
Cleaning robots on a torus, {len(figures)} missions of the family {request.family}, seeds {request.seed} to {last}.
Every {period:g} s {request.strategy} gives each of {batch.robots} robots an option.

- Observations: robot after robot; of each {", ".join(batch.observer.names)}.
- Actions: robot after robot the number of an option for each goal. {options}.
- Rewards: mean over the robots, with the weights {weights}.
- Terminated: all garbage is dumped. Truncated: the time is over.
- Infos: time, items and collisions of each period and of the mission so far.
- Means of a mission: return {mean["return"]:.2f}, {done}."""
