"""Every kind of mission has the same bits in a world alone, in a batch, later, and from a state in another place."""

import numpy as np
import pytest

from clean_swarm_env.config.load import with_changes
from clean_swarm_env.learning.batch import Batch
from tests.clean_swarm_env.copies import MISSIONS
from tests.clean_swarm_env.courses import CROWD, begun, difference, mission, snapshot
from tests.clean_swarm_env.missions import test_chain
from tests.clean_swarm_env.world import test_abilities, test_models
from tests.clean_swarm_env.world.test_team_changes import CHANGING

LOSSES = [{"at": 6.0, "do": "deliver", "loss": 0.8}, {"at": 12.0, "do": "deliver"}]
CARRIERS = [{"model": "a", "count": 4, "carries": 2, "sight": 3.0}, {"model": "b", "count": 2, "carries": 0}]
HARD = {"task": {"consequences": {"stop": 3.0, "drop": True}}}
BLOCKED = {"walls_block": ["sight", "messages", "pheromones"]}
KINDS = MISSIONS | {
    "reference": mission("reference"),
    "lossy": mission(delivery={"reach": 3.0, "loss": 0.4}, events=LOSSES),
    "changing": mission(**CHANGING),
    "models that join": test_models.team(events=test_models.JOINING),
    "carriers": test_abilities.team(*CARRIERS, items=12),
    "two documents": mission("scouts"),
    "consequences": CROWD.model_validate(with_changes(CROWD.model_dump(), HARD)),
    "zones": mission("silent-zone"),
    "walls that block": mission("three-rooms", world=BLOCKED, delivery={"loss": 0.2, "delay": 0.2}),
    "chain": test_chain.mission_of(6, 12),
}
HELD = {"chain": ("Patrol", "Chain", "ORCA")}
"""Options of the goals that robots hold instead of random ones."""
HAPPENS = {"crowd": "events", "consequences": "standing", "chain": "blind"}
"""An array that something has to be written to."""


def course(batch, world, held=None, periods=18):
    """Return what a world holds after each control period, and what its robots see after each decision period."""
    rng, rows, steps = np.random.default_rng(7), batch.worlds.rows_of(world), []
    fixed = [options.index(name) for options, name in zip(batch.options.values(), held or (), strict=bool(held))]
    for _ in range(periods):
        drawn = rng.integers(0, batch.choices.counts, (batch.robots, len(batch.choices.counts)))
        for worlds in batch.ticks(np.tile(fixed or drawn, (batch.rows if held else batch.count, 1))):
            garbage, standing = worlds.task.garbage, worlds.task.consequences.standing
            own = {"leg": garbage.leg[rows], "blind": garbage.blind[rows], "standing": standing[rows]}
            own |= {"paid": garbage.paid[world], "items": garbage.positions[world]}
            steps.append(snapshot(worlds, world) | {name: part.copy() for name, part in own.items()})
        steps[-1]["seen"] = batch.end_period().observations[rows].copy()
    return steps


@pytest.mark.parametrize("kind", KINDS)
def test_a_world_has_the_same_bits_alone_in_a_batch_from_a_state_and_later(kind):
    config, held = KINDS[kind], HELD.get(kind)
    alone, batch, other = (begun(Batch(config, len(seeds)), seeds) for seeds in ([6], [5, 6, 7], [8, 9]))
    first = course(alone, 0, held)
    assert kind not in HAPPENS or any(step[HAPPENS[kind]].any() for step in first)
    assert difference(first, course(batch, 1, held)) == ""
    assert difference(first, course(other, 0, held)) != ""
    other.set_state(batch.get_state([1]), [0])
    assert difference(course(batch, 1, held), course(other, 0, held)) == ""
    assert difference(first, course(begun(other, [6, 4]), 0, held)) == ""
