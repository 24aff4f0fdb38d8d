"""The missions of the comparison with the work that came before, kept in a file: a line for a label in a place.

Shapes: W teams of N robots, R = W * N rows; O options.
"""

import json
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Final

import numpy as np

from clean_swarm_env.config.families import FamilyConfig, Scenario
from clean_swarm_env.config.load import load_family
from clean_swarm_env.config.tasks import items_keep_coming
from clean_swarm_env.deciders.decided_goal import DecidedGoal
from clean_swarm_env.learning.batch import Batch
from clean_swarm_env.learning.interface import Finished
from docs.comparison.prior.manifest import MIXTURE, ROLES, Entrant, Place, PriorManifest
from docs.comparison.prior.meter import Meter
from examples.conflicts import AtMeetings, ByShares
from selector.documents.writing import write_whole
from selector.strategies.registry import spec_from_text
from selector.strategies.streams import row_keys
from selforg.arrays import Floats, Ints

FAMILIES: Final = Path(__file__).parents[1] / "families"
LEAST: Final = 3
"""Least length of a stage [decision periods of 1 s]: robots that stay close choose anew as often."""
BY_MEETINGS: Final = ("own", "aligned", "cost")
"""Payments of those that choose at meetings."""


@dataclass(frozen=True)
class Mission:
    """A test mission."""

    figure: float
    """Seconds per item where items keep coming, else the excess cost [s]."""
    completed: bool
    items_per_min: float
    coordination: float
    """Combined cost of coordination, see `Meter.spent` [-]."""
    roles: list[int]
    """(N,) the option that each robot held longest."""
    shares: list[float]
    """(O,) share of the team's time in which it held each option [-]."""


Done = dict[tuple[str, str], list[Mission]]
"""Place and label -> missions."""


def read_missions(file: Path) -> Done:
    """Return the missions of a file; nothing if there is none."""
    lines = file.read_text(encoding="utf-8").splitlines() if file.exists() else []
    read = [json.loads(line) for line in lines]
    return {(place, label): [Mission(**one) for one in missions] for place, label, missions in read}


def do_missions(manifest: PriorManifest, file: Path) -> None:
    """Do the missions that the file lacks."""
    done = read_missions(file)
    for study in (manifest.effort, manifest.learned):
        fixed = {option: Entrant(strategy=f"Fixed:option={option}") for option in manifest.fixed}
        asked = {label for pair in study.compared for label in pair}
        alike = {label: Entrant(strategy=ByShares.__name__) for label in (ROLES, MIXTURE) if label in asked}
        for name, place in study.places.items():
            for label, entrant in (fixed | study.entrants | alike).items():
                if (name, label) not in done:
                    done[name, label] = _do(manifest, place, entrant, label, done.get((name, manifest.shares_of), []))
                    lines = [json.dumps([*key, [asdict(one) for one in own]]) for key, own in done.items()]
                    write_whole(file, ("\n".join(lines) + "\n").encode())
                    print(name, label, flush=True)


def _do(manifest: PriorManifest, place: Place, entrant: Entrant, label: str, model: list[Mission]) -> list[Mission]:
    """Return the test missions of an entrant; `model` are those whose shares some begin with."""
    own = str(FAMILIES / place.family) if place.family.endswith(".yaml") else place.family
    family = load_family(own).model_copy(update={"robots": (place.robots, place.robots)})
    practice = place.practice if entrant.paid in BY_MEETINGS else 0
    teams = [_scenarios(family, manifest.seed, team, practice) for team in range(place.scenarios)]
    batch = Batch(family.largest, len(teams), source=lambda world: next(teams[world], None), explained=True)
    decided = DecidedGoal(batch, manifest.goal)
    problem = replace(decided.problem.only(manifest.fixed), features=())
    keys = row_keys(np.random.SeedSequence(0), batch.rows)
    strategy = spec_from_text(entrant.strategy).build(problem, keys, np.repeat(np.arange(len(teams)), batch.robots))
    if isinstance(strategy, ByShares):
        strategy.chances[:] = [_chances(label, one, role) for one in model for role in one.roles]
    at_meetings = entrant.paid in BY_MEETINGS or isinstance(strategy, ByShares)
    chooser = AtMeetings(strategy, LEAST if at_meetings else 0)
    return _judged(batch, decided, chooser, entrant, manifest.fixed)


def _scenarios(family: FamilyConfig, seed: int, team: int, practice: int) -> Iterator[Scenario]:
    """Yield the training scenarios of a team, and its test scenario."""
    for number in range(practice * team, practice * (team + 1)):
        yield family.scenario(seed, number, "train")
    yield family.scenario(seed, team, "test")


def _chances(label: str, model: Mission, role: int) -> Floats:
    """Return the chances (O,) by which a robot of a role draws: its own option, or as its team held them."""
    return np.eye(len(model.shares))[role] if label == ROLES else np.array(model.shares)


def _judged(
    batch: Batch, decided: DecidedGoal, chooser: AtMeetings, entrant: Entrant, options: tuple[str, ...]
) -> list[Mission]:
    """Return the last mission of each team, whose scenarios the source of the batch gives."""
    numbers: Ints = np.array([decided.problem.options.index(name) for name in options])
    meter, found = Meter(batch), dict[int, Mission]()
    sums, begun = np.zeros((batch.rows, 1 + len(options))), list(range(batch.count))
    batch.reset()
    while not batch.over.all():
        for world in begun:
            rows, doing = batch.worlds.rows_of(world), batch.doing[world]
            assert doing is not None
            sums[rows] = 0.0
            chooser.reset(rows, doing.seed)
        meter.start_period()
        for _ in batch.ticks(decided.actions(numbers[chooser.options])):
            meter.note()
        rewards = batch.end_period().rewards
        sums += np.column_stack([meter.spent, np.eye(len(options))[chooser.options]])
        chooser.go_on(meter.met, _costs(entrant, meter, rewards))
        begun = [end.world for end in batch.finished]
        found |= {end.world: _noted(end, sums[batch.worlds.rows_of(end.world)]) for end in batch.finished}
    return [found[world] for world in range(batch.count)]


def _costs(entrant: Entrant, meter: Meter, rewards: Floats) -> Floats:
    """Return what a period has cost each robot (R,), by which it learns."""
    costs = {"own": meter.busy, "aligned": meter.busy + meter.caused, "collided": meter.collided, "cost": -rewards}
    return costs.get(entrant.paid, np.zeros_like(rewards))


def _noted(end: Finished, sums: Floats) -> Mission:
    """Return what is kept of a mission; sums (N, 1 + O): cost of coordination, and periods of each option."""
    coordination, *shares = (sums.mean(axis=0) / sums[0, 1:].sum()).tolist()
    result, roles = end.result, sums[:, 1:].argmax(axis=1).tolist()
    figure = result.cost_s if items_keep_coming(end.scenario.mission) else result.excess_s
    return Mission(figure, result.completed, result.items_per_min, coordination, roles, shares)
